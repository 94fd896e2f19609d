"""Radiance pictures: headers, orientations, round trips, what is refused."""

import contextlib
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError, OutputError
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.image.radiance_hdr import write_radiance
from clerestory.scene.view import View

# Mantissa m and exponent e stand for (m + ½)·2^(e − 136)
ONE = bytes([128, 128, 128, 129])
RED = bytes([200, 0, 0, 128])


def picture_file(folder, *, header="", size="-Y 1 +X 1", pixels=ONE):
    path = folder / "a.hdr"
    text = f"#?RADIANCE\n{header}FORMAT=32-bit_rle_rgbe\n\n{size}\n"
    path.write_bytes(text.encode() + pixels)
    return path


def random_picture(rows=13, columns=17, seed=1, **more):
    rng = np.random.default_rng(seed)
    values = np.exp(rng.normal(0, 5, (rows, columns, 3))).astype(np.float32)
    return Picture(values, **more)


def test_mantissas_stand_for_the_middle_of_their_interval(tmp_path):
    value = read_picture(picture_file(tmp_path)).radiance[0, 0, 0]
    assert value == pytest.approx(128.5 / 128)


def test_exponent_zero_is_black(tmp_path):
    path = picture_file(tmp_path, pixels=bytes([255, 255, 255, 0]))
    assert not read_picture(path).radiance.any()


def test_exposures_and_corrections_multiply_and_are_divided_out(tmp_path):
    header = "EXPOSURE=4\npfilt -1\nEXPOSURE= 5e-1\nCOLORCORR= 1 2 4\n\tEXPOSURE=9\n"
    picture = read_picture(picture_file(tmp_path, header=header))
    assert picture.radiance[0, 0] * [2, 4, 8] == pytest.approx(128.5 / 128)
    assert picture.header == ("pfilt -1", "\tEXPOSURE=9")


def test_pixel_aspects_multiply(tmp_path):
    header = "PIXASPECT=0.5\nPIXASPECT=1.5\n"
    assert read_picture(picture_file(tmp_path, header=header)).pixel_aspect == 0.75


def test_the_last_view_counts_and_builds_on_those_before(tmp_path):
    header = "rpict -vth -vp 1 2 3 -vh 90\nVIEW= -vd 1 0 0 -vh 180\n\tVIEW= -vh 20\n"
    view = read_picture(picture_file(tmp_path, header=header)).view
    assert view.kind == "hemispherical"
    assert (view.position.tolist(), view.horizontal) == ([1, 2, 3], 180)


def test_a_view_that_cannot_be_is_reported_and_left_out(tmp_path):
    path = picture_file(tmp_path, header="VIEW= -vtv -vh 200\n")
    with pytest.warns(
        ClerestoryWarning, match="horizontal size of the perspective view is 200"
    ):
        assert read_picture(path).view is None


def test_irradiance_is_known_by_the_command_that_made_it(tmp_path):
    for header, quantity in {
        "rpict -vh 60 -i a.oct\n": "irradiance",
        "/usr/bin/rtrace -i+ -x 3 a.oct\n": "irradiance",
        "rpict -i -vh 60 -i- a.oct\n": "radiance",
        "pcomb -i a.oct\n": "radiance",
        "rpict -i a.oct\nQUANTITY=radiance\n": "radiance",
    }.items():
        path = picture_file(tmp_path, header=header)
        assert read_picture(path).quantity == quantity


ORIENTATIONS = {
    "-Y 2 +X 3": lambda a: a,
    "-Y 2 -X 3": lambda a: a[:, ::-1],
    "+Y 2 +X 3": lambda a: a[::-1],
    "+Y 2 -X 3": lambda a: a[::-1, ::-1],
    "+X 3 -Y 2": lambda a: a.transpose(1, 0, 2),
    "+X 3 +Y 2": lambda a: a[::-1].transpose(1, 0, 2),
    "-X 3 -Y 2": lambda a: a[:, ::-1].transpose(1, 0, 2),
    "-X 3 +Y 2": lambda a: a[::-1, ::-1].transpose(1, 0, 2),
}


@pytest.mark.parametrize("size", ORIENTATIONS)
def test_pictures_stand_upright_whatever_the_order_of_the_file(size, tmp_path):
    mantissa = np.arange(128, 146, dtype=np.uint8).reshape(2, 3, 3)
    quads = np.concatenate([mantissa, np.full((2, 3, 1), 136, np.uint8)], axis=2)
    stored = np.ascontiguousarray(ORIENTATIONS[size](quads))
    path = picture_file(tmp_path, size=size, pixels=stored.tobytes())
    assert np.array_equal(read_picture(path).radiance, mantissa + 0.5)


@pytest.mark.parametrize("columns", [1, 7, 8, 300])
@pytest.mark.parametrize("xyz", [False, True])
def test_what_is_written_is_read(columns, xyz, tmp_path):
    view = View(kind="angular", horizontal=180, vertical=180)
    picture = random_picture(
        columns=columns, view=view, header=("made by hand",), pixel_aspect=1.5
    )
    write_radiance(picture, tmp_path / "a.hdr", exposure=3.7, xyz=xyz)
    again = read_picture(tmp_path / "a.hdr")
    # A mantissa is off by half a step of the pixel's largest component, 1/256
    largest = picture.radiance.max(axis=2, keepdims=True)
    bound = 0.02 if xyz else 1 / 256
    assert (np.abs(again.radiance - picture.radiance) <= bound * largest).all()
    assert again.view.kind == "angular"
    assert again.header == ("made by hand",)
    assert again.pixel_aspect == 1.5


def test_writing_twice_changes_nothing_more(tmp_path):
    write_picture(random_picture(), tmp_path / "a.hdr")
    once = read_picture(tmp_path / "a.hdr")
    write_picture(once, tmp_path / "b.hdr")
    assert (tmp_path / "a.hdr").read_bytes() == (tmp_path / "b.hdr").read_bytes()


def test_the_quantity_is_read_back(tmp_path):
    for quantity in ("radiance", "irradiance"):
        picture = random_picture(quantity=quantity, header=("rpict -i a.oct",))
        write_picture(picture, tmp_path / "a.hdr")
        assert read_picture(tmp_path / "a.hdr").quantity == quantity


def test_a_command_does_not_bring_back_a_view_that_was_dropped(tmp_path):
    picture = random_picture(header=("rpict -vth -vh 90 a.oct",))
    write_picture(picture, tmp_path / "a.hdr")
    assert read_picture(tmp_path / "a.hdr").view is None


def test_values_beyond_the_format_are_cut(tmp_path):
    values = np.array([[[-1, 0, 0], [3e38, 1, 1], [1e-35, 0, 0]]], dtype=np.float32)
    write_picture(Picture(values), tmp_path / "a.hdr")
    again = read_picture(tmp_path / "a.hdr").radiance
    assert again[0, 0].tolist() == [0, 0, 0]
    assert again[0, 1, 0] == pytest.approx(255.5 / 256 * 2.0**127)
    assert again[0, 2].tolist() == [0, 0, 0]


def test_other_primaries_become_radiance_s(tmp_path):
    """White stays white, and swapped red and blue are swapped back."""
    swapped = "PRIMARIES= .15 .06 .29 .6 .64 .33 .3333333 .3333333\n"
    path = picture_file(tmp_path, header=swapped, pixels=RED)
    value = read_picture(path).radiance[0, 0]
    assert value[2] == pytest.approx(200.5 / 256, rel=1e-4)
    d65 = "PRIMARIES= .64 .33 .3 .6 .15 .06 .3127 .329\n"
    white = read_picture(picture_file(tmp_path, header=d65)).radiance[0, 0]
    assert white == pytest.approx(np.full(3, 128.5 / 128), rel=1e-3)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"header": "EXPOSURE=0\n"}, r":2: EXPOSURE \"0\"; a positive number"),
        ({"header": "x\nEXPOSURE=nan\n"}, ":3: EXPOSURE"),
        ({"header": "FORMAT=Radiance_spectra\n"}, ":2: format is 'Radiance_spectra'"),
        ({"header": "PRIMARIES=1 2 3\n"}, "3 words"),
        ({"header": "PRIMARIES=.3 .3 .3 .3 .3 .3 .3 .3\n"}, "lie on a line"),
        ({"header": "COLORCORR=1 1\n"}, "2 words"),
        ({"size": "-Y 2"}, 'resolution "-Y 2"'),
        ({"size": "-Y 2 +Y 2"}, 'resolution "-Y 2'),
        ({"size": "-Y 0 +X 3"}, "0 pixels|3 × 0 pixels"),
        ({"size": "-Y 999999999 +X 999999999"}, "million expected"),
        ({"size": "-Y 1000 +X 1000"}, "damaged pixel data: the file ends"),
        ({"pixels": b""}, "damaged pixel data: the file ends"),
    ],
)
def test_broken_files_are_refused_in_one_line(parts, words, tmp_path):
    with pytest.raises(InputError, match=words) as caught:
        read_picture(picture_file(tmp_path, **parts))
    assert "\n" not in str(caught.value)
    assert "a.hdr" in str(caught.value)


def test_a_header_without_end_is_refused(tmp_path):
    path = tmp_path / "a.hdr"
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n")
    with pytest.raises(InputError, match="does not end"):
        read_picture(path)


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "a.hdr"
    path.write_bytes(b"GIF89a")
    with pytest.raises(InputError, match="not a picture"):
        read_picture(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_picture(tmp_path / "b.hdr")
    with pytest.raises(InputError, match=r"\.hdr"):
        write_picture(random_picture(), tmp_path / "a.gif")
    with pytest.raises(OutputError):
        write_picture(random_picture(), tmp_path / "nowhere" / "a.hdr")


@given(data=st.binary(max_size=200), cut=st.integers(0, 2000))
def test_any_bytes_are_read_or_refused(tmp_path_factory, data, cut):
    folder = tmp_path_factory.getbasetemp()
    write_picture(random_picture(rows=3, columns=9), folder / "f.hdr")
    whole = bytearray((folder / "f.hdr").read_bytes())
    cut = min(cut, len(whole))
    whole[cut : cut + len(data)] = data
    (folder / "f.hdr").write_bytes(whole)
    with contextlib.suppress(InputError):
        read_picture(folder / "f.hdr")


def test_pictures_check_themselves():
    bad = np.ones((2, 3, 3), dtype=np.float32)
    bad[1, 2, 0] = np.nan
    with pytest.raises(InputError, match="row 1, column 2 is not finite"):
        Picture(bad)
    with pytest.raises(InputError, match=r"shape \(2, 3, 1\)"):
        Picture(bad[..., :1])
    with pytest.raises(InputError, match="pixel aspect is 0"):
        Picture(np.ones((1, 1, 3), dtype=np.float32), pixel_aspect=0)


def test_luminance_is_distinguished_from_illuminance():
    """179 lm/W times Radiance's weights of red, green and blue."""
    values = np.array([[[1, 0, 0], [0, 1, 0], [0, 0, 1]]], dtype=np.float32)
    expected = pytest.approx([47.435, 119.93, 11.635], rel=1e-5)
    assert Picture(values).luminance()[0] == expected
    irradiance = Picture(values, quantity="irradiance")
    assert irradiance.illuminance()[0] == expected
    with pytest.raises(InputError, match="use illuminance"):
        irradiance.luminance()
    with pytest.raises(InputError, match="use luminance"):
        Picture(values).illuminance()


@pytest.mark.parametrize("header", ["", "EXPOSURE=2\n"])
@pytest.mark.parametrize("runs", [True, False])
def test_reading_takes_little_more_memory_than_the_picture(tmp_path, header, runs):
    """9 million pixels; 30 kB of repeated pixels can describe as many."""
    row = bytes([100, 100, 100, 128, 1, 1, 1, 0xB7, 1, 1, 1, 0xB])
    if runs:
        row = b"\2\2" + (3000).to_bytes(2) + (b"\xff\x80" * 23 + b"\xcf\x80") * 4
    path = picture_file(
        tmp_path, header=header, size="-Y 3000 +X 3000", pixels=row * 3000
    )
    tracemalloc.start()
    values = read_picture(path).radiance
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert values.shape == (3000, 3000, 3)
    assert np.ptp(values) == 0
    assert most < values.nbytes + 50e6
