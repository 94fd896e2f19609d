"""Points of the solar disc, of equal share of its area."""

import numpy as np
from jaxtyping import Float

from clerestory.constants import SUN_DIAMETER

# Turn from one point to the next by which points are evenly distributed
GOLDEN_TURN = (3 - 5**0.5) / 2


def disc_points(
    suns: Float[np.ndarray, "sun 3"], place: Float[np.ndarray, "#sun point 2"]
) -> Float[np.ndarray, "sun point 3"]:
    """Return unit vectors to points of the solar disc.

    A place is the share of the disc that is closer to the centre, and the angle around
    it in turns.
    """
    depth = place[..., :1] * (1 - np.cos(SUN_DIAMETER / 2))
    flat, angle = np.sqrt(depth * (2 - depth)), 2 * np.pi * place[..., 1:]
    side = np.cross(suns, np.eye(3)[np.abs(suns).argmin(axis=1)])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    across = np.cross(suns, side)
    return np.asarray(
        suns[:, None] * (1 - depth)
        + flat * np.cos(angle) * side[:, None]
        + flat * np.sin(angle) * across[:, None]
    )
