"""Direct-sun coefficients C_ds of sensors and pictures.

    sensors × suns   irradiance per direct normal irradiance
    pixels × suns    radiance per direct normal irradiance [1/sr]

All surfaces are black: light travels straight from the sky to the window and from the
window to the sensor, and is scattered by the window alone.
"""

from collections.abc import Sequence
from typing import Unpack

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.spectral_channels import has_bands
from clerestory.engine.effort import EffortKeywords
from clerestory.image.camera import Camera
from clerestory.matrix.axis import pixel_axis, sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened, sun_effort
from clerestory.phases.sunlit import in_sunlight
from clerestory.phases.traced_matrices import sensors_axis
from clerestory.phases.window_paths import (
    PIXEL_SAMPLES,
    SENSOR_SAMPLES,
    picture_window_paths,
    sensor_window_paths,
)
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window


def sun_coefficients(
    scene: Scene,
    windows: Sequence[Window],
    window: str,
    bsdf: Bsdf,
    *,
    sensors: Sensors,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Direct-sun coefficients C_ds: irradiance per direct normal irradiance.

    Coefficients are zero for suns behind the window plane. The solar disc has a
    diameter of 0.533°.

    Parameters
    ----------
    scene : obstructions outside and inside, all taken as black
    windows : all windows; windows other than `window` are opaque
    window : name of the window for which coefficients are computed
    bsdf : BSDF of this window, matrix or tensor tree, at full resolution
    suns : unit vectors to the suns
    peak : whether direct-direct transmission is extracted from the BSDF, as by Radiance
        aBSDF
    samples : number of paths per sensor, for all suns
    """
    effort = sun_effort(sun_coefficients, keywords, samples=SENSOR_SAMPLES)
    paths = sensor_window_paths(blackened(scene), windows, sensors, effort=effort)
    lit = in_sunlight(paths, window, bsdf, suns=suns, peak=peak)
    bands = scene.bands if has_bands(bsdf, scene.bands) else RGB
    grey = bands == RGB and not bsdf.in_colour("transmission_front")
    values, parts = lit.coefficients(1 if grey else len(bands))
    axes = sensors_axis(sensors), sun_axis(len(suns))
    return TransferMatrix(values, *axes, parts, bands)


def picture_sun_coefficients(
    scene: Scene,
    windows: Sequence[Window],
    window: str,
    bsdf: Bsdf,
    camera: Camera,
    *,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Direct-sun coefficients of a picture [1/sr].

    Pixel radiance per direct normal irradiance: the sun seen through the window
    (C_F-ds) plus sunlight reflected once in the room (C_R-ds). See `sun_coefficients`
    for the parameters; `samples` is the number of paths per pixel, for all suns.
    """
    effort = sun_effort(picture_sun_coefficients, keywords, samples=PIXEL_SAMPLES)
    paths = picture_window_paths(scene, windows, camera, effort=effort)
    lit = in_sunlight(paths, window, bsdf, suns=suns, peak=peak)
    values, parts = lit.coefficients(len(scene.bands))
    axes = pixel_axis(len(camera)), sun_axis(len(suns))
    # The two components are opposite; one of them is the error
    return TransferMatrix(values, *axes, parts[:1] * np.float32(2**0.5), scene.bands)
