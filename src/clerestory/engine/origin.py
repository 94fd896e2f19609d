"""Origin of translated coordinates, near which single precision is sufficient."""

import numpy as np
from jaxtyping import Float

from clerestory.engine.work_units import evenly_spaced
from clerestory.scene.model import Scene
from clerestory.scene.surface import extent
from clerestory.scene.window import Window

# Point of the scene at the origin of translated coordinates [m]
Origin = Float[np.ndarray, "3"]

# Windows within this distance of the scene's centre share one origin [m]: ray offsets
# are at most half a millimetre there
_NEAR = 128.0

# Number of surfaces for the estimate of the scene's centre
_SURFACES = 1000


def middle_of_scene(scene: Scene) -> Origin:
    """Return the median of surface centres, unaffected by distant surfaces [m]."""
    if not scene.surfaces:
        return np.zeros(3)
    few = [scene.surfaces[n] for n in evenly_spaced(len(scene.surfaces), _SURFACES)]
    return np.asarray(np.median([extent(s).mean(axis=0) for s in few], axis=0))


def middle_of_window(window: Window) -> Origin:
    """Return the mean of the centres of a window's polygons [m]."""
    middles = [polygon.vertices.mean(axis=0) for polygon in window.polygons]
    return np.asarray(np.mean(middles, axis=0))


def window_origin(scene: Scene, window: Window) -> Origin:
    """Return the origin of translated coordinates for rays that start at a window [m].

    The origin is the centre of the scene if the window is near it, so that all windows
    of a building share one lowered scene; otherwise it is the centre of the window.
    """
    common, own = middle_of_scene(scene), middle_of_window(window)
    return common if np.linalg.norm(common - own) < _NEAR else own
