"""Origin of the device's coordinates, near which single precision is exact."""

import numpy as np
from jaxtyping import Float

from clerestory.engine.work_units import evenly_spaced
from clerestory.scene.model import Scene
from clerestory.scene.surface import extent
from clerestory.scene.window import Window

# Windows nearer to the middle of their scene than this share one origin [m]: rays
# leave surfaces there by half a millimetre at most
_NEAR = 128.0

# Surfaces that the middle of a scene is estimated from
_SURFACES = 1000


def middle_of_scene(scene: Scene) -> Float[np.ndarray, "3"]:
    """Return the median of the surfaces' middles [m]; far grounds hardly move it."""
    if not scene.surfaces:
        return np.zeros(3)
    few = [scene.surfaces[n] for n in evenly_spaced(len(scene.surfaces), _SURFACES)]
    return np.asarray(np.median([extent(s).mean(axis=0) for s in few], axis=0))


def middle_of_window(window: Window) -> Float[np.ndarray, "3"]:
    """Return the mean of the middles of a window's polygons [m]."""
    middles = [polygon.vertices.mean(axis=0) for polygon in window.polygons]
    return np.asarray(np.mean(middles, axis=0))


def window_origin(scene: Scene, window: Window) -> Float[np.ndarray, "3"]:
    """Return the origin for light that starts at a window [m].

    The middle of the scene where that is near, so that all windows of a building see
    the same numbers and the scene is built once for them; else the window's own.
    """
    common, own = middle_of_scene(scene), middle_of_window(window)
    return common if np.linalg.norm(common - own) < _NEAR else own
