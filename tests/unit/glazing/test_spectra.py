"""Spectra, spectral averages, and the wavelengths that layers share."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.glazing.standard import en410, nfrc, standard, trapezoidal_band
from clerestory.spectra import Spectrum, common_wavelengths, interpolation_matrix


@pytest.mark.parametrize("average", [nfrc(), en410()])
def test_a_flat_spectrum_averages_to_itself(average):
    flat = Spectrum(np.array([200.0, 3000.0]), np.array([0.37, 0.37]))
    assert average.solar.average(flat) == pytest.approx(0.37, abs=1e-12)
    assert average.visible.average(flat) == pytest.approx(0.37, abs=1e-12)


def test_weights_of_known_wavelengths_give_the_same_average():
    rng = np.random.default_rng(5)
    known = np.sort(rng.uniform(250, 2600, 40))
    spectrum = Spectrum(known, rng.random(40))
    for band in (nfrc().solar, en410().visible):
        assert band.weights(known) @ spectrum.value == pytest.approx(
            band.average(spectrum), abs=1e-12
        )


def test_a_trapezoidal_average_of_a_ramp_is_its_middle():
    even = Spectrum(np.linspace(300, 2500, 23), np.ones(23))
    band = trapezoidal_band(even, low_nm=300, high_nm=2500)
    ramp = Spectrum(np.array([300.0, 2500.0]), np.array([0.0, 1.0]))
    assert band.average(ramp) == pytest.approx(0.5, abs=1e-12)


def test_green_light_counts_most_for_the_eye():
    """V(λ) peaks at 555 nm; D65 shifts the product very little."""
    band = nfrc().visible
    assert band.wavelength_nm[np.argmax(band.weight)] == pytest.approx(550, abs=10)


def test_half_of_the_sun_is_visible():
    """ASTM E891: roughly half of AM 1.5 direct lies below 780 nm."""
    band = nfrc().solar
    assert 0.45 < band.weight[band.wavelength_nm <= 780].sum() < 0.6


def test_interpolation_keeps_sums():
    shares = interpolation_matrix(np.array([1.0, 2.0, 4.0]), np.linspace(0, 5, 17))
    assert np.allclose(shares.sum(axis=1), 1)


def test_layers_that_share_no_wavelength_are_refused():
    with pytest.raises(InputError, match="overlapping ranges"):
        common_wavelengths([np.array([300.0, 400.0]), np.array([500.0, 600.0])])


def test_an_unknown_standard_is_refused():
    with pytest.raises(InputError, match="one of nfrc, en410"):
        standard("iso")
