"""Pictures, suns and five phases from the command line, in the ten-polygon room."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.image.picture_files import read_picture
from clerestory.matrix.netcdf import read_netcdf

EYE = "-vta -vp 1.5 1.5 1.2 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180"
SKY = "gensky 6 21 12 -a 48 -o -11 -m -15 +s"
RENDER = ("render", "--scene", "room.rad", "--view", EYE, "--resolution", 12)
VIEW = ("trace", "view", "--scene", "room.rad", "--window", "window.rad")
SUN = (
    *("trace", "sun", "--scene", "room.rad", "--window", "window.rad"),
    *("--bsdf", "diffuser.xml", "--weather", "two_days.wea", "--samples", 16),
)


def test_a_picture_is_rendered_under_a_generated_sky(call, room):
    outcome = call(
        *RENDER, "--sky", SKY, "--samples", 8, "-o", "a.hdr", "--error", "e.hdr"
    )
    assert outcome.status == 0, outcome.err
    assert "12 × 12 pixels" in outcome.out
    picture = read_picture("a.hdr")
    assert (picture.rows, picture.columns) == (12, 12)
    assert picture.view is not None
    assert picture.view.kind == "angular"
    assert picture.luminance().max() > 0
    assert read_picture("e.hdr").radiance.max() > 0


def test_a_picture_in_bands_has_the_colours_of_spectra(call, room):
    """Walls of red brick, by three bands: redder than the grey ones."""
    shown = []
    for spectral in ((), ("--spectral", "3", "--spectrum", "grey=library:brick-red")):
        outcome = call(*RENDER, "--sky", SKY, "--samples", 8, *spectral, "-o", "a.hdr")
        assert outcome.status == 0, outcome.err
        shown.append(read_picture("a.hdr").radiance.mean(axis=(0, 1)))
    (red, _, blue), (brick_red, _, brick_blue) = shown
    assert red == pytest.approx(blue, rel=0.02)
    assert brick_red > 1.05 * brick_blue


def test_a_picture_shows_illuminance_where_asked(call, room):
    outcome = call(
        *RENDER, "--sky", SKY, "--samples", 8, "-o", "a.hdr", "--illuminance"
    )
    assert outcome.status == 0, outcome.err
    assert "lux" in outcome.out
    assert read_picture("a.hdr").illuminance().max() > 0


def test_a_picture_is_rendered_up_to_an_error_of_dgp(call, room):
    eye = ("--view", EYE, "--resolution", 24, "--bounces", 1)
    goal = ("--dgp-error", 0.02, "-o", "a.hdr", "--error", "e.hdr")
    outcome = call(*RENDER[:-4], *eye, "--sky", SKY, *goal)
    assert outcome.status == 0, outcome.err
    outcome = call("glare", "a.hdr", "--error", "e.hdr", "--format", "json")
    assert outcome.status == 0, outcome.err
    assert 0 < json.loads(outcome.out)[0]["dgp_error"] < 0.023

    # Two targets, and a view without DGP
    outcome = call(*RENDER[:-4], *eye, "--sky", SKY, *goal, "--samples", 8)
    assert outcome.status == 2
    assert "a goal and samples" in outcome.err


def test_a_preview_is_written_from_coarse_to_fine(call, room):
    goal = ("--sky", SKY, "--relative-error", 0.3, "--bounces", 1)
    outcome = call(*RENDER, *goal, "-o", "a.hdr", "--preview")
    assert outcome.status == 0, outcome.err
    lines = outcome.out.splitlines()
    assert len(lines) > 4
    assert all("a.hdr: 12 × 12 pixels" in line for line in lines)
    call(*RENDER, *goal, "-o", "b.hdr")
    one, two = read_picture("a.hdr"), read_picture("b.hdr")
    assert (one.radiance == two.radiance).all()


def test_a_picture_is_rendered_at_a_time_of_the_weather(call, room):
    words = ("--weather", "two_days.wea", "--time", "2023-06-21T12:30")
    outcome = call(*RENDER, *words, "--samples", 4, "-o", "a.hdr", "--quiet")
    assert outcome.status == 0, outcome.err
    assert read_picture("a.hdr").luminance().max() > 0


def test_window_emitters_are_written_to_a_file(call, room):
    Path("cloth.rad").write_text("void trans cloth 0 0 7 .9 .9 .9 0 0 .6 0\n")
    corners = "0 0 0 0 0 3 3 0 3 3 0 0"
    Path("panes.rad").write_text(f"cloth polygon pane 0 0 12 {corners}\n")
    scene = ("--scene", "room.rad", "cloth.rad", "--sky", SKY, "--samples", 8)
    outcome = call(
        *("illum", *scene, "--panes", "panes.rad", "--rings", 4, "-o", "lamps.rad")
    )
    assert outcome.status == 0, outcome.err
    assert "1 window emitters" in outcome.out
    lit = ("--scene", "room.rad", "cloth.rad", "lamps.rad", *scene[3:])
    outcome = call(
        *("render", *lit, "--view", EYE, "--resolution", 12, "-o", "a.hdr", "--quiet")
    )
    assert outcome.status == 0, outcome.err
    Path("panes.rad").write_text(
        Path("cloth.rad").read_text().replace("cloth", "other")
        + f"other polygon pane 0 0 12 {corners}\n"
    )
    outcome = call("illum", *scene, "--panes", "panes.rad", "-o", "lamps.rad")
    assert outcome.status == 2
    assert "panes.rad:2: pane" in outcome.err


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("--sky", "genbox a b 1 1 1"), "gensky or gendaylit expected"),
        (
            ("--sky", SKY, "--time", "2023-06-21T12:00"),
            "--sky, or --time with --weather",
        ),
        (("--time", "noon", "--weather", "two_days.wea"), "--time is noon; a time"),
        (
            ("--time", "2023-06-21T00:30", "--weather", "two_days.wea"),
            "the diffuse irradiance is 0",
        ),
        (
            ("--time", "2023-03-21T12:30", "--weather", "two_days.wea"),
            "no weather at 03-21 12:30",
        ),
        ((), "the scene has no light source"),
        (("--sky", "missing.rad"), "missing.rad"),
        (("--sky", SKY, "--samples", "8", "--relative-error", "0.1"), "both samples"),
    ],
)
def test_bad_light_is_one_line(call, room, words, complaint):
    outcome = call(*RENDER, *words, "-o", "a.hdr")
    assert outcome.status == 2
    assert complaint in outcome.err
    assert outcome.err.count("\n") == 1
    assert not Path("a.hdr").exists()


def test_a_view_that_is_none_is_one_line(call, room):
    words = ("render", "--scene", "room.rad", "--view", "-vtq", "--sky", SKY)
    outcome = call(*words, "-o", "a.hdr")
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1


def test_the_view_matrix_of_a_picture_is_a_picture_a_patch(call, room):
    view = (*VIEW, "--samples", 16)
    outcome = call(*view, "--view", EYE, "--resolution", 8, "-o", "V_%03d.hdr")
    assert outcome.status == 0, outcome.err
    pictures = sorted(Path().glob("V_*.hdr"))
    assert pictures[0].name == "V_000.hdr"
    first = read_picture(pictures[0])
    assert (first.rows, first.columns) == (8, 8)
    total = sum(read_picture(path).radiance for path in pictures)

    # The same as a matrix, and its direct part, which is no brighter
    call(*view, "--view", EYE, "--resolution", 8, "-o", "V.nc")
    whole = read_netcdf("V.nc")
    assert whole.rows.kind == "pixel"
    assert whole.values.shape == (3, 64, len(pictures))
    summed = whole.values.sum(axis=2).T.reshape(8, 8, 3)
    assert np.allclose(summed, total, rtol=0.02, atol=1e-3)
    call(*view, "--view", EYE, "--resolution", 8, "--direct", "-o", "Vd.nc")
    assert read_netcdf("Vd.nc").values.sum() < 1.05 * whole.values.sum()


def test_either_sensors_or_a_view(call, room):
    words = (*VIEW, "-o", "V.nc")
    for more in ((), ("--sensors", "desk.pts", "--view", EYE)):
        outcome = call(*words, *more)
        assert outcome.status == 2
        assert "either --sensors or --view expected" in outcome.err


def test_suns_are_traced_to_sensors_and_pixels(call, room):
    outcome = call(*SUN, "--sensors", "desk.pts", "-o", "C.nc")
    assert outcome.status == 0, outcome.err
    matrix = read_netcdf("C.nc")
    assert matrix.columns.kind == "sun"
    assert matrix.values.max() > 0
    assert matrix.standard_error.max() > 0
    outcome = call(*SUN, "--view", EYE, "--resolution", 8, "-o", "P.nc")
    assert outcome.status == 0, outcome.err
    pixels = read_netcdf("P.nc")
    assert pixels.values.shape == (3, 64, matrix.columns.size)


def test_suns_have_enough_paths_by_default(call, room):
    """Two per cent of the brightest coefficients, and as `sun_coefficients` has."""
    outcome = call(*SUN[:-2], "--sensors", "desk.pts", "-o", "C.nc")
    assert outcome.status == 0, outcome.err
    matrix = read_netcdf("C.nc")
    assert matrix.standard_error.max() < 0.02 * matrix.values.max()


def test_a_study_of_five_phases_with_a_view(call, room):
    study = Path("study.toml").read_text().replace('"3-phase"', '"5-phase"')
    Path("eye.vf").write_text(f"rvu {EYE}\n")
    study += (
        '\n[[view]]\nname = "eye"\nfile = "eye.vf"\nresolution = 32\nsamples = 16\n'
    )
    study += "\n[sun]\nsamples = 16\npicture_samples = 4\n"
    Path("five.toml").write_text(study)
    outcome = call("run", "five.toml", "--out", "five", "--quiet")
    assert outcome.status == 0, outcome.err
    with xr.open_dataset("five/results.nc") as data:
        terms = data["three_phase"] - data["direct_in_patches"] + data["direct_sun"]
        assert np.allclose(data["illuminance"], terms, rtol=1e-4, atol=0.1)
        assert data["glare_dgp"].dims == ("view", "time")
        assert np.isfinite(data["glare_dgp"]).any()
    found = json.loads(Path("five/run.json").read_text())["matrices"]
    assert any(name.startswith("sun-") for name in found)
    assert any(name.startswith("direct-daylight-") for name in found)
