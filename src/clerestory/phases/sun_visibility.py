"""Visibility of the sun from points of a scene, by geometry alone."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from clerestory.engine import device as devices
from clerestory.engine.device import Device
from clerestory.scene.model import Scene


def sun_visible(
    scene: Scene,
    points: Float[np.ndarray, "point 3"],
    suns: Float[np.ndarray, "sun 3"],
    *,
    device: Device = "auto",
) -> Bool[np.ndarray, "point sun"]:
    """Return whether the centre of the solar disc is visible from each point.

    Clear glass is transparent, as is proxied geometry of a BSDF; all other surfaces are
    opaque.

    Parameters
    ----------
    scene : obstructions
    points : coordinates of the points [m]
    suns : unit vectors to the sun, one per moment

    Raises
    ------
    DeviceError : no usable device
    """
    if not (len(points) and len(suns)):
        return np.zeros((len(points), len(suns)), dtype=bool)
    tracer: Any = devices.load(device, "direct_visibility")
    return np.asarray(tracer.direct_transmittance(scene, points, suns) > 0)
