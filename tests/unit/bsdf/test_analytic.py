"""Analytic layers against the formulas they stand for."""

import numpy as np
import pytest

from clerestory.bsdf.analytic import clear_air, glass_properties, lambertian, thin_pane
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems

BASES = ("full", "half", "quarter")


@pytest.mark.parametrize("basis", BASES)
def test_lambertian_transmits_the_same_share_from_everywhere(basis):
    layer = lambertian(0.37, klems(basis), reflectance=0.2)
    np.testing.assert_allclose(layer.direct_hemispherical(), 0.37, rtol=1e-12)
    np.testing.assert_allclose(layer.direct_hemispherical("reflection_back"), 0.2)


@pytest.mark.parametrize("basis", BASES)
def test_air_is_the_identity(basis):
    matrix = clear_air(klems(basis)).transmission_matrix()
    np.testing.assert_allclose(matrix.values[0], np.eye(len(klems(basis))), atol=1e-15)


def test_pane_at_normal_incidence_has_the_textbook_transmittance():
    """A lossless pane in air passes 2n/(n²+1) (Hecht, Optics, stacks of plates)."""
    for n in (1.3, 1.5, 1.9):
        t, r = glass_properties(np.array(1.0), transmissivity=1.0, index=n)
        assert float(t) == pytest.approx(2 * n / (n**2 + 1))
        assert float(t + r) == pytest.approx(1)


def test_stack_of_lossless_panes_has_the_textbook_transmittance():
    """Stokes: m plates at normal incidence pass (1-ρ)/(1+(2m-1)ρ)."""
    n = 1.52
    rho = ((n - 1) / (n + 1)) ** 2
    for m in (1, 2, 3):
        t, _ = glass_properties(np.array(1.0), transmissivity=1.0, index=n, panes=m)
        assert float(t) == pytest.approx((1 - rho) / (1 + (2 * m - 1) * rho))


def test_pane_passes_all_of_one_polarisation_at_brewsters_angle():
    """There p-light is not reflected, so at least half of the light gets through."""
    n = 1.52
    cosine = np.cos(np.arctan(n))
    t, _ = glass_properties(np.array(cosine), transmissivity=1.0, index=n)
    r_s = (cosine**2 - np.sin(np.arctan(n)) ** 2) ** 2
    expected = (1 + (1 - r_s) / (1 + r_s)) / 2
    assert float(t) == pytest.approx(expected)


def test_pane_without_index_is_a_grey_filter():
    """With n = 1 nothing is reflected and the passage grows as 1/cos θ (Bouguer)."""
    cosine = np.array([1.0, 0.5])
    t, r = glass_properties(cosine, transmissivity=0.8, index=1.0)
    np.testing.assert_allclose(t, [0.8, 0.8**2])
    np.testing.assert_allclose(r, 0, atol=1e-15)


def test_pane_conserves_energy_and_vanishes_at_grazing_angles():
    cosine = np.linspace(1e-6, 1, 500)
    t, r = glass_properties(cosine, transmissivity=0.9, index=1.52, panes=2)
    assert np.all(t + r <= 1 + 1e-12)
    assert np.all(np.diff(t) > -1e-12)
    assert t[0] < 1e-4
    assert r[0] > 1 - 1e-4


def test_pane_in_patches_keeps_direction_and_average():
    full = klems("full")
    pane = thin_pane(0.9, full)
    T = pane.transmission_matrix().values[0]
    assert np.count_nonzero(T) == 145
    normal, _ = glass_properties(np.array(1.0), transmissivity=0.9, index=1.52)
    assert T[0, 0] == pytest.approx(float(normal), rel=1e-3)
    assert np.all(np.diff(np.diag(T)[[0, 1, 9, 25, 45, 69, 93, 117, 133]]) < 0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda k: lambertian(0.7, k, reflectance=0.4),
            "plus reflectance is 1.1; a number",
        ),
        (lambda k: lambertian(-0.1, k), "reflectance is -0.1; 0 or more"),
        (lambda k: thin_pane(1.1, k), "transmissivity is 1.1"),
        (lambda k: thin_pane(0.9, k, index=0.9), "index is 0.9"),
        (lambda k: thin_pane(0.9, k, panes=0), "number of panes is 0"),
    ],
)
def test_impossible_layers_are_refused(call, message):
    with pytest.raises(InputError, match=message):
        call(klems("full"))
