"""Conversion of goniophotometer angles to unit vectors, and angles between vectors."""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Points2, Values

# Largest radius of points on the unit disc; below 1, so that z stays positive.
_RIM = 0.9999


def from_degrees(theta_deg: float | Values, phi_deg: float | Values) -> Directions:
    """Unit vectors at a polar angle and an azimuth [°].

    The azimuth runs from right (+x) to up (+y). A negative polar angle means the
    opposite azimuth; vectors at polar angles above 90° have z < 0.

    >>> from_degrees(90.0, 90.0).round(6).tolist()  # up
    [0.0, 1.0, 0.0]
    """
    theta, phi = np.radians(theta_deg), np.radians(phi_deg)
    flat = np.sin(theta)
    return np.stack(
        [flat * np.cos(phi), flat * np.sin(phi), np.cos(theta) + 0 * flat], axis=-1
    )


def upper_hemisphere(direction: Directions) -> Directions:
    """Directions, with negative z coordinates made positive."""
    return np.concatenate([direction[..., :2], np.abs(direction[..., 2:])], axis=-1)


def angle_between(
    one: Float[np.ndarray, "*one 3"], other: Float[np.ndarray, "*other 3"]
) -> Float[np.ndarray, "*pair"]:
    """Angle between unit vectors [rad], accurate for small angles."""
    chord = np.linalg.norm(one - other, axis=-1)
    return np.asarray(2 * np.arcsin(np.minimum(chord / 2, 1)))


def angle_table(
    one: Float[np.ndarray, "one 3"], other: Float[np.ndarray, "other 3"]
) -> Float[np.ndarray, "one other"]:
    """Angles between all pairs of unit vectors [rad], accurate to 1e-7 near 0.

    >>> up = np.array([[0, 0, 1.0], [0, 0.6, 0.8]])
    >>> angle_table(up, up[:1]).round(4).tolist()
    [[0.0], [0.6435]]
    """
    squared_chord = np.maximum(2 - 2 * (one @ other.T), 0)
    return np.asarray(2 * np.arcsin(np.minimum(np.sqrt(squared_chord) / 2, 1)))


def directions_over_disc(disc: Points2) -> Directions:
    """Unit vectors, z > 0, whose x and y are given points of the unit disc.

    Points outside the disc are moved to its circumference.

    >>> directions_over_disc(np.array([[0.6, 0.0], [0.0, 3.0]])).round(2).tolist()
    [[0.6, 0.0, 0.8], [0.0, 1.0, 0.01]]
    """
    length = np.linalg.norm(disc, axis=-1, keepdims=True)
    flat = disc * np.minimum(1, _RIM / np.maximum(length, 1e-12))
    height = np.sqrt(1 - np.sum(flat**2, axis=-1, keepdims=True))
    return np.concatenate([flat, height], axis=-1)


def undeviated(incident: Directions) -> Directions:
    """Direction of undeviated transmission or mirror reflection, mapped to z ≥ 0."""
    return np.asarray(incident * [-1.0, -1.0, 1.0])
