"""Solid angles of pixels as spherical quadrilaterals through their corners.

`scene.view.solid_angles` is exact for all projections. Here great circles join the
corners, and a pixel with a corner outside of the projection has none: so counts
evalglare, and the order of operations is its own, since a source joins another only
if the other is larger, be it by the last bit.
"""

import numpy as np
from jaxtyping import Float

from clerestory.glare.rays import directions
from clerestory.scene.projection import TINY
from clerestory.scene.view import View

_Vectors = tuple[np.ndarray, np.ndarray, np.ndarray]


def quadrilaterals(
    view: View, columns: int, rows: int
) -> Float[np.ndarray, "row column"]:
    """Return the solid angles of the pixels of a picture [sr].

    >>> view = View(kind="angular", horizontal=180, vertical=180)
    >>> float(quadrilaterals(view, 100, 100)[50, 50].round(8))
    0.00098679
    """
    left, right = _sides(columns)
    under, over = _sides(rows)
    # evalglare mirrors the picture here, which only rounding tells in a level view
    mirrored = view.lift == 0
    low, high = (under, over) if mirrored else (under[::-1], over[::-1])
    x, columns_of = np.unique(np.concatenate([left, right]), return_inverse=True)
    y, rows_of = np.unique(np.concatenate([low, high]), return_inverse=True)
    grid = directions(view, x, y)

    def corner(row: int, column: int) -> tuple[_Vectors, np.ndarray]:
        at = np.ix_(
            rows_of.reshape(2, rows)[row], columns_of.reshape(2, columns)[column]
        )
        x, y, z = (grid.direction[..., axis][at] for axis in range(3))
        return (x, y, z), grid.covered[at]

    places = ((0, 0), (1, 0), (1, 1), (0, 1))
    corners, covered = zip(*(corner(*place) for place in places), strict=True)
    sides = [_plane(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    turns = [
        np.arccos(np.clip(_dot(sides[i], sides[(i + 1) % 4]), -1, 1)) for i in range(4)
    ]
    angle = ((4 * np.pi - (turns[1] + turns[0])) - (turns[3] + turns[2])) - 2 * np.pi
    whole = covered[0] & covered[1] & covered[2] & covered[3]
    return np.where(whole & (angle > 0), angle, 0)


def _sides(count: int) -> tuple[np.ndarray, np.ndarray]:
    # Where each pixel begins and ends, 0 to 1 over the picture
    half = 0.5 / count
    begin = (np.arange(count) + 0.5) / count - half
    return begin, begin + 2 * half


def _plane(a: _Vectors, b: _Vectors) -> _Vectors:
    # Unit normal of the great circle through two corners
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    normal = a[1] * z - a[2] * y, a[2] * x - a[0] * z, a[0] * y - a[1] * x
    square = normal[0] * normal[0] + (normal[2] * normal[2] + normal[1] * normal[1])
    with np.errstate(divide="ignore"):
        scale = np.where(
            np.abs(square - 1) <= TINY, 2 - (0.5 + 0.5 * square), 1 / np.sqrt(square)
        )
    scale[square == 0] = 0
    return normal[0] * scale, normal[1] * scale, normal[2] * scale


def _dot(a: _Vectors, b: _Vectors) -> np.ndarray:
    total: np.ndarray = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
    return total
