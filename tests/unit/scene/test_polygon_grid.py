"""Grids above polygons: counts and places from the geometry of rectangles."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.scene.polygon_grid import inside, polygon_grid

SQUARE = np.array([[0.0, 0, 1], [4, 0, 1], [4, 4, 1], [0, 4, 1]])


def test_points_are_centred_and_at_the_height():
    points = polygon_grid([SQUARE], spacing=0.9, height=0.5)
    assert len(points) == 16
    assert np.allclose(points.mean(axis=0), [2, 2, 1.5])
    assert np.allclose(np.diff(np.unique(points[:, 0])), 0.9)


def test_a_hole_has_no_points():
    """A column of 1 m × 1 m in the middle, joined by a seam."""
    hole = np.array([[1.5, 1.5, 1], [1.5, 2.5, 1], [2.5, 2.5, 1], [2.5, 1.5, 1]])
    floor = np.concatenate([SQUARE, SQUARE[:1], hole, hole[:1]])
    points = polygon_grid([floor], spacing=1 / 3, height=0)
    assert len(points) == 12 * 12 - 4 * 4  # points on its outline are omitted as well
    middle = np.abs(points[:, :2] - 2).max(axis=1)
    assert middle.min() > 0.5


def test_points_follow_a_ramp():
    ramp = SQUARE + np.outer([0, 1, 1, 0], [0.0, 0, 2])
    points = polygon_grid([ramp], spacing=1, height=0.5)
    assert np.allclose(points[:, 2], 1.5 + points[:, 0] / 2)


def test_a_wall_has_no_points():
    wall = np.array([[0.0, 0, 0], [4, 0, 0], [4, 0, 3], [0, 0, 3]])
    assert polygon_grid([wall], spacing=1, height=0.5).shape == (0, 3)


def test_a_spacing_of_zero_is_refused():
    with pytest.raises(InputError, match="spacing is 0 m; a positive number expected"):
        polygon_grid([SQUARE], spacing=0.0, height=0.5)


def test_inside_agrees_with_the_area():
    """The share of random points in a triangle is its share of the square: half."""
    points = np.random.default_rng(1).random((20_000, 2))
    share = inside(points, np.array([[0.0, 0], [1, 0], [0, 1]])).mean()
    assert abs(share - 0.5) < 4 * 0.5 / np.sqrt(len(points))
