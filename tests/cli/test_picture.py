"""`clerestory picture`: what is written and said, and one-line errors."""

import numpy as np
import pytest
from PIL import Image

from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.scene.view import View


@pytest.fixture
def pictures(room):
    """A ramp of 0 … 1000 cd/m² and a flat picture, 40 × 30 pixels."""
    values = np.tile(np.linspace(0, 1000, 40, dtype=np.float32) / 179, (30, 1))
    ramp = np.repeat(values[..., None], 3, axis=-1)
    write_picture(Picture(ramp, view=View(), header=("made",)), room / "ramp.hdr")
    write_picture(Picture(np.ones_like(ramp)), room / "flat.exr")
    return room


def test_info_reports_size_view_and_luminance(call, pictures):
    outcome = call("picture", "info", "ramp.hdr", "flat.exr", "--header")
    assert outcome.status == 0
    lines = outcome.out.splitlines()
    assert lines[0] == "ramp.hdr: 40 × 30 pixels of radiance"
    assert lines[1].strip().startswith("view  -vtv -vp 0 0 0")
    assert "mean 500" in lines[2]
    assert lines[4] == "  | made"
    assert "largest 179" in outcome.out


def pixels_of(path):
    with Image.open(path) as image:
        return np.asarray(image).astype(int)


@pytest.mark.parametrize("method", ["human", "filmic", "linear"])
def test_tonemap_writes_images(call, pictures, method):
    outcome = call("picture", "tonemap", "ramp.hdr", "--method", method, "-o", "a.png")
    assert (outcome.status, outcome.out) == (0, "a.png: written\n")
    row = pixels_of("a.png")[10, :, 1]
    assert row.shape == (40,)
    assert (np.diff(row) >= 0).all()


def test_falsecolour_has_a_legend_by_default(call, pictures):
    options = ("ramp.hdr", "--to", "1000", "--quiet")
    assert call("picture", "falsecolour", *options, "-o", "a.png").out == ""
    assert pixels_of("a.png").shape[1] > 60
    call("picture", "falsecolour", *options, "--no-legend", "-e", "-o", "b.jpg")
    assert pixels_of("b.jpg").shape == (30, 40, 3)
    # The American spelling, and a logarithmic scale
    outcome = call("picture", "falsecolor", "ramp.hdr", "--log", "2", "-o", "c.png")
    assert outcome.status == 0


def test_sums_are_weighted(call, pictures):
    words = "ramp.hdr flat.exr --weight 2 --weight 10 -o a.exr"
    assert call("picture", "sum", *words.split()).status == 0
    ramp = read_picture("ramp.hdr").radiance
    assert np.allclose(read_picture("a.exr").radiance, 2 * ramp + 10)
    assert call("picture", "sum", "ramp.hdr", "flat.exr", "-o", "b.exr").status == 0
    assert np.allclose(read_picture("b.exr").radiance, ramp + 1)


def test_reduce_and_crop(call, pictures):
    call("picture", "reduce", "ramp.hdr", "--factor", "2", "-o", "a.exr")
    assert read_picture("a.exr").radiance.shape == (15, 20, 3)
    call("picture", "reduce", "ramp.hdr", "--size", "10", "30", "-o", "b.exr")
    assert read_picture("b.exr").radiance.shape == (30, 10, 3)
    words = "--corner 5 6 --size 8 4 -o c.exr"
    call("picture", "crop", "ramp.hdr", *words.split())
    ramp = read_picture("ramp.hdr").radiance
    assert np.array_equal(read_picture("c.exr").radiance, ramp[6:10, 5:13])


def test_convert_keeps_values(call, pictures):
    ramp = read_picture("ramp.hdr").radiance
    for options in ("-o a.exr", "--half -o a.exr", "--xyz --exposure 3 -o a.hdr"):
        assert call("picture", "convert", "ramp.hdr", *options.split()).status == 0
        again = read_picture(options.split()[-1]).radiance
        assert np.allclose(again, ramp, rtol=0.02, atol=1e-3)
    call("picture", "convert", "ramp.hdr", "--scale", "2", "-o", "b.exr")
    assert np.allclose(read_picture("b.exr").radiance, 2 * ramp)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("info nothing.hdr", "nothing.hdr: cannot be read"),
        ("info room.rad", "room.rad: not a picture"),
        ("tonemap ramp.hdr -o a.gif", "extension of a.gif is '.gif'; one of .png"),
        ("tonemap ramp.hdr --white 5 -o a.png", "filmic or linear expected"),
        ("falsecolour ramp.hdr --palette rainbows -o a.png", 'palette "rainbows"'),
        (
            "falsecolour ramp.hdr --log 2 --from 3 -o a.png",
            "--from is given with --log",
        ),
        ("sum ramp.hdr flat.exr --weight 1 -o a.hdr", "1 weights for 2 pictures"),
        ("reduce ramp.hdr -o a.hdr", "either --factor or --size"),
        ("crop ramp.hdr --corner 0 0 --size 99 9 -o a.hdr", "within 40 × 30"),
        ("convert ramp.hdr --half -o a.hdr", "--half for a.hdr; .exr expected"),
        ("convert ramp.hdr -o a.tif", ".hdr, .pic, .exr expected"),
    ],
)
def test_errors_are_one_line_with_what_was_expected(call, pictures, words, message):
    outcome = call("picture", *words.split())
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1


@pytest.mark.parametrize(
    "command",
    ["info", "tonemap", "falsecolour", "sum", "reduce", "crop", "convert"],
)
def test_every_command_has_help_with_an_example(call, command):
    outcome = call("picture", command, "--help")
    assert f"Example: clerestory picture {command}" in " ".join(outcome.out.split())


def test_a_denoised_picture_says_so(call, tmp_path, monkeypatch):
    pytest.importorskip("mitsuba_oidn", reason="the extra `denoise`")
    monkeypatch.chdir(tmp_path)
    write_picture(Picture(np.ones((32, 32, 3), dtype=np.float32)), "a.hdr")
    assert call("picture", "denoise", "a.hdr", "-o", "b.hdr").status == 0
    assert "DENOISED=" in call("picture", "info", "b.hdr", "--header").out
