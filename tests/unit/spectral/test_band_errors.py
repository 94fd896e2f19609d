"""Error of bands against 1 nm, from integrals that the test computes itself."""

from itertools import pairwise

import numpy as np
import pytest

from clerestory.bands import RGB
from clerestory.spectra import Spectrum
from clerestory.spectral.band_errors import band_errors
from clerestory.spectral.band_sets import band_set
from clerestory.spectral.functions import WAVELENGTH_NM, spectral_function

RED = Spectrum(np.array([400.0, 580.0, 620.0, 700.0]), np.array([0.05, 0.06, 0.5, 0.6]))


def test_more_bands_have_smaller_errors():
    errors = [band_errors(band_set(name), [RED]) for name in ("3", "9", "20", "81")]
    for one, finer in pairwise(errors):
        assert finer.illuminance < one.illuminance
        assert finer.melanopic < one.melanopic
        assert finer.kelvin < one.kelvin


def test_the_error_of_one_band_is_that_of_its_weighted_mean():
    """Photopic mean of D65 once and twice, against the product at every nanometre."""
    weight = spectral_function("d65") * spectral_function("y")
    red = RED.at(WAVELENGTH_NM)
    mean = weight @ red / weight.sum()
    twice = (mean * mean) / (weight @ (red * red) / weight.sum())
    found = band_errors(band_set("photopic"), [RED])
    assert found.illuminance >= abs(twice - 1) - 2e-3
    assert found.melanopic is None
    assert found.kelvin is None
    assert "illuminance within" in str(found)


def test_bands_without_weights_of_light_have_no_errors():
    assert str(band_errors(band_set("melanopic+photopic"))).startswith("illuminance")
    with pytest.raises(Exception, match="wavelength"):
        band_errors(RGB)
