"""Inserted blocks are the source's to the digit; the rest is the template's."""

import numpy as np
import pytest
from lxml import etree

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_insertion import insert_blocks
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems

FRONT = {"direction": "Transmission Front"}
BACK = {"direction": "Transmission Back"}


def numbers(seed):
    values = np.random.default_rng(seed).random(25) / 10
    return ", ".join(f"{value:.7f}" for value in values)


def same(one, other, channel="visible", function="transmission_front"):
    a, b = (bsdf.functions[channel, function].values for bsdf in (one, other))
    return np.array_equal(a, b)


@pytest.fixture
def template(bsdf_xml, write):
    text = bsdf_xml(
        {"data": numbers(1), **FRONT},
        {"data": numbers(2), **BACK},
        {"data": numbers(3), "wavelength": "Solar", **FRONT},
        extra="<!-- made by hand -->",
    )
    return write(text, "template.xml")


@pytest.fixture
def source(bsdf_xml, write):
    text = bsdf_xml({"data": numbers(4), **FRONT}).replace("Test layer", "Traced")
    return write(text, "source.xml")


def test_data_come_from_the_source_and_all_else_from_the_template(
    source, template, tmp_path
):
    out = tmp_path / "out.xml"
    result = insert_blocks(source, template, out)
    assert result.blocks == ("visible transmission front",)
    assert result.kept == ("visible transmission back", "solar transmission front")
    bsdf, before = read_bsdf(out), read_bsdf(template)
    assert same(bsdf, read_bsdf(source))
    assert same(bsdf, before, function="transmission_back")
    assert same(bsdf, before, channel="solar")
    assert bsdf.product == before.product
    assert b"made by hand" in out.read_bytes()


def test_nothing_but_the_blocks_changes(source, template, tmp_path):
    """Element by element: only the numbers of one block differ."""
    insert_blocks(source, template, tmp_path / "out.xml")
    texts = [
        [(e.tag, (e.text or "").strip()) for e in etree.parse(f).iter(etree.Element)]
        for f in (template, tmp_path / "out.xml")
    ]
    differing = [(a, b) for a, b in zip(*texts, strict=True) if a != b]
    assert len(differing) == 1
    assert differing[0][0][0].endswith("}ScatteringData")


def test_one_channel_can_serve_another(source, template, tmp_path):
    out = tmp_path / "out.xml"
    insert_blocks(
        source, template, out, channels=["visible", "nir"], source_channel="visible"
    )
    bsdf, traced = read_bsdf(out), read_bsdf(source)
    assert same(bsdf, traced)
    a = bsdf.functions["nir", "transmission_front"].values
    assert np.array_equal(a, traced.functions["visible", "transmission_front"].values)


def test_other_bases_come_along(template, tmp_path):
    source, out = tmp_path / "klems.xml", tmp_path / "out.xml"
    write_bsdf(source, lambertian(0.3, klems("quarter"), reflectance=0.2))
    insert_blocks(source, template, out)
    bsdf = read_bsdf(out)
    assert len(bsdf.function("transmission_front").exits) == 41
    assert np.allclose(bsdf.direct_hemispherical("reflection_back"), 0.2)


def test_a_missing_channel_is_refused(source, template, tmp_path):
    with pytest.raises(InputError, match=r"source.xml: .* no solar channel; .*visible"):
        insert_blocks(source, template, tmp_path / "out.xml", channels=["solar"])
    assert not (tmp_path / "out.xml").exists()


def test_rows_and_columns_are_not_mixed(bsdf_xml, write, template, tmp_path):
    source = write(bsdf_xml({"data": numbers(4)}, structure="Rows"), "rows.xml")
    with pytest.raises(InputError, match=r"'Columns', but 'Rows'"):
        insert_blocks(source, template, tmp_path / "out.xml")


def test_bases_of_one_name_must_agree(bsdf_xml, basis, write, template, tmp_path):
    other = basis(rings=((0, 20, 1), (20, 90, 4)))
    source = write(bsdf_xml({"data": numbers(4)}, bases=other), "other.xml")
    with pytest.raises(InputError, match=r"rings of angle basis 'Custom' differ"):
        insert_blocks(source, template, tmp_path / "out.xml")
