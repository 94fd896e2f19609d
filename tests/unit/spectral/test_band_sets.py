"""Sets of spectral bands, and spectra in them."""

import numpy as np
import pytest

from clerestory.bands import GREY, RGB
from clerestory.errors import InputError
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import (
    WHITE,
    band_means,
    band_set,
    efficacy,
    light_in_bands,
    wavelength_bands,
)
from clerestory.spectral.functions import WAVELENGTH_NM, integral, spectral_function


def test_white_light_has_179_lumen_per_watt():
    """However finely the visible range is cut."""
    for count in (1, 9, 20, 80):
        bands = wavelength_bands(np.linspace(380, 780, count + 1))
        assert len(bands) == count
        assert bands.weights.sum() == pytest.approx(GREY.weights.sum())


def test_efficacies_are_integrals_of_the_photopic_sensitivity():
    """Trapezoids of the table; most efficacious is the band that holds 555 nm."""
    bands = wavelength_bands(np.arange(380, 790, 10))
    table = spectral_function("y").copy()
    steps = (table[1:] + table[:-1]).reshape(40, 10).sum(axis=1)
    assert bands.shares == pytest.approx(steps / steps.sum())
    assert bands.names[int(np.argmax(bands.weights))] == "550-560 nm"
    assert bands.limits_nm[0] == (380.0, 390.0)


def test_wavelengths_outside_the_visible_range_are_dark():
    bands = wavelength_bands((300, 380, 780, 2500))
    assert bands.weights == pytest.approx([0, 179, 0])


@pytest.mark.parametrize("limits", [(), (400,), (500, 400), (400, 400)])
def test_limits_increase(limits):
    with pytest.raises(InputError, match="increasing"):
        wavelength_bands(limits)


@pytest.mark.parametrize(
    ("name", "count", "first"),
    [
        ("rgb", 3, "red"),
        ("9", 9, "380-424.444 nm"),
        ("20", 20, "380-400 nm"),
        ("81", 81, "377.5-382.5 nm"),
        ("photopic", 1, "photopic"),
        ("melanopic + photopic", 2, "melanopic"),
    ],
)
def test_sets_of_bands_have_names(name, count, first):
    bands = band_set(name)
    assert (len(bands), bands.names[0]) == (count, first)


@pytest.mark.parametrize("name", ["", "1", "82", "green", "melanopic+", "photopic,9"])
def test_unknown_sets_are_errors_that_list_the_known_ones(name):
    with pytest.raises(InputError, match="2 to 81"):
        band_set(name)


def test_means_of_a_spectrum_are_integrals_over_the_interval():
    """Of a parabola through three points: trapezoids, constant beyond both ends."""
    paint = Spectrum(np.array([450.0, 500.0, 600.0]), np.array([0.2, 0.6, 0.4]))
    bands = wavelength_bands([400, 450, 480, 550, 700])
    expected = [0.2, (0.2 + 0.44) / 2, (20 * 0.52 + 50 * 0.55) / 70]
    expected.append((50 * 0.45 + 100 * 0.4) / 150)
    assert band_means(paint, bands) == pytest.approx(expected)


def test_means_by_weighting_functions_are_exact_in_daylight():
    """∫ρ s D65 over ∫ s D65, of a filter that passes light above 500 nm only."""
    step = Spectrum(np.array([499.5, 500.5]), np.array([0.0, 1.0]))
    found = band_means(step, band_set("melanopic+photopic"))
    for value, name in zip(found, ("melanopic", "y"), strict=True):
        weight = spectral_function(name) * spectral_function("d65")
        passed = (WAVELENGTH_NM > 500) + 0.5 * (WAVELENGTH_NM == 500)
        expected = (weight * passed).sum() / weight.sum()
        assert value == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    ("name", "error"), [("81", 2e-4), ("20", 2.5e-3), ("melanopic+photopic", 1e-9)]
)
def test_light_keeps_its_melanopic_and_photopic_power(name, error):
    """Σ K_b L_b = ∫ L s dλ: exact with weighting functions, .25 % with 20 bands."""
    bands, power = band_set(name), spectral_function("d65")
    light = light_in_bands(power, bands)
    for quantity, table in (("melanopic", "melanopic"), ("photopic", "y")):
        expected = integral(power * spectral_function(table))
        found = efficacy(bands, quantity) @ light
        assert found == pytest.approx(expected, rel=error)
    assert light_in_bands(np.full(401, WHITE), bands) == pytest.approx(1.0)


def test_bands_without_wavelengths_have_no_spectra():
    flat = Spectrum(np.array([400.0, 700.0]), np.array([0.5, 0.5]))
    with pytest.raises(InputError, match="wavelength intervals"):
        band_means(flat, RGB)
    with pytest.raises(InputError, match="do not give rhodopic"):
        efficacy(band_set("melanopic+photopic"), "rhodopic")
    with pytest.raises(InputError, match="quantity"):
        efficacy(band_set("20"), "scotopic")
