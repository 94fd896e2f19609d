"""View projections: six mappings from directions to the image plane.

Plane coordinates (u, v) point right and up, with (0, 0) on the view axis; local
directions are (right, up, forward) in the frame of the view. A projection maps
directions to plane coordinates and back, maps view angles to plane coordinates and
back, and computes the solid angles of rectangles in the plane. If there is a closed
form for rectangles with a corner at the origin, the solid angle of any rectangle is the
signed sum of the solid angles of four such rectangles. Source: Radiance, image.c.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

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
_Lines = Float[np.ndarray, " lines"]

# Radiance's tolerance for angles and distances (rtmath.h: FTINY)
TINY = 1e-6


@dataclass(frozen=True)
class Projection:
    """The mapping of one view type between directions and the image plane.

    `largest` are the maximum horizontal and vertical view angles [deg]. `axes` convert
    full view angles [deg] to the plane coordinates of image edges, and back.
    `to_direction` returns local unit directions, and whether points are inside the
    projection; `to_plane` returns NaN outside. `solid_angles` returns the solid angles
    [sr] of the rectangles between grid lines.
    """

    largest: tuple[float, float]
    axes: tuple["_Axis", "_Axis"]
    to_direction: Callable[[_Plane, _Plane], tuple[_Local, Bool[np.ndarray, "*shape"]]]
    to_plane: Callable[[_Local], tuple[_Plane, _Plane]]
    solid_angles: Callable[[_Lines, _Lines], Float[np.ndarray, "rows columns"]]

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
    # θ / sin θ tends to 1 on the axis; the backward direction is assigned to u = π
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


# Pixel size [rad] below which quadrature has two Gauss points per axis, else eight
_FINE = 0.02


def _between(corner: Callable[[_Plane, _Plane], _Plane]) -> Callable[..., np.ndarray]:
    # `corner`: solid angle of the rectangle from (0, 0) to (u, v), with the sign of u·v
    def solid_angles(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        at_corners = corner(*np.meshgrid(u, v))
        return np.asarray(np.abs(np.diff(np.diff(at_corners, axis=0), axis=1)))

    return solid_angles


@_between
def _perspective_angles(u: _Plane, v: _Plane) -> _Plane:
    # Solid angle of a rectangle seen from a point above a corner at unit distance
    return np.asarray(np.arctan2(u * v, np.sqrt(1 + u * u + v * v)))


def _parallel_angles(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    # Parallel rays span no solid angle
    return np.zeros((v.size - 1, u.size - 1))


@_between
def _hemispherical_angles(u: _Plane, v: _Plane) -> _Plane:
    # ∫∫ du dv / √(1 − u² − v²) over the intersection of rectangle and unit disc
    x, y = np.minimum(np.abs(u), 1), np.minimum(np.abs(v), 1)
    rest = 1 - x * x - y * y
    root_x, root_y = np.sqrt(1 - x * x), np.sqrt(1 - y * y)
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = (
            x * np.arcsin(np.clip(y / root_x, 0, 1))
            + y * np.arcsin(np.clip(x / root_y, 0, 1))
            - np.arctan2(x * y, np.sqrt(np.maximum(rest, 0)))
        )
    return np.asarray(
        np.sign(u) * np.sign(v) * np.where(rest > 0, inside, (x + y - 1) * np.pi / 2)
    )


def _angular_angles(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    # ∫∫ sin θ / θ du dv up to the rim at θ = π has no closed form; the error of the
    # quadrature is below 1e-9
    step = max(np.abs(np.diff(u)).max(), np.abs(np.diff(v)).max())
    node, weight = np.polynomial.legendre.leggauss(2 if step < _FINE else 8)
    total = np.zeros((v.size - 1, u.size - 1))
    for x, wx in zip(node, weight, strict=True):
        at_u = (u[:-1] + u[1:]) / 2 + x * np.diff(u) / 2
        for y, wy in zip(node, weight, strict=True):
            at_v = (v[:-1] + v[1:]) / 2 + y * np.diff(v) / 2
            theta = np.hypot(at_u[None, :], at_v[:, None])
            total += wx * wy * np.where(theta < np.pi, np.sinc(theta / np.pi), 0)
    return np.asarray(total * np.abs(np.outer(np.diff(v), np.diff(u))) / 4)


@_between
def _planisphere_angles(u: _Plane, v: _Plane) -> _Plane:
    # ∫∫ 4 du dv / (1 + u² + v²)²
    root_u, root_v = np.sqrt(1 + u * u), np.sqrt(1 + v * v)
    return np.asarray(
        2 * (u / root_u * np.arctan(v / root_u) + v / root_v * np.arctan(u / root_v))
    )


@_between
def _cylindrical_angles(u: _Plane, v: _Plane) -> _Plane:
    return np.asarray(u * v / np.sqrt(1 + v * v))


PROJECTIONS: dict[Kind, Projection] = {
    "perspective": Projection(
        (180 - TINY, 180 - TINY),
        (_TANGENT, _TANGENT),
        _perspective_direction,
        _perspective_plane,
        _perspective_angles,
    ),
    "parallel": Projection(
        (np.inf, np.inf),
        (_SIZE, _SIZE),
        _parallel_direction,
        _parallel_plane,
        _parallel_angles,
    ),
    "hemispherical": Projection(
        (180 + TINY, 180 + TINY),
        (_SINE, _SINE),
        _hemispherical_direction,
        _hemispherical_plane,
        _hemispherical_angles,
    ),
    "angular": Projection(
        (360 + TINY, 360 + TINY),
        (_ANGLE, _ANGLE),
        _angular_direction,
        _angular_plane,
        _angular_angles,
    ),
    "planisphere": Projection(
        (360 - TINY, 360 - TINY),
        (_HALF_TANGENT, _HALF_TANGENT),
        _planisphere_direction,
        _planisphere_plane,
        _planisphere_angles,
    ),
    "cylindrical": Projection(
        (360 + TINY, 180 - TINY),
        (_ANGLE, _TANGENT),
        _cylindrical_direction,
        _cylindrical_plane,
        _cylindrical_angles,
    ),
}
