"""The equal-area square map of the sphere, by geometry."""

import numpy as np
import pytest

from clerestory.hemisphere.sphere_square import (
    adjacent_pairs,
    sphere_from_square,
    square_from_sphere,
)


def points(count=5000):
    return np.random.default_rng(3).random((count, 2))


def test_map_has_unit_vectors_and_an_inverse():
    direction = sphere_from_square(points())
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(square_from_sphere(direction), points(), atol=1e-7)


def test_area_on_the_sphere_is_4_pi_times_that_in_the_square():
    """The Jacobian by differences; points near the folds of the map are left out."""
    middle, step = points(), 1e-6
    folds = np.stack([*(2 * middle.T - 1), np.abs(2 * middle - 1).sum(1) - 1])
    middle = middle[np.abs(folds).min(axis=0) > 1e-4]
    sides = [
        (sphere_from_square(middle + one) - sphere_from_square(middle - one)) / 2 / step
        for one in np.eye(2) * step
    ]
    area = np.linalg.norm(np.cross(*sides), axis=1)
    np.testing.assert_allclose(area, 4 * np.pi, rtol=1e-5)


def test_special_points():
    corners = np.array([[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [0.0, 0.5]])
    np.testing.assert_allclose(
        sphere_from_square(corners),
        [[0, 0, 1], [0, 0, -1], [0, 0, -1], [0, 1, 0], [-1, 0, 0]],
        atol=1e-12,
    )


@pytest.mark.parametrize("level", [2, 3, 5])
def test_adjacent_cells_share_an_edge_on_the_sphere(level):
    """Two points just beyond the middle of each edge are in the cell and its pair."""
    side = 1 << level
    owner = np.arange(side * side).reshape(side, side)
    found = {tuple(pair) for pair in adjacent_pairs(owner).tolist()}
    row, column = np.divmod(np.arange(side * side), side)
    expected = set()
    for offset in np.array([[0, 0.5], [1, 0.5], [0.5, 0], [0.5, 1]]):
        edge = (np.stack([row, column], 1) + offset) / side
        inner = (np.stack([row, column], 1) + 0.5 + 0.98 * (offset - 0.5)) / side
        on, at = sphere_from_square(edge), sphere_from_square(inner)
        beyond = 2 * on - at
        beyond /= np.linalg.norm(beyond, axis=1, keepdims=True)
        other = np.minimum((square_from_sphere(beyond) * side).astype(int), side - 1)
        expected |= set(zip(owner.ravel(), owner[tuple(other.T)], strict=True))
    assert found == {(int(a), int(b)) for a, b in expected if a != b}
