"""`clerestory glare` and the making of pictures from photographs."""

import json
import math
from pathlib import Path
from statistics import NormalDist

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.scene.view import View

FISHEYE = View(kind="angular", horizontal=180, vertical=180)


def save(path, window=6000.0, view=FISHEYE):
    pixels = np.full((150, 150, 3), 100 / 179, np.float32)
    pixels[30:45, 15:35] = window / 179
    pixels[30, 15] *= 1.1
    write_picture(Picture(pixels, view=view), path)


@pytest.fixture
def desk(room):
    save(room / "desk.hdr")
    return room / "desk.hdr"


def test_text_has_the_lines_of_evalglare(call, desk):
    outcome = call("glare", desk, "--quiet")
    assert outcome.status == 0
    assert outcome.out.startswith("dgp,dgi,ugr,vcp,cgi,Lveil: 0.")
    detail = call("glare", "-d", desk, "-B", "0.3", "-L", 25, 112, 0.2, 0.4).out
    lines = detail.splitlines()
    assert [line.split("_")[0] for line in lines[:3]] == ["band", "z1", "z2"]
    assert lines[3].startswith("3 No pixels x-pos y-pos L_s Omega_s")
    assert lines[-1].startswith("dgp,av_lum,E_v,lum_backg")


def test_numbers_are_there_for_programs(call, desk):
    record = json.loads(call("glare", desk, "--format", "json").out)[0]
    assert record["source_count"] == 1
    assert record["sources"][0]["pixels"] == 300
    header, line = call("glare", desk, "--format", "csv").out.splitlines()
    assert header.startswith("picture,dgp,")
    assert float(line.split(",")[1]) == pytest.approx(record["dgp"])


def test_letters_mean_what_they_mean_to_evalglare(call, desk):
    plain = json.loads(call("glare", desk, "--format", "json").out)[0]
    given = json.loads(call("glare", desk, "--format", "json", "-i", "9000").out)[0]
    assert given["dgp"] > plain["dgp"]
    above = json.loads(call("glare", desk, "--format", "json", "-b", "7000").out)[0]
    assert above["source_count"] == 0
    task = json.loads(
        call("glare", desk, "--format", "json", "-t", 45, 20, 0.4, "-b", 50).out
    )[0]
    assert task["reference_luminance"] == pytest.approx(100, rel=1e-2)
    assert float(call("glare", desk, "-V").out) == pytest.approx(plain["illuminance"])


def test_a_cut_picture_is_filled(call, room):
    """As bright as if the camera had seen the rows above and below."""
    pixels = np.full((150, 150, 3), 100 / 179, np.float32)
    write_picture(Picture(pixels, view=FISHEYE), room / "whole.hdr")
    pixels[:50] = pixels[100:] = 0
    write_picture(Picture(pixels, view=FISHEYE), room / "cut.hdr")

    # The last row seen is number 50 from the top, 99 from below; then 99 and 50
    words = "--format", "json", "-I", 5000, 100, 49
    filled = json.loads(call("glare", "cut.hdr", *words).out)[0]
    whole = json.loads(call("glare", "whole.hdr", "--format", "json").out)[0]
    given = json.loads(call("glare", "whole.hdr", *words[:2], "-i", 5000).out)[0]
    cut = json.loads(call("glare", "cut.hdr", "--format", "json").out)[0]
    assert cut["illuminance"] < 0.75 * whole["illuminance"]
    assert filled["illuminance"] > 0.9 * whole["illuminance"]
    assert filled["dgp"] == pytest.approx(given["dgp"])
    for wrong in ((1, 100, 120), (1, 100, 99), (1, 900, 10), (1, 100, -2)):
        outcome = call("glare", "cut.hdr", "-I", *wrong)
        assert outcome.status == 2
        assert len(outcome.err.splitlines()) == 1


# Options of evalglare that are left out, with words that make sense to it
LEFT_OUT = [
    *("-1", "-2 500", "-3", "-4", "-D", "-g 1", "-k 2", "-m 9000 5000 o.hdr"),
    *("-M 9000 5000 o.hdr", "-N 20 20 .1 5000 o.hdr", "-O 20 20 .1 900 o.hdr", "-p"),
    *("-Q 1 1 x.hdr 1 1 1", "-z .1 1", "-a 50", "-v", "-vta -vh 180 -vv 180"),
]


@pytest.mark.parametrize("words", LEFT_OUT)
def test_options_left_out_are_refused_in_one_line(call, desk, words):
    outcome = call("glare", *words.split(), desk)
    assert outcome.status == 2
    assert len(outcome.err.splitlines()) == 1
    assert "clerestory glare --help" in outcome.err


def test_peaks_are_split_by_default(call, room):
    pixels = np.full((150, 150, 3), 100 / 179, np.float32)
    pixels[30:45, 15:35] = 20_000 / 179
    pixels[33:35, 20:22] = 90_000 / 179
    write_picture(Picture(pixels, view=FISHEYE), room / "peak.hdr")
    for words, count in (((), 2), (("-y",), 2), (("-x",), 1)):
        found = json.loads(call("glare", "peak.hdr", "--format", "json", *words).out)
        assert found[0]["source_count"] == count


def test_a_check_picture_shows_the_sources(call, desk):
    assert call("glare", desk, "-c", "check.hdr", "-T", 45, 20, 0.4).status == 0
    shown = read_picture("check.hdr").radiance
    assert np.ptp(shown[40, 20]) > 1
    assert shown[-21, 45, 0] < 0.05 < shown[-21, 45, 2]
    outcome = call("glare", desk, desk, "-c", "check.hdr")
    assert outcome.status == 2
    assert "--check is given with 2 pictures" in outcome.err


def test_errors_of_pixels_become_errors_of_indices(call, desk):
    """Illuminance is a sum: 2 % of a pixel alone are 2 % of its share."""
    picture = read_picture(desk)
    noise = np.zeros_like(picture.radiance)
    noise[100, 80] = 50.0
    write_picture(Picture(noise, view=FISHEYE), "noise.hdr")
    words = "--error", "noise.hdr", "--format"
    record = json.loads(call("glare", desk, *words, "json").out)[0]
    level = picture.radiance.copy()
    level[100, 80] = 0.0
    write_picture(Picture(level, view=FISHEYE), "less.hdr")
    level[100, 80] = 50.0
    write_picture(Picture(level, view=FISHEYE), "more.hdr")
    found = call("glare", "less.hdr", "more.hdr", "--format", "json").out
    less, more = (each["illuminance"] for each in json.loads(found))
    # Normal distribution of the pixel, of which luminances below zero are zero
    normal = NormalDist(float(picture.radiance[100, 80, 0]), 50.0)
    lit, edge = 1 - normal.cdf(0), normal.variance * normal.pdf(0)
    mean = normal.mean * lit + edge
    square = (normal.mean**2 + normal.variance) * lit + normal.mean * edge
    expected = (more - less) / 50 * math.sqrt(square - mean**2)
    assert record["illuminance_error"] == pytest.approx(expected, rel=0.02)
    assert 0 < record["dgp_error"] < 0.1
    text = call("glare", desk, *words, "text").out.splitlines()
    assert text[1].startswith("dgp_error,dgi_error,ugr_error,vcp_error,cgi_error,")
    assert float(text[1].split()[1]) == pytest.approx(record["dgp_error"], abs=1e-6)
    detail = call("glare", desk, *words, "text", "-d").out.splitlines()
    assert detail[-1].startswith("dgp_error,av_lum_error,E_v_error,")
    assert ",dgp_error," in call("glare", desk, *words, "csv").out.splitlines()[0]
    assert call("glare", desk, *words[:2], "--annual", "year.csv").status == 0
    assert ",dgp_error," in Path("year.csv").read_text().splitlines()[0]
    outcome = call("glare", desk, desk, *words[:2])
    assert outcome.status == 2
    assert "--error is given 1 times for 2 pictures" in outcome.err


def test_a_mask_marks_the_window(call, desk):
    mask = np.zeros((150, 150, 3), np.float32)
    mask[30:45, 15:35] = 1
    write_picture(Picture(mask, view=FISHEYE), "mask.hdr")
    record = json.loads(call("glare", desk, "-A", "mask.hdr", "--format", "json").out)
    assert record[0]["mask"]["pixels"] == 300
    assert record[0]["pgsv"] in (record[0]["pgsv_con"], record[0]["pgsv_sat"])
    assert "pgsv_con,pgsv_sat,pgsv: " in call("glare", desk, "-A", "mask.hdr").out
    write_picture(Picture(mask[:60], view=FISHEYE), "small.hdr")
    outcome = call("glare", desk, "-A", "small.hdr")
    assert outcome.status == 2
    assert outcome.err.startswith("small.hdr: a mask of 150 × 60 pixels")


def test_pictures_become_a_year(call, desk):
    save("later.hdr", window=9000.0)
    assert call("glare", desk, "later.hdr", "--annual", "year.nc").status == 0
    with xr.open_dataset("year.nc", engine="h5netcdf") as year:
        assert year.dgp.values[1] > year.dgp.values[0]
    assert call("glare", desk, "later.hdr", "--annual", "year.csv").status == 0
    assert len(Path("year.csv").read_text().splitlines()) == 3
    assert call("glare", desk, "--annual", "year.txt").status == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("nowhere.hdr",), "nowhere.hdr: cannot be read"),
        (("blind.hdr",), "picture has no view"),
        (("blind.hdr", "--view", "-vtl -vh 2 -vv 2"), "a parallel view"),
        (("torn.hdr",), "torn.hdr"),
        (("desk.hdr", "-t", "500", "1", "0.1"), "a pixel of the picture expected"),
        (("desk.hdr", "-r", "0"), "merging angle is 0 rad; a positive number"),
    ],
)
def test_bad_input_is_reported_in_one_line(call, desk, words, message):
    save("blind.hdr", view=None)
    whole = desk.read_bytes()
    desk.with_name("torn.hdr").write_bytes(whole[: len(whole) // 2])
    outcome = call("glare", *words)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1


def test_a_view_can_be_given(call, desk):
    save("blind.hdr", view=None)
    options = "-vta -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180"
    seen = call("glare", "blind.hdr", "--view", options).out
    assert seen == call("glare", desk).out


def test_photographs_become_a_calibrated_picture(call, room):
    pytest.importorskip("cv2")
    column = np.arange(120) * np.ones((120, 1))
    scene = np.repeat((10 ** (column / 40.0 - 1))[..., None], 3, axis=2)
    names, times = [], []
    for stop in range(7):
        time = 4.0**-stop * 8
        value = np.clip((scene * time / 255) ** (1 / 2.2) * 255, 0, 255)
        Image.fromarray(np.rint(value).astype(np.uint8)).save(f"shot{stop}.png")
        names.append(f"shot{stop}.png")
        times += ["--time", time]
    (room / "camera.rsp").write_text("2 1 0 0\n" * 3)
    done = call(
        "picture", "merge", *names, *times, "--response", "camera.rsp", "-o", "m.hdr"
    )
    assert done.status == 0, done.err
    done = call(
        "picture", "reproject", "m.hdr", "-o", "f.hdr", "--lens", "equidistant",
        "--resolution", 100,
    )  # fmt: skip
    assert done.status == 0, done.err
    done = call(
        "picture", "calibrate", "f.hdr", "--before", 900, "--after", 905, "-o", "c.hdr"
    )
    assert done.status == 0, done.err
    lux = float(call("glare", "c.hdr", "-V", "-f").out)
    assert lux == pytest.approx(902.5, rel=0.01)
    assert call("picture", "merge", *names, "-o", "m.hdr").status == 2
