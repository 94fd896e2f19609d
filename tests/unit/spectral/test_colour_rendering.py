"""Colour rendering of fluorescent lamps (CIE 15:2004) and of reference lights."""

import numpy as np
import pytest

from clerestory.bands import RGB
from clerestory.errors import InputError
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import WHITE, band_means, band_set, light_in_bands
from clerestory.spectral.colour_rendering import colour_rendering, rendering_weights
from clerestory.spectral.colour_temperature import black_body, daylight_spectrum

FINE = band_set("81")

# Relative power of illuminants FL2, FL4, FL7 and FL11 every 5 nm from 380 nm (CIE 15)
LAMPS = {
    "FL2": (
        64,
        """
1.18 1.48 1.84 2.15 3.44 15.69 3.85 3.74 4.19 4.62 5.06 34.98 11.81 6.27 6.63 6.93
7.19 7.4 7.54 7.62 7.65 7.62 7.62 7.45 7.28 7.15 7.05 7.04 7.16 7.47 8.04 8.88 10.01
24.88 16.64 14.59 16.16 17.56 18.62 21.47 22.79 19.29 18.66 17.73 16.54 15.21 13.8
12.36 10.95 9.65 8.4 7.32 6.31 5.43 4.68 4.02 3.45 2.96 2.55 2.19 1.89 1.64 1.53
1.27 1.1 0.99 0.88 0.76 0.68 0.61 0.56 0.54 0.51 0.47 0.47 0.43 0.46 0.47 0.4 0.33
0.27
""",
    ),
    "FL4": (
        51,
        """
0.57 0.7 0.87 0.98 2.01 13.75 1.95 1.59 1.76 1.93 2.1 30.28 8.03 2.55 2.7 2.82 2.91
2.99 3.04 3.08 3.09 3.09 3.14 3.06 3 2.98 3.01 3.14 3.41 3.9 4.69 5.81 7.32 22.59
15.11 13.88 16.33 18.68 20.64 24.28 26.26 23.28 22.94 22.14 20.91 19.43 17.74 16
14.42 12.56 10.93 9.52 8.18 7.01 6 5.11 4.36 3.69 3.13 2.64 2.24 1.91 1.7 1.39 1.18
1.03 0.88 0.74 0.64 0.54 0.49 0.46 0.42 0.37 0.37 0.33 0.35 0.36 0.31 0.26 0.19
""",
    ),
    "FL7": (
        90,
        """
2.56 3.18 3.84 4.53 6.15 19.37 7.37 7.05 7.71 8.41 9.15 44.14 17.52 11.35 12 12.58
13.08 13.45 13.71 13.88 13.95 13.93 13.82 13.64 13.43 13.25 13.08 12.93 12.78 12.6
12.44 12.33 12.26 29.52 17.05 12.44 12.58 12.72 12.83 15.46 16.75 12.83 12.67 12.45
12.19 11.89 11.6 11.35 11.12 10.95 10.76 10.42 10.11 10.04 10.02 10.11 9.87 8.65
7.27 6.44 5.83 5.41 5.04 4.57 4.12 3.77 3.46 3.08 2.73 2.47 2.25 2.06 1.9 1.75 1.62
1.54 1.45 1.32 1.17 0.99 0.81
""",
    ),
    "FL11": (
        83,
        """
0.91 0.63 0.46 0.37 1.29 12.68 1.59 1.79 2.46 3.33 4.49 33.94 12.13 6.95 7.19 7.12
6.72 6.13 5.46 4.79 5.66 14.29 14.96 8.97 4.72 2.33 1.47 1.1 0.89 0.83 1.18 4.9
39.59 72.84 32.61 7.52 2.83 1.96 1.67 4.43 11.28 14.76 12.73 9.74 7.33 9.72 55.27
42.58 13.18 13.16 12.26 5.11 2.07 2.34 3.58 3.01 2.48 2.14 1.54 1.33 1.46 1.94 2 1.2
1.35 4.1 5.58 2.51 0.57 0.27 0.23 0.21 0.24 0.24 0.2 0.24 0.32 0.26 0.16 0.12 0.09
""",
    ),
}


def indices(light):
    found = colour_rendering(rendering_weights(FINE) @ light)
    return float(found.general), float(found.red)


@pytest.mark.parametrize("name", LAMPS)
def test_lamps_have_the_published_index(name):
    """Ra of CIE 15:2004, table T.8, given in whole numbers."""
    published, text = LAMPS[name]
    lamp = Spectrum(np.arange(380.0, 785, 5), np.array(text.split(), dtype=float))
    assert indices(band_means(lamp, FINE))[0] == pytest.approx(published, abs=0.75)


@pytest.mark.parametrize("kelvin", [2700.0, 4000.0, 4900.0])
def test_black_bodies_are_their_own_reference(kelvin):
    power = black_body(np.array([kelvin]))[0]
    found = indices(light_in_bands(WHITE * power / power.max(), FINE))
    assert found == pytest.approx((100, 100), abs=0.15)


@pytest.mark.parametrize("kelvin", [5100.0, 6504.0, 12_000.0])
def test_daylight_is_its_own_reference(kelvin):
    found = indices(light_in_bands(daylight_spectrum(kelvin), FINE))
    assert found == pytest.approx((100, 100), abs=0.2)


def test_dark_and_saturated_light_have_no_index():
    assert np.isnan(indices(np.zeros(81))).all()
    assert np.isnan(indices(np.eye(81)[20])).all()


def test_bands_without_wavelengths_have_no_index():
    with pytest.raises(InputError, match="wavelength intervals"):
        rendering_weights(RGB)
