"""Directions from the angles of goniophotometers."""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Points2, Values

# Farthest from the normal that light is moved, in the disc below the hemisphere.
_RIM = 0.9999


def from_degrees(theta_deg: float | Values, phi_deg: float | Values) -> Directions:
    """Unit vectors at an angle to the normal and an azimuth [°].

    The azimuth counts from the right towards up. A negative angle to the normal lies
    on the other side of it; beyond 90° the vector points to the other side of the
    layer.

    >>> from_degrees(90.0, 90.0).round(6).tolist()  # up
    [0.0, 1.0, 0.0]
    """
    theta, phi = np.radians(theta_deg), np.radians(phi_deg)
    flat = np.sin(theta)
    return np.stack(
        [flat * np.cos(phi), flat * np.sin(phi), np.cos(theta) + 0 * flat], axis=-1
    )


def upright(direction: Directions) -> Directions:
    """Directions mirrored to the side where z is not negative."""
    return np.concatenate([direction[..., :2], np.abs(direction[..., 2:])], axis=-1)


def angle_between(
    one: Float[np.ndarray, "*one 3"], other: Float[np.ndarray, "*other 3"]
) -> Float[np.ndarray, "*pair"]:
    """Angle between unit vectors [rad], exact also where it is small."""
    chord = np.linalg.norm(one - other, axis=-1)
    return np.asarray(2 * np.arcsin(np.minimum(chord / 2, 1)))


def angle_table(
    one: Float[np.ndarray, "one 3"], other: Float[np.ndarray, "other 3"]
) -> Float[np.ndarray, "one other"]:
    """Angles between all pairs of unit vectors [rad], to 1e-7 where they are small.

    >>> up = np.array([[0, 0, 1.0], [0, 0.6, 0.8]])
    >>> angle_table(up, up[:1]).round(4).tolist()
    [[0.0], [0.6435]]
    """
    squared_chord = np.maximum(2 - 2 * (one @ other.T), 0)
    return np.asarray(2 * np.arcsin(np.minimum(np.sqrt(squared_chord) / 2, 1)))


def above(disc: Points2) -> Directions:
    """Unit vectors above places in the disc; beyond its rim those just within it.

    >>> above(np.array([[0.6, 0.0], [0.0, 3.0]])).round(2).tolist()
    [[0.6, 0.0, 0.8], [0.0, 1.0, 0.01]]
    """
    length = np.linalg.norm(disc, axis=-1, keepdims=True)
    flat = disc * np.minimum(1, _RIM / np.maximum(length, 1e-12))
    height = np.sqrt(1 - np.sum(flat**2, axis=-1, keepdims=True))
    return np.concatenate([flat, height], axis=-1)


def straight_on(incident: Directions) -> Directions:
    """Where light goes straight on, or where a mirror sends it: both have this x, y."""
    return np.asarray(incident * [-1.0, -1.0, 1.0])
