"""α-opic quantities against CIE S 026:2018 and its toolbox."""

import numpy as np
import pytest

from clerestory.spectral.alpha_opic import (
    daylight_efficacy,
    daylight_efficacy_ratio,
    edi_weights,
    equivalent_daylight_illuminance,
)
from clerestory.spectral.band_sets import band_set, light_in_bands
from clerestory.spectral.functions import WAVELENGTH_NM, spectral_function


@pytest.mark.parametrize(
    ("quantity", "milliwatt"),
    [
        ("s_cone", 0.8173),
        ("m_cone", 1.4558),
        ("l_cone", 1.6289),
        ("rhodopic", 1.4497),
        ("melanopic", 1.3262),
    ],
)
def test_efficacies_of_daylight_are_those_of_the_standard(quantity, milliwatt):
    """CIE S 026:2018, table 4 [mW/lm]."""
    assert 1000 * daylight_efficacy(quantity) == pytest.approx(milliwatt, abs=5e-5)


def planck(kelvin):
    """Relative spectrum of a black body."""
    return WAVELENGTH_NM**-5 / np.expm1(1.438776877e7 / (WAVELENGTH_NM * kelvin))


@pytest.mark.parametrize("bands", ["20", "81", "melanopic+photopic"])
@pytest.mark.parametrize(
    ("power", "ratio"),
    [
        (spectral_function("d65"), 1.0),
        (np.ones(401), 0.9058),  # illuminant E
        (planck(2855.54), 0.4959),  # illuminant A
    ],
)
def test_daylight_efficacy_ratios_of_illuminants(power, ratio, bands):
    """Melanopic DER: 1 by definition; E and A as in the toolbox of CIE S 026."""
    given = band_set(bands)
    light = light_in_bands(power, given)
    found = daylight_efficacy_ratio(light, given)
    assert float(found) == pytest.approx(ratio, rel=2e-3)


def test_daylight_of_d65_has_equal_illuminances():
    """All five equivalent daylight illuminances equal the illuminance."""
    bands = band_set("81")
    light = light_in_bands(spectral_function("d65"), bands)[:, None] * [1.0, 2.0]
    lux = edi_weights(bands, "photopic") @ light
    for quantity in ("melanopic", "rhodopic", "s_cone", "m_cone", "l_cone"):
        found = equivalent_daylight_illuminance(light, bands, quantity)
        assert found == pytest.approx(lux, rel=1e-3)


def test_no_light_has_no_ratio():
    bands = band_set("20")
    assert np.isnan(daylight_efficacy_ratio(np.zeros((20, 1)), bands)).all()
    assert equivalent_daylight_illuminance(np.zeros(20), bands) == 0
