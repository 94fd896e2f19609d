"""Panes at an angle."""

import numpy as np
import pytest

from clerestory.bsdf.analytic import glass_properties
from clerestory.glazing.angular_dependence import coated, uncoated

COSINES = np.cos(np.radians([0, 15, 30, 45, 60, 75, 85, 89]))


@pytest.mark.parametrize("transmissivity", [1.0, 0.95, 0.6])
@pytest.mark.parametrize("index", [1.3, 1.52, 2.0])
def test_uncoated_glass_follows_fresnel(transmissivity, index):
    """From values at the normal alone, a slab of known index comes back."""
    t0, r0 = glass_properties(np.array(1.0), transmissivity=transmissivity, index=index)
    expected = glass_properties(COSINES, transmissivity=transmissivity, index=index)
    found = uncoated(COSINES, transmittance=t0, reflectance=r0)
    assert np.allclose(found, expected, atol=1e-9)


def test_an_opaque_pane_mirrors_as_one_face():
    """R of one face at 60°, index 1.5: 0.0892 (Fresnel)."""
    t, r = uncoated(
        np.array(0.5), transmittance=np.array(0.0), reflectance=np.array(0.04)
    )
    assert t == 0
    assert r == pytest.approx(0.0892, abs=1e-4)


def test_a_transparent_layer_remains_transparent():
    t, r = uncoated(COSINES, transmittance=np.array(1.0), reflectance=np.array(0.0))
    assert np.allclose(t, 1)
    assert np.allclose(r, 0)


@pytest.mark.parametrize("transmittance", [0.1, 0.5, 0.8])
def test_coated_glass_makes_no_light_and_mirrors_all_at_the_rim(transmittance):
    t, r = coated(
        np.append(COSINES, 0.0),
        transmittance=np.array(transmittance),
        reflectance=np.array(0.15),
    )
    assert np.all(t + r <= 1 + 1e-12)
    assert t[-1] == pytest.approx(0, abs=0.01)
    assert r[-1] == pytest.approx(1, abs=0.02)


def test_the_regressions_start_at_the_normal():
    """The published polynomials sum to 1 within their rounding."""
    for transmittance in (0.3, 0.9):
        t, r = coated(
            np.array(1.0),
            transmittance=np.array(transmittance),
            reflectance=np.array(0.05),
        )
        assert t == pytest.approx(transmittance, rel=0.02)
        assert r == pytest.approx(0.05, abs=0.02)
