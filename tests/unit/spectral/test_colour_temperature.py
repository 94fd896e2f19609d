"""Colour temperatures and daylight spectra against colour-science 0.4.7 and CIE 15."""

import numpy as np
import pytest

from clerestory.bands import RGB
from clerestory.errors import InputError
from clerestory.spectral.band_sets import band_set, light_in_bands
from clerestory.spectral.colour_temperature import (
    colour_temperature,
    daylight_spectrum,
    tristimulus,
)
from clerestory.spectral.functions import WAVELENGTH_NM, integral, spectral_function


@pytest.mark.parametrize(
    ("xyz", "kelvin", "duv"),
    [
        ((1.09848, 1, 0.35587), 2855.7, 0.0000),  # A
        ((0.96421, 1, 0.82502), 5001.1, 0.0032),  # D50
        ((0.95042, 1, 1.08861), 6501.8, 0.0032),  # D65
        ((0.94965, 1, 1.22590), 7503.2, 0.0031),  # D75
        ((0.99999, 1, 0.99990), 5455.1, -0.0044),  # E
        ((0.99146, 1, 0.67315), 4225.1, 0.0019),  # FL2
        ((1.00862, 1, 0.67634), 4102.5, -0.0006),  # LED-B3
    ],
)
def test_colour_temperature_of_illuminants(xyz, kelvin, duv):
    """Within the accuracy of Ohno's method of 2013 in colour-science, .1 %."""
    found = colour_temperature(np.array(xyz, dtype=float))
    assert float(found.kelvin) == pytest.approx(kelvin, rel=1e-3)
    assert float(found.duv) == pytest.approx(duv, abs=6e-5)


def test_black_bodies_have_their_own_temperature():
    kelvin = np.array([1200.0, 2000.0, 3456.0, 6500.0, 20_000.0, 80_000.0])
    power = 1 / (
        WAVELENGTH_NM**5 * np.expm1(1.438776877e7 / WAVELENGTH_NM / kelvin[:, None])
    )
    xyz = np.stack([integral(power * spectral_function(name)) for name in "xyz"])
    found = colour_temperature(xyz)
    assert found.kelvin == pytest.approx(kelvin, rel=1e-4)
    assert found.duv == pytest.approx(np.zeros(6), abs=1e-6)


def test_colours_far_from_white_have_no_temperature():
    green, black = np.array([0.2, 1.0, 0.1]), np.zeros(3)
    for xyz in (green, black):
        assert np.isnan(colour_temperature(xyz).kelvin)


@pytest.mark.parametrize(
    ("kelvin", "values"),
    [
        (4000, (26.391, 63.388, 84.486, 108.271, 121.446)),
        (5000, (49.257, 87.198, 95.701, 97.706, 91.653)),
        (6504, (82.778, 117.027, 109.363, 90.002, 71.600)),
        (10_000, (138.722, 162.666, 129.897, 83.504, 57.423)),
        (25_000, (219.138, 225.157, 157.709, 78.936, 51.527)),
    ],
)
def test_spectra_of_daylight(kelvin, values):
    """Relative to 100 at 560 nm, as colour-science's series D (CIE 15:2018)."""
    spectrum = daylight_spectrum(float(kelvin))
    at = [int(np.searchsorted(WAVELENGTH_NM, nm)) for nm in (400, 450, 500, 600, 700)]
    found = 100 * spectrum[at] / spectrum[WAVELENGTH_NM == 560]
    assert found == pytest.approx(np.array(values), abs=2e-3)
    luminance = 683 * integral(spectrum * spectral_function("y"))
    assert luminance == pytest.approx(1.0)


@pytest.mark.parametrize(("count", "kelvin"), [("81", 5), ("20", 23)])
def test_colour_of_light_in_bands(count, kelvin):
    """D65 has its colour temperature within 5 K in bands of 5 nm, 23 K in 20 nm."""
    bands = band_set(count)
    light = light_in_bands(spectral_function("d65"), bands)
    found = colour_temperature(tristimulus(light, bands)).kelvin
    assert float(found) == pytest.approx(6504, abs=kelvin)


def test_impossible_requests_are_errors():
    with pytest.raises(InputError, match="4000"):
        daylight_spectrum(3000)
    with pytest.raises(InputError, match="wavelength intervals"):
        tristimulus(np.ones(3), RGB)
