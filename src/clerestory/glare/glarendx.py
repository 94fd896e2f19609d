"""Position-weighted solid angles of Radiance's glarendx, for comparisons.

glarendx evaluates the weight 1/P² at the centre of a source and at six points on the
rim of a disc of the same solid angle. The result approximates the integral of 1/P² for
small sources off the line of sight; it is twice the integral for a source of 0.5 sr on
the line of sight.
"""

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.glare.imageless import position_of
from clerestory.glare.position_index import PositionModel
from clerestory.scene.view import View

# Azimuth of the points on the rim [rad], counter-clockwise from the right
_RIM = np.radians([0, 60, 180, 240, 300, 120])


def weighted_solid_angle(
    direction: Float[np.ndarray, "source 3"],
    solid_angle: Float[np.ndarray, " source"],
    view: View,
    *,
    model: PositionModel = "levin",
) -> Float[np.ndarray, " source"]:
    """Return solid angles weighted by 1/P² as in glarendx [sr]; 0 behind the eye.

    Directions are unit vectors to the centres of the sources. The up vector of the view
    is perpendicular to its direction.

    >>> eye = View(direction=np.array([0.0, 1.0, 0.0]))
    >>> ahead = np.array([[0.0, 1.0, 0.0]])
    >>> float(weighted_solid_angle(ahead, np.array([0.01]), eye).round(4)[0])
    0.01
    """
    largest = float(np.max(solid_angle, initial=0))
    require(largest < 2 * np.pi, f"a source of {largest:g} sr; less than 2π expected")
    cosine = 1 - solid_angle / (2 * np.pi)
    sine = np.sqrt(1 - cosine**2)
    across = np.cross(direction, view.up)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    across = across / np.where(length > 0, length, 1)

    # Weight 1/P² at the centre and on the rim
    aside = np.cos(_RIM)[:, None, None] * across + np.sin(_RIM)[:, None, None] * view.up
    rim = direction + sine[:, None] * aside
    rim /= np.linalg.norm(rim, axis=-1, keepdims=True)
    middle = position_of(direction, view, model=model) ** -2.0
    right, upper_right, left, lower_left, lower_right, upper_left = (
        position_of(rim, view, model=model) ** -2.0
    )

    # Quadrature of the weight over the disc, as in glarendx
    spread = np.pi * (cosine + 1 / cosine) - 2 * np.pi
    diagonal = upper_right + upper_left + lower_right + lower_left
    level = (right + upper_right) / 2 - middle
    upright = -middle - 0.1667 * (right + left) + 0.3334 * diagonal
    total = solid_angle * middle + spread * (level - upright)
    return np.asarray(np.where(length[:, 0] > 0, np.maximum(total, 0), 0))
