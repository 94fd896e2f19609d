"""Solid angles of pixels as spherical quadrilaterals, as in evalglare.

Pixel corners are joined by great circles, and a pixel with a corner outside of the
projection has zero solid angle; exact solid angles are in `scene.view.solid_angles`.
The order of operations is that of evalglare, since sources are merged by exact
comparison of solid angles.
"""

import numpy as np
from jaxtyping import Float

from clerestory.glare.pixel_rays import PixelRays, directions
from clerestory.scene.projection import TINY
from clerestory.scene.view import View

_Vectors = tuple[np.ndarray, np.ndarray, np.ndarray]


def quadrilaterals(
    view: View, columns: int, rows: int, some: slice | None = None
) -> Float[np.ndarray, "row column"]:
    """Return the solid angles of the pixels of a picture [sr].

    >>> view = View(kind="angular", horizontal=180, vertical=180)
    >>> float(quadrilaterals(view, 100, 100)[50, 50].round(8))
    0.00098696
    """
    left, right = _sides(columns)
    under, over = _sides(rows)
    # evalglare mirrors the picture vertically, which affects rounding only
    mirrored = view.lift == 0
    low, high = (under, over) if mirrored else (under[::-1], over[::-1])
    if some is not None:
        low, high = low[some], high[some]
    x, columns_of = np.unique(np.concatenate([left, right]), return_inverse=True)
    y, rows_of = np.unique(np.concatenate([low, high]), return_inverse=True)
    grid = directions(view, x, y)
    return _angles(grid, rows_of.reshape(2, -1), columns_of.reshape(2, -1))


def _angles(grid: PixelRays, rows_of: np.ndarray, columns_of: np.ndarray) -> np.ndarray:
    corners, whole = [], np.ones((rows_of.shape[1], columns_of.shape[1]), dtype=bool)
    planes = np.ascontiguousarray(np.moveaxis(grid.direction, -1, 0))
    for row, column in ((0, 0), (1, 0), (1, 1), (0, 1)):
        x, y, z = planes[:, rows_of[row]].take(columns_of[column], axis=2)
        corners.append((x, y, z))
        whole &= grid.covered[rows_of[row]].take(columns_of[column], axis=1)
    sides = [_plane(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    turns = [
        np.arccos(np.clip(_dot(sides[i], sides[(i + 1) % 4]), -1, 1)) for i in range(4)
    ]
    angle = ((4 * np.pi - (turns[1] + turns[0])) - (turns[3] + turns[2])) - 2 * np.pi
    return np.where(whole & (angle > 0), angle, 0)


def _sides(count: int) -> tuple[np.ndarray, np.ndarray]:
    # Lower and upper edge of each pixel, 0 to 1 over the picture
    half = 0.5 / count
    begin = (np.arange(count) + 0.5) / count - half
    return begin, begin + 2 * half


def _plane(a: _Vectors, b: _Vectors) -> _Vectors:
    # Unit normal of the great circle through two corners
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    normal = a[1] * z - a[2] * y, a[2] * x - a[0] * z, a[0] * y - a[1] * x
    square = normal[0] * normal[0] + (normal[2] * normal[2] + normal[1] * normal[1])
    with np.errstate(divide="ignore"):
        scale = 1 / np.sqrt(square)

    # First-order expansion for lengths close to one; zero for coincident corners
    near = np.abs(square - 1) <= TINY
    if near.any():
        scale[near] = 2 - (0.5 + 0.5 * square[near])
    if not square.all():
        scale[square == 0] = 0
    return normal[0] * scale, normal[1] * scale, normal[2] * scale


def _dot(a: _Vectors, b: _Vectors) -> np.ndarray:
    return np.asarray((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2])
