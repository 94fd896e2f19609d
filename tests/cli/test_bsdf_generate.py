"""`clerestory bsdf generate` writes what it says, and says what is wrong."""

import numpy as np
import pytest

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.spectral.band_sets import band_means, band_set
from clerestory.spectral.material_library import material_spectrum

FEW = ("--samples", 64, "--quiet")
SLATS = """
void plastic grey 0 0 5 0.5 0.5 0.5 0 0
grey polygon slat 0 0 12  0 0.1 0  1 0.1 0  1 0.1 -0.05  0 0.1 -0.05
grey polygon slat2 0 0 12  0 0.2 0  1 0.2 0  1 0.2 -0.05  0 0.2 -0.05
"""


def test_a_blind_from_words(call, room):
    done = call(
        *(
            "bsdf",
            "generate",
            "--venetian",
            "slat_width=0.08,spacing=0.072,tilt_deg=45",
        ),
        *("--basis", "quarter", "-o", "blind.xml", "--errors", "errors.xml"),
        *("--rad", "blind.rad", *FEW),
    )
    assert (done.status, done.err) == (0, "")
    bsdf, errors = read_bsdf("blind.xml"), read_bsdf("errors.xml")
    assert bsdf.product.thickness == pytest.approx(0.08 / np.sqrt(2))
    assert bsdf.product.geometry is not None
    assert set(bsdf.functions) == set(errors.functions)
    assert 0.2 < bsdf.diffuse("transmission_front") < 0.5
    assert (room / "blind.rad").read_text().count("polygon") > 3


def test_a_tree_from_a_scene(call, room):
    (room / "slats.rad").write_text(SLATS)
    done = call(
        *("bsdf", "generate", "slats.rad", "--basis", "tree4", "--halvings", 3),
        *("--dim", 0, 1, 0, 0.3, -0.05, 0, "--sides", "front", "-o", "tree.xml"),
        *("--reduce", 50, "--no-geometry", "--samples", 1024, "--quiet"),
    )
    assert (done.status, done.err) == (0, "")
    bsdf = read_bsdf("tree.xml")
    assert set(bsdf.functions) == {
        ("visible", "transmission_front"),
        ("visible", "reflection_front"),
    }
    assert bsdf.product.height == pytest.approx(0.3)


def test_bands_and_a_toml_file(call, room):
    (room / "pane.toml").write_text('kind = "diffuse_pane"\ntransmittance = 0.5\n')
    done = call(
        *("bsdf", "generate", "--system", "pane.toml", "--basis", "quarter"),
        *("--band", "visible=0.3/0.6/0.1", "--band", "solar=1/0/0"),
        *("--samples", 256, "-o", "pane.xml"),
    )
    assert (done.status, done.err) == (0, "")
    assert "visible transmission front" in done.out
    assert read_bsdf("pane.xml").channels == ("visible", "solar")


def test_spectral_bands_with_a_built_in_spectrum(call, room):
    slats = "slat_width=0.05,spacing=0.05,tilt_deg=90"
    done = call(
        *("bsdf", "generate", "--venetian", slats, "--basis", "quarter"),
        *("--spectral", "melanopic+photopic", "--spectrum", "upper=library:pine"),
        *("--sides", "front", "--samples", 256, "-o", "slats.xml", "--quiet"),
    )
    assert (done.status, done.err) == (0, "")
    bsdf = read_bsdf("slats.xml")
    pine = material_spectrum("pine")
    means = dict(
        zip(
            ("melanopic", "photopic"),
            band_means(pine, band_set("melanopic+photopic")),
            strict=True,
        )
    )
    assert set(bsdf.channels) == {"visible", *means}
    for name, rho in {**means, "visible": means["photopic"]}.items():
        found = bsdf.diffuse("reflection_front", channel=name)
        assert found == pytest.approx(rho, rel=2e-3)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "no system"),
        (("--woven", "default", "--spectrum", "thread=library:pine"), "--spectral"),
        (("--woven", "default", "--spectral", "20", "--spectrum", "x"), "slat=library"),
        (("--woven", "default", "--spectral", "RGB"), "such as 20"),
        (
            ("--woven", "default", "--spectral", "20", "--band", "a=1/0/0"),
            "one of them",
        ),
        (("--venetian", "slat_width"), "name=value pairs"),
        (("--venetian", "spacing=1"), "lacks the parameter 'slat_width'"),
        (("--woven", "default", "--microlouvre", "default"), "several systems"),
        (("--woven", "default", "--halvings", 9, "--basis", "tree4"), "2 to 7"),
        (("--woven", "default", "--reduce", 100), "0 ≤ reduction < 100"),
        (("--woven", "default", "--band", "solar=1"), "such as solar="),
        (("--woven", "default", "--relative-error", 0), "0.00001 to below 10"),
        (("missing.rad",), "missing.rad"),
    ],
)
def test_bad_requests_end_with_one_line(call, words, message):
    done = call("bsdf", "generate", *words, "-o", "x.xml")
    assert done.status == 2
    assert message in done.err
    assert done.err.count("\n") == 1


GLASS = """
void dielectric glass 0 0 5 1 1 1 1.5 0
glass polygon top 0 0 9  0 0 0  1 0 0  0 1 0
glass polygon low 0 0 9  0 0 -0.1  0 1 -0.1  1 0 -0.1
glass polygon one 0 0 12  0 0 0  0 0 -0.1  1 0 -0.1  1 0 0
glass polygon two 0 0 12  0 0 0  0 1 0  0 1 -0.1  0 0 -0.1
"""
TWICE = SLATS + "grey polygon part 0 0 9  0.2 0.1 -0.01  0.8 0.1 -0.01  0.5 0.1 -0.04"
MILLIMETRES = """
void plastic grey 0 0 5 0.5 0.5 0.5 0 0
grey polygon slat 0 0 12  0 100 0  1000 100 0  1000 150 -50  0 150 -50
"""
HIGH = SLATS + "grey polygon edge 0 0 9  0 0.3 0.02  1 0.3 0.02  1 0.3 -0.05"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HIGH, 'system.rad:5: polygon "edge" reaches 20 mm into the room'),
        (MILLIMETRES, "1000 m wide, 50 m high and 50 m deep; if it is in millimetres"),
        (
            TWICE,
            'system.rad:3: polygon "slat" and system.rad:5: polygon "part" are',
        ),
    ],
)
def test_doubts_name_the_item_and_its_line(call, room, text, said):
    """Systems in the room, in millimetres or overlapping: warned of, and traced."""
    (room / "system.rad").write_text(text)
    done = call(
        *("bsdf", "generate", "system.rad", "-o", "x.xml"),
        *("--basis", "quarter", "--sides", "back", "--samples", 8, "--quiet"),
    )
    assert done.status == 0
    assert said in done.err
    assert all(line.startswith("warning: ") for line in done.err.splitlines())


def test_an_open_solid_is_reported_and_refused_for_its_energy(call, room):
    """Light that enters through the missing face leaves refracted as if from glass."""
    (room / "system.rad").write_text(GLASS)
    done = call(
        *("bsdf", "generate", "system.rad", "-o", "x.xml"),
        *("--basis", "quarter", "--sides", "back", "--samples", 8, "--quiet"),
    )
    assert done.status == 2
    assert 'warning: system.rad:3: polygon "top" has an open edge' in done.err
    assert 'dielectric "glass" does not enclose a solid' in done.err
    assert "are dielectric solids closed" in done.err.splitlines()[-1]
    assert not (room / "x.xml").exists()


def test_a_system_in_the_room_is_refused(call, room):
    (room / "slats.rad").write_text(SLATS.replace("-0.05", "0.05"))
    done = call("bsdf", "generate", "slats.rad", "-o", "x.xml")
    assert done.status == 2
    assert "all surfaces lie in the room" in done.err
    assert done.err.count("\n") == 1


def test_doubts_are_warnings(call, room):
    (room / "slats.rad").write_text(SLATS.replace("-0.05", "0.05"))
    (room / "more.rad").write_text("grey polygon low 0 0 9  0 0 -0.1  1 0 -0.1  0 1 0")
    done = call(
        *("bsdf", "generate", "slats.rad", "more.rad", "-o", "x.xml"),
        *("--basis", "quarter", *FEW),
    )
    assert done.status == 0
    assert 'warning: slats.rad:3: polygon "slat"' in done.err
    assert "into the room" in done.err
