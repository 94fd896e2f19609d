"""Neighbours in rings against a search tree over all patches."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from clerestory.directions import from_azimuth
from clerestory.hemisphere.reinhart import reinhart
from clerestory.sky.solar_radiance import nearest_patches


@pytest.mark.parametrize("subdivision", [1, 2, 3, 4, 5, 6])
@pytest.mark.parametrize("count", [1, 4])
def test_the_nearest_patches_are_those_of_a_search_tree(subdivision, count):
    """Anywhere, below the horizon, around the zenith and on the seam in the north."""
    random = np.random.default_rng(subdivision)
    azimuth = random.uniform(-np.pi, 3 * np.pi, 20_000)
    azimuth[:3000] = random.normal(0, 1e-2, 3000)
    altitude = random.uniform(np.radians(-10), np.pi / 2, 20_000)
    altitude[2000:6000] = np.pi / 2 - np.abs(random.normal(0, 0.1, 4000))
    directions = from_azimuth(azimuth, altitude)
    dome = reinhart(subdivision).dome
    found = nearest_patches(dome, directions, count=count)
    distance, patch = cKDTree(dome.centres()).query(
        directions, k=np.arange(1, count + 1)
    )
    np.testing.assert_allclose(found.distance, distance, rtol=1e-12, atol=1e-15)

    # Where two are as near to rounding, either will do
    other = found.patch != patch
    gap = np.abs(np.diff(distance, axis=1, append=np.inf))
    near = np.minimum(gap, np.roll(gap, 1, axis=1)) < 1e-12
    assert not np.any(other[:, : count - 1] & ~near[:, : count - 1])
    assert np.mean(other) < 1e-4


def test_no_directions_have_no_neighbours():
    found = nearest_patches(reinhart(2).dome, np.zeros((0, 3)), count=4)
    assert found.patch.shape == (0, 4)
