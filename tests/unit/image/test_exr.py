"""OpenEXR pictures: round trips, attributes, what is refused."""

import numpy as np
import OpenEXR
import pytest

from clerestory.errors import InputError, OutputError
from clerestory.image.exr import write_exr
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.scene.view import View


def random_picture(**more):
    rng = np.random.default_rng(6)
    return Picture(rng.normal(0, 9, (5, 8, 3)).astype(np.float32), **more)


def raw_file(path, values, **header):
    base = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(base | header, values).write(str(path))
    return path


def test_all_attributes_are_read_back(tmp_path):
    picture = random_picture(
        view=View(kind="angular", horizontal=180, vertical=170),
        header=("made by hand", "in two steps"),
        pixel_aspect=1.5,
        quantity="irradiance",
    )
    write_picture(picture, tmp_path / "a.exr")
    again = read_picture(tmp_path / "a.exr")
    assert np.array_equal(again.radiance, picture.radiance)
    assert (again.view.kind, again.view.vertical) == ("angular", 170)
    assert again.header == picture.header
    assert again.pixel_aspect == pytest.approx(1.5)
    assert again.quantity == "irradiance"


def test_16_bits_keep_three_digits(tmp_path):
    picture = random_picture()
    write_exr(picture, tmp_path / "a.exr", half=True)
    again = read_picture(tmp_path / "a.exr").radiance
    assert np.allclose(again, picture.radiance, rtol=2**-11)
    bright = Picture(np.full((1, 1, 3), 7e4, dtype=np.float32))
    with pytest.raises(InputError, match="16-bit OpenEXR"):
        write_exr(bright, tmp_path / "b.exr", half=True)


def test_white_luminance_scales(tmp_path):
    values = np.ones((2, 2, 3), dtype=np.float32)
    path = raw_file(tmp_path / "a.exr", {"RGB": values}, whiteLuminance=1.0)
    assert read_picture(path).luminance() == pytest.approx(1.0)


def test_other_primaries_become_radiance_s(tmp_path):
    values = np.array([[[1, 0, 0], [1, 1, 1]]], dtype=np.float32)
    swapped = (0.15, 0.06, 0.29, 0.6, 0.64, 0.33, 1 / 3, 1 / 3)
    path = raw_file(tmp_path / "a.exr", {"RGB": values}, chromaticities=swapped)
    expected = [[0, 0, 1], [1, 1, 1]]
    assert np.allclose(read_picture(path).radiance[0], expected, atol=1e-6)


def test_a_part_is_placed_in_its_display_window(tmp_path):
    values = np.ones((2, 3, 3), dtype=np.float32)
    windows = {
        "dataWindow": (np.array([1, 2], np.int32), np.array([3, 3], np.int32)),
        "displayWindow": (np.array([0, 0], np.int32), np.array([4, 5], np.int32)),
    }
    path = raw_file(tmp_path / "a.exr", {"RGB": values}, **windows)
    expected = np.zeros((6, 5))
    expected[2:4, 1:4] = 1
    assert np.array_equal(read_picture(path).radiance[..., 0], expected)


def test_a_single_channel_is_grey(tmp_path):
    grey = np.arange(6, dtype=np.float32).reshape(2, 3)
    path = raw_file(tmp_path / "a.exr", {"Y": grey})
    assert np.array_equal(read_picture(path).radiance[..., 2], grey)


def test_what_is_no_picture_is_refused(tmp_path, capfd):
    z = np.ones((2, 2), dtype=np.float32)
    with pytest.raises(InputError, match="channels Z; R, G, B"):
        read_picture(raw_file(tmp_path / "a.exr", {"Z": z}))
    bad = np.full((1, 1, 3), np.inf, dtype=np.float32)
    with pytest.raises(InputError, match=r"b\.exr: the pixel in row 0"):
        read_picture(raw_file(tmp_path / "b.exr", {"RGB": bad}))
    write_picture(random_picture(), tmp_path / "c.exr")
    whole = (tmp_path / "c.exr").read_bytes()
    for cut in (8, 100, len(whole) - 30):
        (tmp_path / "d.exr").write_bytes(whole[:cut])
        with pytest.raises(InputError, match="damaged OpenEXR file") as caught:
            read_picture(tmp_path / "d.exr")
        assert "\n" not in str(caught.value)


def test_a_folder_that_is_missing_is_reported(tmp_path):
    with pytest.raises(OutputError):
        write_picture(random_picture(), tmp_path / "nowhere" / "a.exr")
