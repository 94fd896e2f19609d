"""`clerestory bsdf`: exit statuses for scripts, files written, one-line errors."""

import json
from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Geometry, Product
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.radiance.rad_reader import read_rad

QUARTER = klems("quarter")


@pytest.fixture
def one_sided(room):
    """A file whose back passes nothing, though its front does."""
    sound = lambertian(0.5, QUARTER)
    functions = dict(sound.functions)
    dark = ScatteringMatrix(np.zeros((41, 41)), QUARTER, QUARTER)
    functions["visible", "transmission_back"] = dark
    write_bsdf(room / "one_sided.xml", Bsdf(functions))
    return "one_sided.xml"


def test_a_sound_file_passes(call):
    outcome = call("bsdf", "check", "diffuser.xml")
    assert outcome.status == 0
    assert outcome.out == (
        "diffuser.xml: sound; read by Radiance; not by pyWinCalc (line 6: no solar"
        " data; visible and solar data expected)\n"
    )


def test_a_built_in_product_is_checked_as_its_file_would_be(call, room):
    name = "library:single-clear-6"
    outcome = call("bsdf", "check", name)
    assert outcome.status == 0
    assert call("bsdf", "library", name, "-o", "clear.xml").status == 0
    written = call("bsdf", "check", "clear.xml")
    assert outcome.out == written.out.replace("clear.xml", name)


def test_spectra_of_materials_are_listed_and_written(call, room):
    listed = call("bsdf", "library", "pine").out
    assert "library 7" not in listed.splitlines()[-1]
    assert listed.splitlines()[-1].split() == ["pine", "new", "pine", "beam"]
    assert "double-lowe-6" in call("bsdf", "library").out
    assert call("bsdf", "library", "library:pine", "-o", "pine.csv").status == 0
    first, *rows = (room / "pine.csv").read_text().splitlines()
    assert first == "wavelength [nm],reflectance"
    assert len(rows) == 81


def test_a_file_that_radiance_refuses_is_doubtful(call, room):
    text = (room / "diffuser.xml").read_text()
    spaced = text.replace("<FileType>BSDF<", "<FileType> BSDF <")
    (room / "spaced.xml").write_text(spaced)
    outcome = call("bsdf", "check", "spaced.xml")
    assert outcome.status == 1
    reason = "line 4: FileType is ' BSDF '; 'BSDF' expected"
    assert f"warning: reader: {reason} (Radiance)" in outcome.out
    assert f"spaced.xml: not read by Radiance ({reason})" in outcome.out


def test_remarks_are_reported_on_demand(call):
    outcome = call("bsdf", "check", "diffuser.xml", "--all")
    assert outcome.status == 0
    assert "info: isotropy" in outcome.out


def test_the_effect_of_equal_findings_is_explained_once(call, room):
    """All channels pass twice as much from the front as from the back."""
    front, back = lambertian(0.6, QUARTER), lambertian(0.3, QUARTER)
    functions = {
        (channel, name): of.function(name)
        for channel in ("visible", "solar")
        for of, name in ((front, "transmission_front"), (back, "transmission_back"))
    }
    write_bsdf(room / "unequal.xml", Bsdf(functions))
    lines = call("bsdf", "check", "unequal.xml").out.splitlines()
    sides = [line for line in lines if "warning: sides" in line or ": sides:" in line]
    assert len(sides) == 2
    assert "daylight depends on the side" in sides[0]
    assert sides[1].endswith("equal values expected (solar transmission); as above")


def test_a_doubtful_file_among_sound_ones_fails(call, one_sided):
    outcome = call("bsdf", "check", "diffuser.xml", one_sided)
    assert outcome.status == 1
    lines = outcome.out.splitlines()
    assert lines[0].startswith("diffuser.xml: sound; read by Radiance;")
    assert lines[1].startswith("one_sided.xml: error: empty: all values are zero")
    assert lines[2].startswith("one_sided.xml: read by Radiance;")
    assert len(lines) == 3


def test_an_unreadable_file_does_not_hide_the_others(call, one_sided, room):
    (room / "broken.xml").write_text("<WindowElement>")
    outcome = call("bsdf", "check", "broken.xml", one_sided)
    assert outcome.status == 2
    assert "one_sided.xml: error" in outcome.out
    assert outcome.err.startswith("broken.xml")
    assert outcome.err.count("\n") == 1


def test_findings_come_as_json(call, one_sided):
    outcome = call("bsdf", "check", one_sided, "missing.xml", "--json")
    assert outcome.status == 2
    doubtful, unreadable = json.loads(outcome.out)
    assert doubtful["status"] == "doubtful"
    assert doubtful["findings"][0]["severity"] == "error"
    assert unreadable["status"] == "unreadable"
    assert "cannot be read" in unreadable["error"]


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_plot_writes_a_picture(call, room, suffix):
    outcome = call(
        "bsdf", "plot", "diffuser.xml", "--from", "40,90", "-o", f"a.{suffix}"
    )
    assert outcome.status == 0
    start = (room / f"a.{suffix}").read_bytes()[:5]
    assert start in (b"\x89PNG\r", b"<?xml")


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("--from", "40"), "'40'; two angles"),
        (("--from", "95,0"), "95.0°; an angle from 0"),
        (("--patch", "145"), "0 to 144 expected"),
        (("--channel", "solar"), "'solar'; one of visible expected"),
    ],
)
def test_plot_refuses_what_is_not_there(call, room, words, complaint):
    outcome = call("bsdf", "plot", "diffuser.xml", *words, "-o", "a.png")
    assert outcome.status == 2
    assert complaint in outcome.err
    assert not (room / "a.png").exists()


def test_plot_refuses_other_kinds_of_files(call):
    outcome = call("bsdf", "plot", "diffuser.xml", "-o", "a.doc")
    assert outcome.status == 2
    assert ".png, .svg, .pdf expected" in outcome.err


def test_compare_reports_and_plots_the_difference(call, room):
    write_bsdf(room / "brighter.xml", lambertian(0.6, QUARTER))
    outcome = call(
        "bsdf", "compare", "diffuser.xml", "brighter.xml", "--curve", "-o", "c.png"
    )
    assert outcome.status == 0
    assert "0.5000 and 0.6000" in outcome.out
    assert "+0.1000 on average" in outcome.out
    assert (room / "c.png").stat().st_size > 5000


def test_compare_needs_two_files(call):
    assert call("bsdf", "compare", "diffuser.xml").status == 2


def test_view_names_its_page_after_the_product(call, room):
    assert call("bsdf", "view", "diffuser.xml").status == 0
    assert call("bsdf", "view", "library:diffuser-50").status == 0
    assert (room / "diffuser.html").is_file()
    assert (room / "diffuser-50.html").is_file()


def test_view_writes_one_page(call, room):
    outcome = call("bsdf", "view", "diffuser.xml", "-o", "v.html")
    assert outcome.status == 0
    page = (room / "v.html").read_text("utf-8")
    assert "Lambertian diffuser" in page
    assert "http://" not in page.replace("http://www.w3.org", "")


def test_insert_keeps_the_template(call, room):
    template = lambertian(0.1, QUARTER, reflectance=0.2)
    write_bsdf(room / "template.xml", template)
    outcome = call("bsdf", "insert", "diffuser.xml", "template.xml", "-o", "out.xml")
    assert outcome.status == 0
    assert "visible transmission front" in outcome.out
    assert np.allclose(read_bsdf(room / "out.xml").direct_hemispherical(), 0.5)


def test_insert_names_a_missing_channel(call, room):
    outcome = call(
        "bsdf",
        "insert",
        "diffuser.xml",
        "diffuser.xml",
        "-o",
        "o.xml",
        "--channels",
        "solar",
    )
    assert outcome.status == 2
    assert "no solar channel; one of its channels (visible) expected" in outcome.err
    assert not (room / "o.xml").exists()


def test_info_names_the_basis(call):
    outcome = call("bsdf", "info", "diffuser.xml")
    assert "41 x 41 (LBNL/Klems Quarter): 0.500 from the normal" in outcome.out


def test_conversions_keep_the_flux(call, room):
    assert (
        call(
            "bsdf",
            "convert",
            "diffuser.xml",
            "--to",
            "tree",
            "--halvings",
            "3",
            "-o",
            "t.xml",
        ).status
        == 0
    )
    outcome = call("bsdf", "convert", "t.xml", "--to", "half", "-o", "half.xml")
    assert outcome.status == 0
    assert "diffuse 0.50000 before, 0.50000 after" in outcome.out
    half = read_bsdf(room / "half.xml").function("transmission_front")
    assert len(half.exits) == 77
    assert np.allclose(half.direct_hemispherical(), 0.5, atol=1e-5)


def test_averaging_with_the_reverse_makes_a_layer_sound(call, one_sided):
    words = ("--to", "same", "--reciprocal", "-o", "mended.xml")
    assert call("bsdf", "convert", one_sided, *words).status == 0
    assert call("bsdf", "check", "mended.xml").status == 0


def test_reduction_says_what_it_costs(call):
    words = ("--to", "tree", "--halvings", "3")
    assert call("bsdf", "convert", "diffuser.xml", *words, "-o", "t.xml").status == 0
    outcome = call("bsdf", "reduce", "t.xml", "--percent", "95", "-o", "small.xml")
    assert outcome.status == 0
    assert "of diffuse light redistributed" in outcome.out
    assert "0.500 diffuse" in call("bsdf", "info", "small.xml").out


def test_a_matrix_is_not_reduced(call):
    outcome = call("bsdf", "reduce", "diffuser.xml", "-o", "small.xml")
    assert outcome.status == 2
    assert "--to tree" in outcome.err


@pytest.fixture
def slats(room):
    """A file with a size and geometry."""
    mgf = "v a =\n\tp 0 0 -0.1\nm white =\n\trd 0.5\nsph a 0.1\n"
    product = Product("Ball", "Nobody", "Other", 0.2, 2.0, 1.0, geometry=Geometry(mgf))
    layer = lambertian(0.5, QUARTER, reflectance=0.2)
    write_bsdf(room / "ball.xml", replace(layer, product=product))
    return "ball.xml"


def test_a_layer_is_packaged_for_a_scene(call, room, slats):
    outcome = call("bsdf", "package", slats, "-o", "ball.rad", "--xform", "-t 0 0 5")
    assert outcome.status == 0
    assert outcome.out == "ball.rad: 3 surfaces, 2 with the BSDF\n"
    scene = read_rad(room / "ball.rad")
    assert scene.bounds()[1].round(2).tolist() == [1, 0.5, 5]
    printed = call("bsdf", "package", slats)
    assert "void BSDF m_ball_f" in printed.out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["diffuser.xml", "-o", "x.rad"], "diffuser.xml: the BSDF file has no width"),
        (["ball.xml", "--xform", "-t 0"], "3 numbers expected"),
        (["ball.xml", "--xform", "spin"], "options of xform expected"),
    ],
)
def test_what_cannot_be_packaged_is_reported(call, slats, words, message):
    outcome = call("bsdf", "package", *words)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
