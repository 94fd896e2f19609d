"""View projections: six mappings from directions to the image plane.

Plane coordinates (u, v) point right and up, with (0, 0) on the view axis; local
directions are (right, up, forward) in the frame of the view. A projection defines the
mapping between directions and plane, the plane coordinate of a view angle, and the
solid angle of a rectangle in the plane. Source: Radiance, image.c.
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
    "perspective", "parallel", "hemispherical", "angular", "planisphere", "cylindrical"
]

# Radiance's view types by letter, as in the option -vt
LETTERS: dict[str, Kind] = {
    "v": "perspective",
    "l": "parallel",
    "h": "hemispherical",
    "a": "angular",
    "s": "planisphere",
    "c": "cylindrical",
}

_Plane = Float[np.ndarray, "*shape"]
_Local = Float[np.ndarray, "*shape 3"]

# Radiance's tolerance for angles and distances (rtmath.h: FTINY)
TINY = 1e-6


@dataclass(frozen=True)
class Projection:
    """The mapping of one view type between directions and the image plane.

    Attributes
    ----------
    largest : maximum horizontal and vertical view angles [deg]; infinite for a parallel
        view
    axes : horizontally and vertically, the function from full view angle [deg] to plane
        coordinate of the image edge, and its inverse
    to_direction : function from plane points to local unit directions and validity
    to_plane : function from local unit directions to plane points; NaN if outside
    solid_angles : function from grid lines in the plane to solid angles [sr]
    """

    largest: tuple[float, float]
    axes: tuple["_Axis", "_Axis"]
    to_direction: Callable[[_Plane, _Plane], tuple[_Local, Bool[np.ndarray, "*shape"]]]
    to_plane: Callable[[_Local], tuple[_Plane, _Plane]]
    solid_angles: Callable[[Lines, Lines], Float[np.ndarray, "rows columns"]]

    def extent(self, horizontal: float, vertical: float) -> tuple[float, float]:
        """Return plane coordinates of the image edges for full view angles [deg]."""
        (width_of, _), (height_of, _) = self.axes
        return float(width_of(horizontal)), float(height_of(vertical))

    def angles(self, width: float, height: float) -> tuple[float, float]:
        """Return full view angles [deg] for plane coordinates of the image edges."""
        (_, horizontal_of), (_, vertical_of) = self.axes
        return float(horizontal_of(width)), float(vertical_of(height))


# Plane coordinate as a function of full view angle [deg], and the inverse function
_Axis = tuple[Callable[[float], float], Callable[[float], float]]
_SIZE: _Axis = (lambda a: a / 2, lambda x: 2 * x)
_ANGLE: _Axis = (lambda a: np.radians(a) / 2, lambda x: np.degrees(2 * x))
_SINE: _Axis = (
    lambda a: np.sin(np.radians(a) / 2),
    lambda x: np.degrees(2 * np.arcsin(min(x, 1.0))),
)
_TANGENT: _Axis = (
    lambda a: np.tan(np.radians(a) / 2),
    lambda x: np.degrees(2 * np.arctan(x)),
)
_HALF_TANGENT: _Axis = (
    lambda a: np.tan(np.radians(a) / 4),
    lambda x: np.degrees(4 * np.arctan(x)),
)


def _everywhere(u: _Plane) -> Bool[np.ndarray, "*shape"]:
    return np.ones(np.shape(u), dtype=bool)


def _unit(local: _Local) -> _Local:
    return np.asarray(local / np.linalg.norm(local, axis=-1, keepdims=True))


def _perspective_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    return _unit(np.stack([u, v, np.ones_like(u)], axis=-1)), _everywhere(u)


def _perspective_plane(local: _Local) -> tuple[_Plane, _Plane]:
    forward = np.where(local[..., 2] > 0, local[..., 2], np.nan)
    return local[..., 0] / forward, local[..., 1] / forward


def _parallel_direction(u: _Plane, _v: _Plane) -> tuple[_Local, np.ndarray]:
    direction = np.zeros((*np.shape(u), 3))
    direction[..., 2] = 1
    return direction, _everywhere(u)


def _parallel_plane(local: _Local) -> tuple[_Plane, _Plane]:
    nowhere = np.full(local.shape[:-1], np.nan)
    return nowhere, nowhere.copy()


def _hemispherical_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    rest = 1 - u * u - v * v
    return np.stack([u, v, np.sqrt(np.maximum(rest, 0))], axis=-1), rest >= 0


def _hemispherical_plane(local: _Local) -> tuple[_Plane, _Plane]:
    visible = np.where(local[..., 2] >= 0, 1.0, np.nan)
    return local[..., 0] * visible, local[..., 1] * visible


def _angular_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    theta = np.hypot(u, v)
    share = np.sinc(theta / np.pi)
    return np.stack([u * share, v * share, np.cos(theta)], axis=-1), theta <= np.pi


def _angular_plane(local: _Local) -> tuple[_Plane, _Plane]:
    sine = np.hypot(local[..., 0], local[..., 1])
    theta = np.arctan2(sine, local[..., 2])
    # θ / sin θ tends to 1 on the axis; the backward direction has no azimuth
    ratio = np.divide(theta, sine, out=np.ones_like(theta), where=sine > 0)
    behind = (sine == 0) & (local[..., 2] < 0)
    return np.where(behind, np.pi, local[..., 0] * ratio), local[..., 1] * ratio


def _planisphere_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    square = u * u + v * v
    scale = 2 / (1 + square)
    return np.stack([u * scale, v * scale, scale - 1], axis=-1), _everywhere(u)


def _planisphere_plane(local: _Local) -> tuple[_Plane, _Plane]:
    scale = np.where(local[..., 2] > -1, 1 + local[..., 2], np.nan)
    return local[..., 0] / scale, local[..., 1] / scale


def _cylindrical_direction(u: _Plane, v: _Plane) -> tuple[_Local, np.ndarray]:
    return _unit(np.stack([np.sin(u), v, np.cos(u)], axis=-1)), _everywhere(u)


def _cylindrical_plane(local: _Local) -> tuple[_Plane, _Plane]:
    flat = np.hypot(local[..., 0], local[..., 2])
    flat = np.where(flat > 0, flat, np.nan)
    return np.arctan2(local[..., 0], local[..., 2]), local[..., 1] / flat


PROJECTIONS: dict[Kind, Projection] = {
    "perspective": Projection(
        (180 - TINY, 180 - TINY),
        (_TANGENT, _TANGENT),
        _perspective_direction,
        _perspective_plane,
        perspective_angles,
    ),
    "parallel": Projection(
        (np.inf, np.inf),
        (_SIZE, _SIZE),
        _parallel_direction,
        _parallel_plane,
        parallel_angles,
    ),
    "hemispherical": Projection(
        (180 + TINY, 180 + TINY),
        (_SINE, _SINE),
        _hemispherical_direction,
        _hemispherical_plane,
        hemispherical_angles,
    ),
    "angular": Projection(
        (360 + TINY, 360 + TINY),
        (_ANGLE, _ANGLE),
        _angular_direction,
        _angular_plane,
        angular_angles,
    ),
    "planisphere": Projection(
        (360 - TINY, 360 - TINY),
        (_HALF_TANGENT, _HALF_TANGENT),
        _planisphere_direction,
        _planisphere_plane,
        planisphere_angles,
    ),
    "cylindrical": Projection(
        (360 + TINY, 180 - TINY),
        (_ANGLE, _TANGENT),
        _cylindrical_direction,
        _cylindrical_plane,
        cylindrical_angles,
    ),
}
