"""Shirley–Chiu map between the unit square and the unit disc.

The map preserves relative areas and adjacency. With the disc as the orthographic
projection of the hemisphere, cells of a square grid have equal projected solid angles.

Reference: P. Shirley, K. Chiu, "A low distortion map between disk and square", Journal
of Graphics Tools 2 (3), 1997, 45–52.
"""

import numpy as np
from jaxtyping import Float, Float32, Int32

from clerestory.array_types import Directions, Values

# Coefficients of x, x³, …, x¹⁷ in a polynomial approximation of arctan x
_ARC_TANGENT = (
    1.0,
    -0.3333314528,
    0.1999355085,
    -0.1420889944,
    0.1065626393,
    -0.0752896400,
    0.0429096138,
    -0.0161657367,
    0.0028662257,
)

# Distance to a cell boundary below which double precision is required, as a fraction of
# the side of the square.
_NEAR_BORDER = 2e-6

_TINY = np.float32(1e-30)


def square_from_disc(x: Values, y: Values) -> tuple[Values, Values]:
    """Points of the square [0, 1]² for points of the unit disc.

    Opposite points map to opposite points: (−x, −y) to (1 − a, 1 − b).

    >>> a, b = square_from_disc(np.array([0.0, 1.0]), np.array([0.0, 0.0]))
    >>> a.tolist(), b.tolist()
    ([0.5, 1.0], [0.5, 0.5])
    """
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)

    # The radius maps to the larger coordinate, the angle to the smaller
    steep = np.abs(y) > np.abs(x)
    far, near = np.where(steep, y, x), np.where(steep, x, y)
    edge = np.copysign(0.5 * np.sqrt(x * x + y * y), far)
    angle = np.arctan(near / np.where(far == 0, 1.0, far))
    along = edge * angle * (4 / np.pi)
    return 0.5 + np.where(steep, along, edge), 0.5 + np.where(steep, edge, along)


def cells_from_disc(
    x: Float[np.ndarray, " batch"], y: Float[np.ndarray, " batch"], *, halvings: int
) -> tuple[Int32[np.ndarray, " batch"], Int32[np.ndarray, " batch"]]:
    """Indices, 0 to 2^halvings − 1, of the grid cells that contain points of the disc.

    The cells are the same as by `square_from_disc`, although only points near cell
    boundaries are computed in double precision.

    >>> a, b = cells_from_disc(np.array([0.9]), np.array([0.1]), halvings=2)
    >>> a.tolist(), b.tolist()
    ([3], [2])
    """
    half = np.float32((1 << halvings) / 2)
    single_x, single_y = x.astype(np.float32), y.astype(np.float32)
    wide, tall = np.abs(single_x), np.abs(single_y)
    steep = tall > wide

    # The radius maps to the larger coordinate, the angle to the smaller
    edge = half * np.sqrt(single_x * single_x + single_y * single_y)
    slope = np.minimum(wide, tall) / np.maximum(np.maximum(wide, tall), _TINY)
    along = edge * _eighths(slope)
    both = along + edge
    np.copyto(edge, along, where=steep)
    a = half + np.copysign(edge, single_x)
    b = half + np.copysign(both - edge, single_y)

    # Recompute points near a boundary in double precision
    near = np.float32(_NEAR_BORDER * (1 << halvings))
    close = np.abs(a - np.rint(a)) < near
    close |= np.abs(b - np.rint(b)) < near
    cells = a.astype(np.int32), b.astype(np.int32)
    border = np.flatnonzero(close)
    exact = square_from_disc(x[border], y[border])
    for cell, coordinate in zip(cells, exact, strict=True):
        cell[border] = (coordinate * (1 << halvings)).astype(np.int32)
        np.clip(cell, 0, (1 << halvings) - 1, out=cell)
    return cells


def _eighths(slope: Float32[np.ndarray, " batch"]) -> Float32[np.ndarray, " batch"]:
    # Arc tangent of slopes from 0 to 1 in units of π/4, to 1e-7: Abramowitz and Stegun,
    # Handbook of Mathematical Functions, 1964, eq. 4.4.49
    square = slope * slope
    turn = np.full_like(square, _ARC_TANGENT[-1])
    for coefficient in _ARC_TANGENT[-2::-1]:
        turn *= square
        turn += np.float32(coefficient)
    turn *= slope
    turn *= np.float32(4 / np.pi)
    return np.asarray(turn)


def disc_from_square(a: Values, b: Values) -> tuple[Values, Values]:
    """Points of the unit disc for points of the square [0, 1]².

    >>> x, y = disc_from_square(np.array(0.5), np.array(1.0))
    >>> round(float(x), 12), round(float(y), 12)
    (0.0, 1.0)
    """
    a, b = 2 * np.asarray(a, dtype=float) - 1, 2 * np.asarray(b, dtype=float) - 1
    steep = np.abs(b) > np.abs(a)
    radius, along = np.where(steep, b, a), np.where(steep, a, b)
    angle = (np.pi / 4) * along / np.where(radius == 0, 1.0, radius)
    far, near = radius * np.cos(angle), radius * np.sin(angle)
    return np.where(steep, near, far), np.where(steep, far, near)


def directions_from_square(a: Values, b: Values) -> Directions:
    """Unit vectors with z > 0 for points of the square [0, 1]².

    >>> directions_from_square(np.array(0.5), np.array(0.5)).tolist()
    [0.0, 0.0, 1.0]
    """
    x, y = disc_from_square(a, b)
    return np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 1e-300))], axis=-1)


def cell_centres(halvings: int) -> tuple[Values, Values]:
    """Centres of 2^halvings × 2^halvings cells of the square, in row-major order."""
    middle = (np.arange(1 << halvings) + 0.5) / (1 << halvings)
    a, b = np.meshgrid(middle, middle, indexing="ij")
    return a.ravel(), b.ravel()
