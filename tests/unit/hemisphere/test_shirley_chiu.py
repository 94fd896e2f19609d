"""The square and the disc keep area, borders, centre and symmetry."""

import numpy as np
import pytest

from clerestory.hemisphere.shirley_chiu import (
    cells_from_disc,
    disc_from_square,
    square_from_disc,
)


def test_round_trip_from_the_square():
    a, b = np.random.default_rng(1).random((2, 10_000))
    np.testing.assert_allclose(
        square_from_disc(*disc_from_square(a, b)), (a, b), atol=1e-14
    )


def test_round_trip_from_the_disc():
    x, y = np.random.default_rng(2).uniform(-1, 1, (2, 10_000))
    inside = x * x + y * y < 1
    x, y = x[inside], y[inside]
    np.testing.assert_allclose(
        disc_from_square(*square_from_disc(x, y)), (x, y), atol=1e-14
    )


def test_area_is_kept_everywhere():
    """The Jacobian is π, the ratio of disc to square, away from the diagonals."""
    a, b = np.random.default_rng(3).random((2, 2000))
    off = np.abs(np.abs(a - 0.5) - np.abs(b - 0.5)) > 1e-3
    a, b, step = a[off], b[off], 1e-6
    da = np.subtract(disc_from_square(a + step, b), disc_from_square(a - step, b))
    db = np.subtract(disc_from_square(a, b + step), disc_from_square(a, b - step))
    area = (da[0] * db[1] - da[1] * db[0]) / (2 * step) ** 2
    np.testing.assert_allclose(area, np.pi, rtol=1e-6)


def test_opposite_directions_lie_opposite_in_the_square():
    x, y = np.random.default_rng(4).uniform(-0.7, 0.7, (2, 1000))
    a, b = square_from_disc(x, y)
    np.testing.assert_allclose(square_from_disc(-x, -y), (1 - a, 1 - b), atol=1e-14)


@pytest.mark.parametrize(
    ("disc", "square"),
    [
        ((0, 0), (0.5, 0.5)),
        ((1, 0), (1, 0.5)),
        ((-1, 0), (0, 0.5)),
        ((0, 1), (0.5, 1)),
        ((0, -1), (0.5, 0)),
        ((0.5**0.5, 0.5**0.5), (1, 1)),
        ((-(0.5**0.5), 0.5**0.5), (0, 1)),
        ((0.5**0.5, -(0.5**0.5)), (1, 0)),
        ((-(0.5**0.5), -(0.5**0.5)), (0, 0)),
    ],
)
def test_centre_axes_and_corners(disc, square):
    """Centre, axes and diagonals, as in the figure of the paper."""
    disc, square = np.array([disc, square], dtype=float)[..., None]
    np.testing.assert_allclose(square_from_disc(*disc), square, atol=1e-15)
    np.testing.assert_allclose(disc_from_square(*square), disc, atol=1e-15)


@pytest.mark.parametrize("halvings", [0, 1, 2, 5, 7, 11, 15])
def test_fast_cells_are_those_of_the_map_even_beside_their_borders(halvings):
    """Random points, points within 1e-9 of corners of cells, axes, diagonals, rim."""
    rng = np.random.default_rng(5)
    radius, turn = np.sqrt(rng.random(100_000)), rng.random(100_000) * 2 * np.pi
    x, y = radius * np.cos(turn), radius * np.sin(turn)
    corner = rng.integers(0, (1 << halvings) + 1, (2, 20_000)) / (1 << halvings)
    close = disc_from_square(*(corner + rng.uniform(-1e-9, 1e-9, corner.shape)))
    line = np.linspace(-1, 1, 2001)
    still = np.zeros_like(line)
    diagonal = line * 0.5**0.5
    x = np.concatenate([x, close[0], line, still, diagonal, diagonal])
    y = np.concatenate([y, close[1], still, line, diagonal, -diagonal])
    place = np.stack(square_from_disc(x, y)) * (1 << halvings)
    expected = np.clip(np.floor(place), 0, (1 << halvings) - 1)
    np.testing.assert_array_equal(cells_from_disc(x, y, halvings=halvings), expected)
