"""Pictures in other bands than red, green and blue."""

import numpy as np
import pytest

from clerestory.bands import Bands
from clerestory.colorimetry import RADIANCE
from clerestory.errors import InputError
from clerestory.image.arithmetic import reduce
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.image.tone_curves import filmic, linear
from clerestory.image.veiling_glare import with_veil
from clerestory.image.visibility_matching import human_vision
from clerestory.scene.view import View
from clerestory.spectral.band_sets import band_set, light_in_bands
from clerestory.spectral.functions import spectral_function

NINE = Bands(tuple(f"band {k}" for k in range(9)), tuple(np.arange(9.0)))


@pytest.fixture
def picture():
    values = np.random.default_rng(2).random((60, 60, 9)).astype(np.float32)
    return Picture(values, view=View(kind="angular"), bands=NINE)


def test_luminance_is_the_sum_of_all_bands(picture):
    expected = np.tensordot(picture.radiance, np.arange(9.0), axes=1)
    assert picture.luminance() == pytest.approx(expected, rel=1e-5)


def test_sizes_and_veils_keep_the_bands(picture):
    """The mean of a picture is that of its reduction, band by band."""
    small = reduce(with_veil(picture), columns=6, rows=5)
    assert small.radiance.shape == (5, 6, 9)
    assert small.bands == NINE
    band = picture.radiance[..., 7:8]
    alone = Picture(np.repeat(band, 3, axis=2), view=picture.view)
    expected = reduce(with_veil(alone), columns=6, rows=5).radiance[..., 0]
    assert small.radiance[..., 7] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("ending", ["hdr", "exr"])
def test_files_hold_red_green_and_blue(picture, tmp_path, ending):
    with pytest.raises(InputError, match="red, green, blue expected"):
        write_picture(picture, tmp_path / f"a.{ending}")


@pytest.mark.parametrize("mapping", [linear, filmic, human_vision])
def test_displays_show_red_green_and_blue(picture, mapping):
    with pytest.raises(InputError, match="red, green, blue expected"):
        mapping(picture)


@pytest.mark.parametrize("ending", ["hdr", "exr"])
def test_files_of_spectral_pictures_have_the_same_luminance(tmp_path, ending):
    """Twenty wavelength intervals: luminance is kept, white and daylight as defined."""
    bands, rng = band_set("20"), np.random.default_rng(4)
    values = 1 + rng.random((6, 8, 20)).astype(np.float32)
    values[0, 0] = 3.0
    values[0, 1] = light_in_bands(spectral_function("d65"), bands)
    shown = Picture(values, bands=bands)
    write_picture(shown, tmp_path / f"a.{ending}")
    read = read_picture(tmp_path / f"a.{ending}")
    assert read.luminance() == pytest.approx(shown.luminance(), rel=0.02)
    assert shown.rgb[0, 0] == pytest.approx(3.0, rel=1e-3)
    x, y, z = RADIANCE.to_xyz() @ shown.rgb[0, 1]
    total = x + y + z
    assert (x / total, y / total) == pytest.approx((0.3127, 0.3290), abs=5e-4)
    light = rgb_luminance(shown.rgb)
    assert light == pytest.approx(shown.luminance(), rel=2e-4)


def rgb_luminance(rgb):
    """Luminance by Radiance's weights of red, green and blue, which are rounded."""
    return Picture(rgb).luminance()


def test_colours_outside_the_gamut_are_desaturated():
    """Light of 500 nm only: no negative values, and its luminance."""
    bands = band_set("20")
    values = np.zeros((1, 1, 20), np.float32)
    values[..., 6] = 5.0
    shown = Picture(values, bands=bands)
    assert shown.rgb.min() >= 0
    assert rgb_luminance(shown.rgb) == pytest.approx(shown.luminance(), rel=2e-4)


def test_pictures_of_weighting_functions_are_grey():
    values = np.random.default_rng(3).random((3, 4, 2)).astype(np.float32)
    shown = Picture(values, bands=band_set("melanopic+photopic"))
    assert np.ptp(shown.rgb, axis=-1).max() == 0
    assert rgb_luminance(shown.rgb) == pytest.approx(shown.luminance(), rel=2e-4)


def test_the_number_of_channels_is_that_of_the_bands(picture):
    with pytest.raises(InputError, match=r"\(rows, columns, 9\) expected"):
        Picture(picture.radiance[..., :3], bands=NINE)
