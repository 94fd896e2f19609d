"""Equal-area map between the unit square and the sphere, and its quadtree of cells.

The upper hemisphere is the diamond in the middle of the square, the lower hemisphere is
folded out into its corners. A cell of level n has the side 2⁻ⁿ and the solid angle
4π/4ⁿ; no cell is wider than 2.5 times the square root of its solid angle. Cells at the
border of the square are adjacent to others at the border, mirrored at its centre line.

Reference: Clarberg, P. (2008): Fast equal-area mapping of the (hemi)sphere using SIMD.
Journal of Graphics Tools 13(3).
"""

import numpy as np
from jaxtyping import Int

from clerestory.array_types import Directions, Indices, Points2


def sphere_from_square(point: Points2) -> Directions:
    """Unit vectors for points of the square [0, 1]².

    >>> sphere_from_square(np.array([[0.5, 0.5], [1.0, 0.5]])).round(12).tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    """
    u, v = np.moveaxis(2 * np.asarray(point, dtype=float) - 1, -1, 0)
    wide, tall = np.abs(u), np.abs(v)
    height = 1 - (wide + tall)
    radius = 1 - np.abs(height)
    turn = np.divide(tall - wide, radius, out=np.zeros_like(radius), where=radius > 0)
    phi = (turn + 1) * (np.pi / 4)
    flat = radius * np.sqrt(2 - radius * radius)
    x, y = np.copysign(flat * np.cos(phi), u), np.copysign(flat * np.sin(phi), v)
    return np.stack([x, y, np.copysign(1 - radius * radius, height)], axis=-1)


def square_from_sphere(direction: Directions) -> Points2:
    """Points of the square [0, 1]² for unit vectors.

    >>> square_from_sphere(np.array([0.0, 1.0, 0.0])).tolist()
    [0.5, 1.0]
    """
    x, y, z = np.moveaxis(np.asarray(direction, dtype=float), -1, 0)
    radius = np.sqrt(np.maximum(1 - np.abs(z), 0))
    v = radius * np.arctan2(np.abs(y), np.abs(x)) * (2 / np.pi)
    u = radius - v
    u, v = np.where(z < 0, 1 - v, u), np.where(z < 0, 1 - u, v)
    return np.stack([np.copysign(u, x) + 1, np.copysign(v, y) + 1], axis=-1) / 2


def cell_at(point: Points2, level: int) -> Indices:
    """Row-major index of the cell of a level that contains each point of the square."""
    side = 1 << level
    place = np.clip((np.asarray(point) * side).astype(np.int64), 0, side - 1)
    return np.asarray(place[..., 0] * side + place[..., 1])


def adjacent_pairs(owner: Int[np.ndarray, "side side"]) -> Int[np.ndarray, "pairs 2"]:
    """Pairs of different owners that share an edge, each in both orders and sorted.

    `owner` is the number of the owner of each cell of one level.

    >>> pairs = adjacent_pairs(np.array([[0, 0], [1, 2]]))
    >>> pairs.tolist()
    [[0, 1], [0, 2], [1, 0], [1, 2], [2, 0], [2, 1]]
    """
    count = int(owner.max()) + 1
    found = []
    for cells in (owner, owner.T):
        rim = cells[[0, -1]]
        for one, other in ((cells[:-1], cells[1:]), (rim, rim[:, ::-1])):
            differs = one != other
            a, b = one[differs], other[differs]
            found += [a * count + b, b * count + a]
    return np.stack(np.divmod(np.unique(np.concatenate(found)), count), axis=-1)
