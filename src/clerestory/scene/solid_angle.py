"""Solid angles of rectangles in the image plane of each view type.

Grid lines are plane coordinates as in `projection`. If there is a closed form for
rectangles with a corner at the origin, the solid angle of any rectangle is the signed
sum of four such solid angles.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

Lines = Float[np.ndarray, " lines"]
_Plane = Float[np.ndarray, "*shape"]

# Maximum pixel size [rad] for quadrature with two Gauss points per axis
_FINE = 0.02


def _between(corner: Callable[[_Plane, _Plane], _Plane]) -> Callable[..., np.ndarray]:
    # `corner` returns the solid angle between origin and (u, v), with the sign of u·v
    def solid_angles(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        at_corners = corner(*np.meshgrid(u, v))
        return np.asarray(np.abs(np.diff(np.diff(at_corners, axis=0), axis=1)))

    return solid_angles


def _perspective_corner(u: _Plane, v: _Plane) -> _Plane:
    # Solid angle of a rectangle as seen from a point above one of its corners
    return np.asarray(np.arctan2(u * v, np.sqrt(1 + u * u + v * v)))


def parallel_angles(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the solid angles in a parallel view: zero, as all rays are parallel."""
    return np.zeros((v.size - 1, u.size - 1))


def _hemispherical_corner(u: _Plane, v: _Plane) -> _Plane:
    # ∫∫ du dv / √(1 − u² − v²) over the part of the rectangle within the unit disc
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


def angular_angles(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the solid angles in an angular view, up to the rim at θ = π [sr]."""
    # ∫∫ sin θ / θ du dv has no closed form; the error of the quadrature is below 1e-9
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


def _planisphere_corner(u: _Plane, v: _Plane) -> _Plane:
    # ∫∫ 4 du dv / (1 + u² + v²)²
    root_u, root_v = np.sqrt(1 + u * u), np.sqrt(1 + v * v)
    return np.asarray(
        2 * (u / root_u * np.arctan(v / root_u) + v / root_v * np.arctan(u / root_v))
    )


def _cylindrical_corner(u: _Plane, v: _Plane) -> _Plane:
    return np.asarray(u * v / np.sqrt(1 + v * v))


perspective_angles = _between(_perspective_corner)
hemispherical_angles = _between(_hemispherical_corner)
planisphere_angles = _between(_planisphere_corner)
cylindrical_angles = _between(_cylindrical_corner)
