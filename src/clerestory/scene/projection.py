"""The six ways in which a view maps directions to its image plane.

A plane point (u, v) grows to the right and upwards and is (0, 0) on the view's axis;
a local direction is (right, up, forward) in the frame of the view. What differs from
kind to kind is the map between both, the plane coordinate that a view angle reaches,
and the solid angle of a rectangle in the plane. The maps are those of Radiance's
image.c.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from clerestory.scene.solid_angle import (
    Lines,
    angular_angles,
    cylindrical_angles,
    hemispherical_angles,
    parallel_angles,
    perspective_angles,
    planisphere_angles,
)

Kind = Literal[
    "perspective",
    "parallel",
    "hemispherical",
    "angular",
    "planisphere",
    "cylindrical",
]

_Plane = Float[np.ndarray, "*shape"]
_Local = Float[np.ndarray, "*shape 3"]

# Angles and distances that Radiance takes for equal (rtmath.h: FTINY)
TINY = 1e-6


@dataclass(frozen=True)
class Projection:
    """How one kind of view maps directions to its plane.

    Attributes
    ----------
    largest : view angles up to which it works, horizontal and vertical [deg];
        for a parallel view there is no limit
    extent : plane coordinate, horizontal and vertical, at the edges of a view whose
        full angles are given [deg]
    angles : the inverse of `extent` [deg]
    to_direction : local unit directions of plane points, and where there are any
    to_plane : plane points of local unit directions, nan where there are none
    solid_angles : solid angles between grid lines of the plane [sr]; zero in a
        parallel view, which sees one direction only
    """

    largest: tuple[float, float]
    extent: Callable[[float, float], tuple[float, float]]
    angles: Callable[[float, float], tuple[float, float]]
    to_direction: Callable[[_Plane, _Plane], tuple[_Local, Bool[np.ndarray, "*shape"]]]
    to_plane: Callable[[_Local], tuple[_Plane, _Plane]]
    solid_angles: Callable[[Lines, Lines], Float[np.ndarray, "rows columns"]]


def _everywhere(u: _Plane) -> Bool[np.ndarray, "*shape"]:
    return np.ones(np.shape(u), dtype=bool)


def _unit(local: _Local) -> _Local:
    scaled: np.ndarray = local / np.linalg.norm(local, axis=-1, keepdims=True)
    return scaled


def _degrees(angle: float) -> float:
    return float(np.degrees(angle))


# --------------------------------- Perspective ----------------------------------


def _tangents(horizontal: float, vertical: float) -> tuple[float, float]:
    return np.tan(np.radians(horizontal) / 2), np.tan(np.radians(vertical) / 2)


def _from_tangents(width: float, height: float) -> tuple[float, float]:
    return _degrees(2 * np.arctan(width)), _degrees(2 * np.arctan(height))


def _perspective_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    return _unit(np.stack([u, v, np.ones_like(u)], axis=-1)), _everywhere(u)


def _perspective_plane(local: _Local) -> tuple[_Plane, _Plane]:
    forward = np.where(local[..., 2] > 0, local[..., 2], np.nan)
    return local[..., 0] / forward, local[..., 1] / forward


# ----------------------------------- Parallel -----------------------------------


def _half_size(horizontal: float, vertical: float) -> tuple[float, float]:
    return horizontal / 2, vertical / 2


def _from_half_size(width: float, height: float) -> tuple[float, float]:
    return 2 * width, 2 * height


def _parallel_direction(u: _Plane, _v: _Plane) -> tuple[_Local, np.ndarray]:
    direction = np.zeros((*np.shape(u), 3))
    direction[..., 2] = 1
    return direction, _everywhere(u)


def _parallel_plane(local: _Local) -> tuple[_Plane, _Plane]:
    nowhere = np.full(local.shape[:-1], np.nan)
    return nowhere, nowhere.copy()


# -------------------------------- Hemispherical ---------------------------------


def _sines(horizontal: float, vertical: float) -> tuple[float, float]:
    return np.sin(np.radians(horizontal) / 2), np.sin(np.radians(vertical) / 2)


def _from_sines(width: float, height: float) -> tuple[float, float]:
    return (
        _degrees(2 * np.arcsin(min(width, 1.0))),
        _degrees(2 * np.arcsin(min(height, 1.0))),
    )


def _hemispherical_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    rest = 1 - u * u - v * v
    return np.stack([u, v, np.sqrt(np.maximum(rest, 0))], axis=-1), rest >= 0


def _hemispherical_plane(local: _Local) -> tuple[_Plane, _Plane]:
    seen = np.where(local[..., 2] >= 0, 1.0, np.nan)
    return local[..., 0] * seen, local[..., 1] * seen


# ----------------------------------- Angular ------------------------------------


def _half_angles(horizontal: float, vertical: float) -> tuple[float, float]:
    return float(np.radians(horizontal) / 2), float(np.radians(vertical) / 2)


def _from_half_angles(width: float, height: float) -> tuple[float, float]:
    return _degrees(2 * width), _degrees(2 * height)


def _angular_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    theta = np.hypot(u, v)
    share = np.sinc(theta / np.pi)
    return np.stack([u * share, v * share, np.cos(theta)], axis=-1), theta <= np.pi


def _angular_plane(local: _Local) -> tuple[_Plane, _Plane]:
    sine = np.hypot(local[..., 0], local[..., 1])
    theta = np.arctan2(sine, local[..., 2])
    # On the axis the ratio tends to one; behind, the edge has no direction of its own
    ratio = np.divide(theta, sine, out=np.ones_like(theta), where=sine > 0)
    behind = (sine == 0) & (local[..., 2] < 0)
    return np.where(behind, np.pi, local[..., 0] * ratio), local[..., 1] * ratio


# --------------------------------- Planisphere ----------------------------------


def _half_tangents(horizontal: float, vertical: float) -> tuple[float, float]:
    return np.tan(np.radians(horizontal) / 4), np.tan(np.radians(vertical) / 4)


def _from_half_tangents(width: float, height: float) -> tuple[float, float]:
    return _degrees(4 * np.arctan(width)), _degrees(4 * np.arctan(height))


def _planisphere_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    square = u * u + v * v
    scale = 2 / (1 + square)
    return np.stack([u * scale, v * scale, scale - 1], axis=-1), _everywhere(u)


def _planisphere_plane(local: _Local) -> tuple[_Plane, _Plane]:
    scale = np.where(local[..., 2] > -1, 1 + local[..., 2], np.nan)
    return local[..., 0] / scale, local[..., 1] / scale


# --------------------------------- Cylindrical ----------------------------------


def _angle_and_tangent(horizontal: float, vertical: float) -> tuple[float, float]:
    return float(np.radians(horizontal) / 2), np.tan(np.radians(vertical) / 2)


def _from_angle_and_tangent(width: float, height: float) -> tuple[float, float]:
    return _degrees(2 * width), _degrees(2 * np.arctan(height))


def _cylindrical_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    return _unit(np.stack([np.sin(u), v, np.cos(u)], axis=-1)), _everywhere(u)


def _cylindrical_plane(local: _Local) -> tuple[_Plane, _Plane]:
    flat = np.hypot(local[..., 0], local[..., 2])
    flat = np.where(flat > 0, flat, np.nan)
    return np.arctan2(local[..., 0], local[..., 2]), local[..., 1] / flat


PROJECTIONS: dict[Kind, Projection] = {
    "perspective": Projection(
        (180 - TINY, 180 - TINY),
        _tangents,
        _from_tangents,
        _perspective_direction,
        _perspective_plane,
        perspective_angles,
    ),
    "parallel": Projection(
        (np.inf, np.inf),
        _half_size,
        _from_half_size,
        _parallel_direction,
        _parallel_plane,
        parallel_angles,
    ),
    "hemispherical": Projection(
        (180 + TINY, 180 + TINY),
        _sines,
        _from_sines,
        _hemispherical_direction,
        _hemispherical_plane,
        hemispherical_angles,
    ),
    "angular": Projection(
        (360 + TINY, 360 + TINY),
        _half_angles,
        _from_half_angles,
        _angular_direction,
        _angular_plane,
        angular_angles,
    ),
    "planisphere": Projection(
        (360 - TINY, 360 - TINY),
        _half_tangents,
        _from_half_tangents,
        _planisphere_direction,
        _planisphere_plane,
        planisphere_angles,
    ),
    "cylindrical": Projection(
        (360 + TINY, 180 - TINY),
        _angle_and_tangent,
        _from_angle_and_tangent,
        _cylindrical_direction,
        _cylindrical_plane,
        cylindrical_angles,
    ),
}
