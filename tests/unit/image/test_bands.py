"""Pictures in other bands than red, green and blue."""

import numpy as np
import pytest

from clerestory.bands import Bands
from clerestory.errors import InputError
from clerestory.image.arithmetic import reduce
from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.image.tone_curves import filmic, linear
from clerestory.image.veiling_glare import with_veil
from clerestory.image.visibility_matching import human_vision
from clerestory.scene.view import View

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


def test_the_number_of_channels_is_that_of_the_bands(picture):
    with pytest.raises(InputError, match=r"\(rows, columns, 9\) expected"):
        Picture(picture.radiance[..., :3], bands=NINE)
