"""Writing BSDF files and reading them back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian, thin_pane
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Detail, Geometry, Product, Spectra
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError, OutputError
from clerestory.hemisphere.klems import klems

DATA = Path(__file__).parents[2] / "data"


def assert_same(left, right):
    assert list(left.functions) == list(right.functions)
    for key, part in left.functions.items():
        other = right.functions[key]
        np.testing.assert_array_equal(part.values, other.values)
        assert part.exits.matches(other.exits)
        assert part.incidents.matches(other.incidents)
    assert left.product == right.product


def test_file_by_hand_survives_a_round_trip(tmp_path):
    original = read_bsdf(DATA / "five_patches.xml")
    write_bsdf(tmp_path / "copy.xml", original, comment="a copy")
    assert_same(original, read_bsdf(tmp_path / "copy.xml"))
    assert original.product.thickness == pytest.approx(0.0254)
    assert original.product.emissivity_front == 0.84


def test_a_comment_may_look_like_an_empty_element(tmp_path):
    original = read_bsdf(DATA / "five_patches.xml")
    write_bsdf(tmp_path / "copy.xml", original, comment="<ScatteringData/> twice")
    assert_same(original, read_bsdf(tmp_path / "copy.xml"))


def test_geometry_survives_a_round_trip(tmp_path):
    """In metres to the letter; in another unit within a scale of its own."""
    text = "\nv a =\n\tp 0 0 -1 # <&>\nsph a 0.5\r\n"
    for metres in (1.0, 0.001):
        product = Product("Ball", geometry=Geometry(text, metres))
        original = replace(lambertian(0.5, klems("quarter")), product=product)
        write_bsdf(tmp_path / "ball.xml", original)
        back = read_bsdf(tmp_path / "ball.xml").product.geometry
        assert back.metres == 1
        if metres == 1:
            assert back == product.geometry
        assert text in back.text


def test_every_field_survives_a_round_trip(tmp_path):
    """Lengths to the last bit, though the thickness is written in millimetres."""
    product = Product(
        "Blind",
        "Nobody & Sons",
        "Integral",
        0.030362,
        1.1,
        0.7,
        0.8,
        0.9,
        details=(
            Detail("TIR", "0.1"),
            Detail("Length", "3", "Foot"),
            Detail("Geometry/Angle", "23"),
        ),
        spectra=(Spectra("visible", "my lamp.ssp", "my eye.dsp"),),
    )
    for given in (product, Product(thickness=0.1 + 0.2), Product()):
        layer = replace(lambertian(0.5, klems("quarter")), product=given)
        write_bsdf(tmp_path / "layer.xml", layer)
        assert read_bsdf(tmp_path / "layer.xml").product == given


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
def test_every_number_survives_a_round_trip(tmp_path, basis):
    partition = klems(basis)
    rng = np.random.default_rng(1)
    n = len(partition)
    part = ScatteringMatrix(rng.random((n, n)) * 0.3, partition, partition)
    product = Product("Ünsäglich <&>", "Nobody's", "Other", 0.1, 1 / 3, 2.0, 0.9, 0.8)
    functions = {
        ("visible", "transmission_back"): part,
        ("nir", "reflection_front"): part,
    }
    bsdf = Bsdf(functions, product)
    write_bsdf(tmp_path / "a.xml", bsdf)
    assert_same(bsdf, read_bsdf(tmp_path / "a.xml"))


def test_digits_bound_the_error(tmp_path):
    pane = thin_pane(0.9, klems("full"))
    write_bsdf(tmp_path / "a.xml", pane, digits=4)
    copy = read_bsdf(tmp_path / "a.xml")
    values = pane.function("transmission_front").values
    np.testing.assert_allclose(
        copy.function("transmission_front").values, values, rtol=5e-4
    )
    assert (tmp_path / "a.xml").stat().st_size < 180_000


def test_same_bsdf_gives_the_same_bytes(tmp_path):
    for name in ("a.xml", "b.xml"):
        write_bsdf(tmp_path / name, lambertian(0.5, klems("quarter")))
    assert (tmp_path / "a.xml").read_bytes() == (tmp_path / "b.xml").read_bytes()


def test_one_name_for_two_partitions_is_refused(tmp_path):
    other = klems("quarter")
    full = klems("full")
    renamed = type(other)(full.name, other.count, other.theta, other.azimuth)
    part = ScatteringMatrix(np.zeros((41, 145)), renamed, full)
    with pytest.raises(InputError, match="different names expected"):
        write_bsdf(tmp_path / "a.xml", Bsdf({("visible", "transmission_front"): part}))


def test_text_that_xml_cannot_hold_is_escaped(tmp_path):
    layer = lambertian(0.5, klems("quarter"))
    write_bsdf(tmp_path / "a.xml", Bsdf(layer.functions, Product(name="a\0")))
    assert read_bsdf(tmp_path / "a.xml").product.name == "a=00"
    wrong = Product(details=(Detail("a b", "c"),))
    with pytest.raises(InputError, match="Invalid tag name"):
        write_bsdf(tmp_path / "b.xml", Bsdf(layer.functions, wrong))
    assert not (tmp_path / "b.xml").exists()


def test_missing_folder_is_an_output_error(tmp_path):
    with pytest.raises(OutputError):
        write_bsdf(tmp_path / "none" / "a.xml", lambertian(0.5, klems("quarter")))
