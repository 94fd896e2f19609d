"""How much of a distant light reaches points straight, through clear glass at most."""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.lower import lower
from clerestory.engine.upload import launching, vectors
from clerestory.engine.visibility import transmittance
from clerestory.scene.model import Scene


def straight_share(
    scene: Scene,
    points: Float[np.ndarray, "point 3"],
    directions: Float[np.ndarray, "sun 3"],
) -> Float[np.ndarray, "point sun"]:
    """Return the share of light from far away that comes straight to each point.

    Parameters
    ----------
    points : [m]
    directions : unit vectors to where the light comes from
    """
    origin = points.mean(axis=0)
    count = len(directions)
    with launching():
        model = lower(scene, origin=origin)
        start = vectors(mi.Point3f, np.repeat(points - origin, count, axis=0))
        towards = vectors(mi.Vector3f, np.tile(directions, (len(points), 1)))
        share = transmittance(
            model, start, lambda at: mi.Ray3f(at, towards), mi.Bool(True)
        )
        found = np.asarray(dr.mean(share))
    return np.broadcast_to(found, len(points) * count).reshape(-1, count).astype(float)
