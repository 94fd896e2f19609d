"""Colorimetry: bands between wavelengths."""

import numpy as np
import pytest

from clerestory.bands import GREY
from clerestory.colorimetry import OBSERVER, OBSERVER_NM, wavelength_bands
from clerestory.errors import InputError


def test_white_light_has_179_lumen_per_watt():
    """However finely the visible range is cut."""
    for count in (1, 9, 20, 80):
        bands = wavelength_bands(np.linspace(380, 780, count + 1))
        assert len(bands) == count
        assert bands.weights.sum() == pytest.approx(GREY.weights.sum())


def test_efficacies_are_integrals_of_the_photopic_sensitivity():
    """Trapezoids of the table; most efficacious is the band that holds 555 nm."""
    bands = wavelength_bands(OBSERVER_NM)
    table = OBSERVER[1]
    expected = (table[1:] + table[:-1]) / (table[1:] + table[:-1]).sum()
    assert bands.shares == pytest.approx(expected)
    assert bands.names[int(np.argmax(bands.weights))] == "550-560 nm"
    assert bands.limits_nm[0] == (380.0, 390.0)


def test_wavelengths_outside_the_visible_range_are_dark():
    bands = wavelength_bands((300, 380, 780, 2500))
    assert bands.weights == pytest.approx([0, 179, 0])


@pytest.mark.parametrize("limits", [(), (400,), (500, 400), (400, 400)])
def test_limits_increase(limits):
    with pytest.raises(InputError, match="increasing"):
        wavelength_bands(limits)
