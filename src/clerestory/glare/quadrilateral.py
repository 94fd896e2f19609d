"""Solid angles of pixels as spherical quadrilaterals through their corners.

`scene.view.solid_angles` is exact for all projections. Here great circles join the
corners, and a pixel with a corner outside of the projection has none: so counts
evalglare, and the order of operations is its own, since a source joins another only
if the other is larger, be it by the last bit.
"""

import numpy as np
from jaxtyping import Float

from clerestory.glare.rays import PixelRays, directions
from clerestory.scene.projection import TINY
from clerestory.scene.view import View

# Rows worked on at a time
_BLOCK = 16

_Vectors = tuple[np.ndarray, np.ndarray, np.ndarray]


def quadrilaterals(
    view: View, columns: int, rows: int
) -> Float[np.ndarray, "row column"]:
    """Return the solid angles of the pixels of a picture [sr].

    >>> view = View(kind="angular", horizontal=180, vertical=180)
    >>> float(quadrilaterals(view, 100, 100)[50, 50].round(8))
    0.00098696
    """
    left, right = _sides(columns)
    under, over = _sides(rows)
    # evalglare mirrors the picture here, which only rounding tells in a level view
    mirrored = view.lift == 0
    low, high = (under, over) if mirrored else (under[::-1], over[::-1])
    x, columns_of = np.unique(np.concatenate([left, right]), return_inverse=True)
    y, rows_of = np.unique(np.concatenate([low, high]), return_inverse=True)
    grid = directions(view, x, y)
    rows_of, columns_of = rows_of.reshape(2, rows), columns_of.reshape(2, columns)

    result = np.empty((rows, columns))
    for start in range(0, rows, _BLOCK):
        some = slice(start, start + _BLOCK)
        result[some] = _angles(grid, rows_of[:, some], columns_of)
    return result


def _angles(grid: PixelRays, rows_of: np.ndarray, columns_of: np.ndarray) -> np.ndarray:
    # Of the pixels of some rows; a few rows at a time stay in the processor's cache
    places = ((0, 0), (1, 0), (1, 1), (0, 1))
    corners, whole = [], np.ones((rows_of.shape[1], columns_of.shape[1]), dtype=bool)
    lines = [(grid.direction[at], grid.covered[at]) for at in rows_of]
    for row, column in places:
        at = columns_of[column]
        x, y, z = np.ascontiguousarray(lines[row][0][:, at].transpose(2, 0, 1))
        corners.append((x, y, z))
        whole &= lines[row][1][:, at]
    sides = [_plane(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    turns = [
        np.arccos(np.clip(_dot(sides[i], sides[(i + 1) % 4]), -1, 1)) for i in range(4)
    ]
    angle = ((4 * np.pi - (turns[1] + turns[0])) - (turns[3] + turns[2])) - 2 * np.pi
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
