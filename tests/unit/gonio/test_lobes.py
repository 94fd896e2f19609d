"""Lobes against closed forms and quadrature."""

import numpy as np
import pytest
from scipy import integrate

from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.lobes import Lobes, norm


def hemisphere(count=400):
    """Directions in the middle of equal projected solid angles, and that angle."""
    ring = (np.arange(count) + 0.5) / count
    turn = 2 * np.pi * (np.arange(2 * count) + 0.5) / (2 * count)
    r, phi = np.meshgrid(np.sqrt(ring), turn, indexing="ij")
    points = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r**2)], axis=-1)
    return points.reshape(-1, 3), np.pi / r.size


@pytest.mark.parametrize("theta_deg", [0, 40, 80, 90])
@pytest.mark.parametrize("radius", [0.08, 0.3, 1.2])
def test_a_lobe_carries_its_flux_also_at_the_horizon(theta_deg, radius):
    centre = from_degrees(np.array([float(theta_deg)]), np.array([30.0]))
    centre[:, 2] = np.maximum(centre[:, 2], 0)
    lobe = Lobes(centre, np.array([radius]), np.array([0.4]))
    points, weight = hemisphere()
    assert lobe.evaluate(points).sum() * weight == pytest.approx(0.4, rel=5e-3)


@pytest.mark.parametrize("radius", [0.02, 0.1, 0.5, 1.5])
def test_norm_at_the_normal_is_the_integral_over_rings(radius):
    """About the normal the integrand depends on θ only."""
    truth, _ = integrate.quad(
        lambda t: (
            2 * np.pi * np.sin(t) * np.cos(t) * np.exp((np.cos(t) - 1) / radius**2)
        ),
        0,
        np.pi / 2,
        limit=400,
    )
    value = norm(np.array([1.0]), np.array([radius]))
    assert value[0] == pytest.approx(truth, rel=1e-3)


def test_half_maximum_is_where_a_lobe_has_half_its_peak():
    lobe = Lobes(np.array([[0, 0, 1.0]]), np.array([0.3]), np.array([1.0]))
    angle = float(lobe.half_maximum[0])
    there = np.array([[np.sin(angle), 0, np.cos(angle)]])
    assert lobe.evaluate(there)[0] == pytest.approx(lobe.peak[0] / 2, rel=1e-9)


def test_the_peak_of_two_lobes_that_overlap_lies_between_them():
    """Two equal lobes nearer than their radii make one peak half-way."""
    centre = from_degrees(np.array([30.0, 34.0]), np.zeros(2))
    lobes = Lobes(centre, np.full(2, 0.1), np.ones(2))
    middle = from_degrees(32.0, 0.0)
    assert angle_between(lobes.strongest(), middle) < np.radians(0.1)


def test_numbers_that_make_no_lobe_are_refused():
    up = np.array([[0, 0, 1.0]])
    for radius, flux in ((0.0, 1.0), (0.1, -1.0), (np.nan, 1.0)):
        with pytest.raises(InputError, match="lobe"):
            Lobes(up, np.array([radius]), np.array([flux]))
    with pytest.raises(InputError, match="equal numbers"):
        Lobes(up, np.ones(2), np.ones(1))
