"""When the sun shines on points of a scene: geometry alone, without weather."""

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
    """Return whether the middle of the sun is seen from each point.

    Clear glass is looked through, and what stands for geometry with a BSDF; all other
    surfaces hide the sun.

    Parameters
    ----------
    scene : what may stand in the way
    points : [m]
    suns : unit vectors to the sun at several moments

    Raises
    ------
    DeviceError : no usable device
    """
    if not (len(points) and len(suns)):
        return np.zeros((len(points), len(suns)), dtype=bool)
    tracer: Any = devices.load(device, "direct_visibility")
    return np.asarray(tracer.direct_transmittance(scene, points, suns) > 0)
