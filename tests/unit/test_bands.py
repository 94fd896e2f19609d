"""Spectral bands: checks, photometric sums, bands of products."""

import numpy as np
import pytest

from clerestory.bands import GREY, RGB, Bands, common_bands, unnamed_bands, weighted_sum
from clerestory.errors import InputError, MatrixError

NINE = unnamed_bands(9)


def test_rgb_has_the_weights_of_radiance():
    """47.4, 119.9 and 11.6 lm/W, 179 in all."""
    assert RGB.weights == pytest.approx([47.435, 119.93, 11.635])
    assert RGB.shares == pytest.approx([0.265, 0.670, 0.065])
    assert GREY.weights == pytest.approx([179.0])


@pytest.mark.parametrize("axis", [0, 1, 2, -1, -3])
@pytest.mark.parametrize("dtype", [float, np.float32])
def test_sums_along_any_axis(axis, dtype):
    """As NumPy's tensordot; the precision is that of the values."""
    values = np.moveaxis(np.random.default_rng(1).random((3, 4, 5)), 0, axis)
    found = RGB.photometric(values.astype(dtype), axis=axis)
    assert found.dtype == dtype
    expected = np.tensordot(RGB.weights, values, (0, axis))
    assert found == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("axis", [0, -1])
def test_one_channel_stands_for_all_bands(axis):
    shape = (1, 4) if axis == 0 else (4, 1)
    assert RGB.photometric(np.ones(shape), axis=axis) == pytest.approx(179.0)
    assert weighted_sum(np.ones(shape), np.full(9, 0.5), axis=axis).sum() == 18


def test_sums_of_nothing_are_empty():
    assert RGB.photometric(np.zeros((3, 0, 7)), axis=0).shape == (0, 7)


def test_unknown_efficacies_are_not_guessed():
    with pytest.raises(InputError, match="is unknown"):
        NINE.photometric(np.ones(9))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"names": ()}, "different names"),
        ({"names": ("a", "a")}, "different names"),
        ({"names": ("a", "b"), "efficacy": (1.0,)}, "1 efficacies for 2 bands"),
        ({"names": ("a",), "efficacy": (-1.0,)}, "numbers of 0 or more"),
        ({"names": ("a",), "efficacy": (0.0,)}, "not all zero"),
        ({"names": ("a",), "limits_nm": ((500.0, 400.0),)}, "from 500 to 400 nm"),
        ({"names": ("a", "b"), "limits_nm": ((400.0, 500.0),)}, "1 limits for 2 bands"),
    ],
)
def test_faulty_bands_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        Bands(**given)


def test_bands_of_products():
    """One channel fits any bands; several channels fit only their own."""
    assert common_bands([(RGB, 1), (NINE, 9), (GREY, 1)]) == NINE
    assert common_bands([(RGB, 1), (NINE, 1)]) == NINE
    with pytest.raises(MatrixError, match="red, green, blue"):
        common_bands([(NINE, 9), (RGB, 3)])
