"""Unit vectors, azimuth and altitude, coordinate frames of surfaces, and arcs.

East is +x, north +y, up +z. Azimuth is measured clockwise from north and altitude from
the horizon, both in radians.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Points2, Values, Vector
from clerestory.checks import require


def unit(vector: Directions) -> Directions:
    """Vectors normalised to unit length."""
    vector = np.asarray(vector, dtype=float)
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    require(
        np.all(np.isfinite(length) & (length > 0)),
        "a direction is zero or not finite; a vector of non-zero length expected",
    )
    return np.asarray(vector / length)


def circular_arc(radius: float, half: float, segments: int) -> Points2:
    """Points (along, above) of a circular arc, whose ends are at height 0.

    `half` is the angle from the middle to an end [rad]; the middle is below the ends if
    the radius is negative.
    """
    angle = np.linspace(-half, half, segments + 1)
    above = radius * (np.cos(angle) - np.cos(half))
    return np.stack([abs(radius) * np.sin(angle), above], axis=1)


def from_azimuth(azimuth: Values, altitude: Values) -> Directions:
    """Unit vectors towards the given azimuth and altitude [rad].

    >>> from_azimuth(np.array(np.pi / 2), np.array(0.0)).round(6).tolist()  # east
    [1.0, 0.0, 0.0]
    """
    flat = np.cos(altitude)
    return np.stack(
        [flat * np.sin(azimuth), flat * np.cos(azimuth), np.sin(altitude)], axis=-1
    )


@dataclass(frozen=True, eq=False)
class Frame:
    """Right-handed frame of a surface, as unit vectors: right × up = normal."""

    right: Float[np.ndarray, "3"]
    up: Float[np.ndarray, "3"]
    normal: Float[np.ndarray, "3"]

    @classmethod
    def from_normal_up(cls, normal: Vector, up: Vector) -> "Frame":
        """Frame with the given normal, and with `up` projected onto the surface."""
        normal, up = unit(normal), unit(up)
        flat = up - np.dot(up, normal) * normal
        require(
            np.linalg.norm(flat) >= 1e-4,
            f"the up vector {np.round(up, 3).tolist()} is parallel to the normal; a"
            " direction within the surface is expected",
        )
        flat = unit(flat)
        return cls(np.cross(flat, normal), flat, normal)
