"""Interpolation weights between patches."""

import numpy as np
import pytest

from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.patch_interpolation import patch_weights
from clerestory.hemisphere.reinhart import reinhart
from energy_models import PANE
from slat_walk import pane_pair

PARTITIONS = {
    "full": klems("full"),
    "quarter": klems("quarter"),
    "sky": reinhart(2).dome,
}


def directions(count=500):
    rng = np.random.default_rng(4)
    vectors = rng.normal(size=(count, 3))
    vectors[:, 2] = np.abs(vectors[:, 2])
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@pytest.mark.parametrize("name", PARTITIONS)
def test_weights_sum_to_one_and_are_one_at_centres(name):
    """Beyond the outermost centres, their sum decreases to zero at 90°."""
    partition, found = PARTITIONS[name], directions()
    weights = patch_weights(partition, found)
    assert weights.min() >= 0
    outermost = np.arccos(partition.centres()[:, 2].min())
    left = (np.pi / 2 - np.arccos(found[:, 2])) / (np.pi / 2 - outermost)
    assert left.min() < 0.5
    np.testing.assert_allclose(weights.sum(axis=0), np.minimum(left, 1), atol=1e-12)
    centres = patch_weights(partition, partition.centres())
    np.testing.assert_allclose(centres, np.eye(len(partition)), atol=1e-9)


@pytest.mark.parametrize("name", PARTITIONS)
def test_functions_linear_in_polar_angle_are_exact(name):
    partition, found = PARTITIONS[name], directions()
    angles = np.arccos(np.clip(partition.centres()[:, 2], -1, 1))
    theta = np.arccos(found[:, 2])
    inside = theta <= angles.max()
    values = angles @ patch_weights(partition, found)
    np.testing.assert_allclose(values[inside], theta[inside], atol=1e-9)


@pytest.mark.parametrize(("name", "most"), [("full", 0.03), ("quarter", 0.06)])
def test_transmittance_of_glass_is_that_of_fresnel_up_to_grazing_incidence(name, most):
    """Two clear panes, with rings 10° and 18° wide."""
    partition, pair = PARTITIONS[name], pane_pair(PANE.material)
    known = pair(partition.centres()[:, 2])[0]
    angles = np.radians(np.linspace(0, 89.9, 1000))
    found = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=1)
    expected = pair(np.cos(angles))[0]
    ours = known @ patch_weights(partition, found)
    np.testing.assert_allclose(ours, expected, rtol=0, atol=most)


def test_azimuth_is_interpolated_across_its_origin():
    """Between the last and the first patch of a ring, half of each."""
    basis = klems("full")
    theta, phi = np.radians(20), -np.pi / basis.count[2]
    between = np.array(
        [[np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]]
    )
    weights = patch_weights(basis, between)[:, 0]
    first = basis.first[2]
    last = first + basis.count[2] - 1
    assert weights[[first, last]].tolist() == pytest.approx([0.5, 0.5])
