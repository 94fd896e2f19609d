"""Fast look-ups of patches agree with the partition, direction by direction."""

import numpy as np
import pytest

from clerestory.hemisphere.klems import from_rings, klems
from clerestory.hemisphere.patch_lookup import find_patches
from clerestory.hemisphere.reinhart import reinhart

PARTITIONS = {
    **{basis: klems(basis) for basis in ("full", "half", "quarter")},
    "sky": reinhart(2).dome,
    "one patch": from_rings("all", limits_deg=np.array([0.0, 90]), count=np.array([1])),
    "halves": from_rings("two", limits_deg=np.array([0.0, 90]), count=np.array([2])),
}


def directions(count, seed=1):
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


@pytest.mark.parametrize("name", PARTITIONS)
def test_patches_of_many_directions_are_those_of_the_partition(name):
    """Directions everywhere, on the axes and diagonals, at the pole and at the rim."""
    partition = PARTITIONS[name]
    turn = np.radians(np.arange(0, 360, 0.5))
    rings = np.radians(np.linspace(0, 90, 181))[:, None]
    grid = [np.sin(rings) * np.cos(turn), np.sin(rings) * np.sin(turn)]
    grid = np.stack([*grid, np.broadcast_to(np.cos(rings), grid[0].shape)], axis=-1)
    v = np.concatenate([directions(200_000), grid.reshape(-1, 3)])
    up = np.column_stack([v[:, :2], np.maximum(np.abs(v[:, 2]), 1e-300)])
    np.testing.assert_array_equal(find_patches(partition, v), partition.find(up))


def test_vectors_that_are_not_unit_are_found_by_their_angle():
    full, v = klems("full"), directions(5000)
    np.testing.assert_array_equal(find_patches(full, 3 * v), find_patches(full, v))


def test_a_few_directions_are_found_as_many_are():
    full, v = klems("full"), directions(5000)
    few = np.concatenate(
        [find_patches(full, v[k : k + 50]) for k in range(0, 5000, 50)]
    )
    np.testing.assert_array_equal(few, find_patches(full, v))
