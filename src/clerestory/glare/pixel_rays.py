"""Directions and solid angles of pixels, with the rounding of Radiance and evalglare.

`View.rays` gives the same directions with different rounding. Rounding matters because
evalglare does not search the row of a pixel whose direction has a squared length above
one, and merges sources by exact comparison of solid angles. The formulas are those of
Radiance's image.c, in the order of operations of the compiled programs.

Pixel corners are joined by great circles, and a pixel with a corner outside of the
projection has zero solid angle; exact solid angles are in `scene.view.solid_angles`.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Image, ImageMask
from clerestory.scene.projection import TINY, Kind
from clerestory.scene.view import View

_Vectors = tuple[np.ndarray, np.ndarray, np.ndarray]


class PixelRays(NamedTuple):
    """Unit vectors towards points of a picture; zero outside of the projection.

    `covered` tells whether points are within the projection; `up` is the vertical
    coordinate, positive above the line of sight.
    """

    direction: Float[np.ndarray, "row column 3"]
    covered: ImageMask
    up: Image


def pixel_rays(
    view: View, columns: int, rows: int, some: slice | None = None
) -> PixelRays:
    """Return the directions of the pixel centres in some rows, or in all."""
    x = (np.arange(columns) + 0.5) / columns
    y = (np.arange(rows)[::-1] + 0.5) / rows
    return directions(view, x, y if some is None else y[some])


def directions(
    view: View, x: Float[np.ndarray, " column"], y: Float[np.ndarray, " row"]
) -> PixelRays:
    """Return directions of a grid of points; x and y are 0 to 1 over the picture."""
    across, high = np.meshgrid(x - 0.5 + view.shift, y - 0.5 + view.lift)
    right, up = _screen(view)
    size = view.horizontal, view.vertical
    forward, across, high, covered = _plane(view.kind, across, high, *size)
    direction = np.empty((y.size, x.size, 3))
    for axis in range(3):
        ahead = forward * view.direction[axis]
        aside, above = across * right[axis], high * up[axis]
        if view.kind == "cylindrical":
            direction[..., axis] = (ahead + aside) + above
        else:
            direction[..., axis] = (aside + above) + ahead
    if view.kind in ("perspective", "cylindrical"):
        direction *= _inverse_length(_square(direction))[..., None]
    direction[~covered] = 0
    return PixelRays(direction, covered, high)


def _square(direction: np.ndarray) -> np.ndarray:
    x, y, z = np.moveaxis(direction, -1, 0)
    return np.asarray(x * x + (z * z + y * y))


def _inverse_length(square: np.ndarray) -> np.ndarray:
    # First-order expansion of 1/length for lengths close to one
    near = np.abs(square - 1) <= TINY
    return np.where(near, 2 - (0.5 + 0.5 * square), 1 / np.sqrt(square))


def _screen(view: View) -> tuple[np.ndarray, np.ndarray]:
    # Vectors along the width and the height of the picture
    right = np.cross(view.direction, view.up)
    right = right * _inverse_length(_square(right))
    up = np.cross(right, view.direction)
    width, height = _sizes(view.kind, view.horizontal, view.vertical)
    return right * width, up * height


def _sizes(kind: Kind, horizontal: float, vertical: float) -> tuple[float, float]:
    across, high = horizontal * (math.pi / 360), vertical * (math.pi / 360)
    if kind == "perspective":
        return 2 * math.tan(across), 2 * math.tan(high)
    if kind == "hemispherical":
        return 2 * _sine(across), 2 * _sine(high)
    if kind == "cylindrical":
        return 1.0, 2 * math.tan(high)
    return 1.0, 1.0


def _sine(angle: float) -> float:
    # For 90°, the vectorised sine of the Radiance programs is one bit below 1
    return min(math.sin(angle), math.nextafter(1.0, 0.0))


def _plane(
    kind: Kind, x: np.ndarray, y: np.ndarray, horizontal: float, vertical: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    # Forward, right and up components of the direction at each point, and whether the
    # point is within the projection
    everywhere = np.ones(x.shape, dtype=bool)
    if kind == "hemispherical":
        width, height = _sizes(kind, horizontal, vertical)
        rest = 1 - (x * x * (width * width) + y * y * (height * height))
        return np.sqrt(np.maximum(rest, 0)), x, y, rest >= 0
    if kind == "angular":
        x, y = x * (1 / 180 * horizontal), y * (1 / 180 * vertical)
        square = x * x + y * y
        away = np.sqrt(square)
        z = np.cos(np.pi * away)
        with np.errstate(invalid="ignore", divide="ignore"):
            scale = np.where(away <= TINY, np.pi, np.sqrt(1 - z * z) / away)
        return z, x * scale, y * scale, square <= 1
    if kind == "planisphere":
        x, y = x * _planisphere_size(horizontal), y * _planisphere_size(vertical)
        square = x * x + y * y
        z = (1 - square) / (1 + square)
        return z, x * (1 + z), y * (1 + z), everywhere
    if kind == "cylindrical":
        turn = x * (horizontal * (np.pi / 180))
        return np.cos(turn), np.sin(turn), y, everywhere
    return np.ones(x.shape), x, y, everywhere


def _planisphere_size(angle: float) -> float:
    half = angle * (math.pi / 360)
    return 2 * math.sin(half) / (1 + math.cos(half))


def quadrilaterals(
    view: View, columns: int, rows: int, some: slice | None = None
) -> Image:
    """Return the solid angles of the pixels of a picture [sr]."""
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
    sides = [_great_circle(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    turns = [
        np.arccos(np.clip(_dot(sides[i], sides[(i + 1) % 4]), -1, 1)) for i in range(4)
    ]
    angle = ((4 * np.pi - (turns[1] + turns[0])) - (turns[3] + turns[2])) - 2 * np.pi
    return np.where(whole & (angle > 0), angle, 0)


def _sides(count: int) -> tuple[np.ndarray, np.ndarray]:
    # Lower and upper edge of each pixel along one axis, from 0 to 1 over the picture
    half = 0.5 / count
    begin = (np.arange(count) + 0.5) / count - half
    return begin, begin + 2 * half


def _great_circle(a: _Vectors, b: _Vectors) -> _Vectors:
    # Unit normal of the great circle through two corners
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    normal = a[1] * z - a[2] * y, a[2] * x - a[0] * z, a[0] * y - a[1] * x
    square = normal[0] * normal[0] + (normal[2] * normal[2] + normal[1] * normal[1])
    with np.errstate(divide="ignore"):
        scale = _inverse_length(square)
    scale[square == 0] = 0  # coincident corners
    return normal[0] * scale, normal[1] * scale, normal[2] * scale


def _dot(a: _Vectors, b: _Vectors) -> np.ndarray:
    return np.asarray((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2])
