"""Direct-sun coefficients, and black scenes for the direct terms of phase methods.

    C_ds  sensors × suns   irradiance per direct normal irradiance

All surfaces are black: light travels straight from the sky to the window and from the
window to the sensor, and is scattered by the window alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Unpack

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
from clerestory.checks import has_shape, one_of, require
from clerestory.engine.controller import estimate
from clerestory.engine.direct_sun_jobs import SunJob
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.matrix.axis import sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.traced_matrices import sensors_axis
from clerestory.scene.model import Plastic, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Default number of paths per sensor and sun
_SAMPLES = 64

# Sampling parameters that do not apply to direct-sun coefficients
_WITHOUT = ("relative_error", "bounces", "batches", "components")

_BLACK = Plastic("black", np.zeros(3))


def blackened(scene: Scene) -> Scene:
    """Return the scene with black surfaces, without sources at infinity."""
    return Scene(
        {"black": _BLACK},
        tuple(replace(surface, material="black") for surface in scene.surfaces),
    )


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
    scene : obstructions outside and inside
    windows : all windows; windows other than `window` are opaque
    window : name of the window for which coefficients are computed
    bsdf : BSDF of this window, matrix or tensor tree, at full resolution
    suns : unit vectors to the suns
    peak : whether direct-direct transmission is extracted from the BSDF, as by Radiance
        aBSDF
    samples : number of paths per sensor and sun
    """
    effort = sun_effort(sun_coefficients, keywords, samples=_SAMPLES)
    number = window_number(windows, window, bsdf, suns)
    behind = suns @ windows[number].frame.normal < 0
    job = SunJob(
        scene=blackened(scene),
        windows=tuple(windows),
        number=number,
        bsdf=bsdf,
        sensors=sensors,
        suns=suns[behind],
        peak=peak,
        samples=effort.samples or _SAMPLES,
        **effort.job_options(),
    )
    lit = estimate(job, effort)
    assert lit.components is not None
    shape = len(lit.values), len(sensors), len(suns)
    values = np.zeros(shape)
    values[..., behind] = lit.values
    components = np.zeros((len(lit.components), *shape), np.float32)
    components[..., behind] = lit.components
    axes = sensors_axis(sensors), sun_axis(len(suns))
    return TransferMatrix(values, *axes, components)


def sun_effort(
    function: Callable[..., object], keywords: EffortKeywords, *, samples: int
) -> Effort:
    """Return the checked sampling parameters for tracing direct sunlight.

    `samples` is the default number of paths per receiver and sun.
    """
    goal, most = Goal(samples), 1 << 20
    return effort_of(
        function, keywords, default=goal, most_samples=most, without=_WITHOUT
    )


def window_number(
    windows: Sequence[Window], window: str, bsdf: Bsdf, suns: Float[np.ndarray, "sun 3"]
) -> int:
    """Check window name, BSDF and suns, and return the index of the window."""
    names = [each.name for each in windows]
    one_of(window, "window", choices=names)
    message = "the BSDF has no visible transmission; a transmitting layer expected"
    require(bsdf.has("transmission_front"), message, file=bsdf.source)
    has_shape(suns, (len(suns), 3), "array of unit vectors to the suns")
    return names.index(window)
