"""Pixel directions with the rounding of Radiance.

`View.rays` gives the same directions with different rounding. Rounding matters because
evalglare does not search the row of a pixel whose direction has a squared length above
one. The projections are those of image.c, in the order of operations of the compiled
Radiance programs.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from clerestory.scene.projection import TINY, Kind
from clerestory.scene.view import View


class PixelRays(NamedTuple):
    """Unit vectors towards points of a picture; zero outside of the projection.

    `covered` tells whether points are within the projection; `up` is the vertical
    coordinate, positive above the line of sight.
    """

    direction: Float[np.ndarray, "row column 3"]
    covered: Bool[np.ndarray, "row column"]
    up: Float[np.ndarray, "row column"]


def pixel_rays(
    view: View, columns: int, rows: int, some: slice | None = None
) -> PixelRays:
    """Return the directions of the pixel centres in some rows, or in all.

    >>> rays = pixel_rays(View(kind="angular", horizontal=180, vertical=180), 3, 3)
    >>> rays.direction[1, 1].tolist()
    [0.0, 1.0, 0.0]
    """
    x = (np.arange(columns) + 0.5) / columns
    y = (np.arange(rows)[::-1] + 0.5) / rows
    return directions(view, x, y if some is None else y[some])


def directions(
    view: View, x: Float[np.ndarray, " column"], y: Float[np.ndarray, " row"]
) -> PixelRays:
    """Return the directions of a grid of points, from 0 to 1 across the picture."""
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
    # First-order expansion for lengths close to one
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
