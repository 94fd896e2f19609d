"""Pictures and irradiance at one moment, by path tracing.

The scene contains surfaces, lamps, and sky and sun as sources at infinity, as in the
output of `gensky` and `gendaylit`. Every pixel and sensor has a standard error.
"""

from dataclasses import dataclass
from typing import Unpack

import numpy as np
from jaxtyping import Float

from clerestory import __version__
from clerestory.bands import RGB, Bands
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.engine.adaptive_pixels import estimate_picture
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.radiance_jobs import (
    PICTURE_BATCHES,
    IrradianceJob,
    PictureJob,
    estimate_radiance,
)
from clerestory.engine.unsampled_light import warn_of_unsampled_light
from clerestory.engine.work_units import Goal
from clerestory.image.picture import Picture, Quantity
from clerestory.phases.traced_matrices import (
    require_gather,
    require_sensors,
    warn_if_short,
)
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

# Default, if neither samples nor relative_error is given
_DEFAULT = Goal(samples=None, relative_error=0.02)


@dataclass(frozen=True, eq=False)
class Rendering:
    """Picture of radiance [W/(m²·sr)] or irradiance [W/m²], with standard errors."""

    picture: Picture
    error: Float[np.ndarray, "row column band"]
    paths: int

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class Gathered:
    """Irradiance [W/m²] of sensors at one instant, and its standard error.

    `illuminance_error`: standard error of the illuminance [lux], from the same batches
    of paths; the errors of the bands are correlated.
    """

    irradiance: Float[np.ndarray, "sensor band"]
    error: Float[np.ndarray, "sensor band"]
    illuminance_error: Float[np.ndarray, " sensor"]
    paths: int
    bands: Bands = RGB

    __repr__ = brief

    def illuminance(self) -> Float[np.ndarray, " sensor"]:
        """Illuminance of each sensor [lux]."""
        return self.bands.photometric(self.irradiance)


def render(
    scene: Scene,
    view: View,
    *,
    columns: int,
    rows: int,
    **keywords: Unpack[EffortKeywords],
) -> Rendering:
    """Trace a picture.

    Parameters
    ----------
    scene : surfaces and light sources
    view : camera; pixels outside its projection are black
    columns, rows : size of the picture; see `View.size_for`
    samples : number of paths per pixel
    relative_error : instead of samples: target RMS of the pixels' standard errors,
        relative to the mean pixel value; 0.02 if neither is given
    bounces : maximum number of diffuse reflections, as Radiance -ab; default unlimited
    seed : random seed ≥ 0; same seed and device, bitwise identical results
    device : "auto" selects a GPU if one is available
    executor : executor of the tracing jobs, such as a `Cluster`; default: local
    progress : callback with the completed fraction (0…1) and a status text

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range
    DeviceError : no usable compute device
    """
    effort = effort_of(render, keywords, default=_DEFAULT)
    return _picture(scene, view, (columns, rows), effort, "radiance")


def render_irradiance(
    scene: Scene,
    view: View,
    *,
    columns: int,
    rows: int,
    **keywords: Unpack[EffortKeywords],
) -> Rendering:
    """Trace a picture of the irradiance of the visible surfaces [W/m²], as rpict -i.

    Visible surfaces are those behind glass and dielectrics. Pixels that show the sky or
    a lamp are 0. The gather at the visible surface counts as the first bounce. See
    `render` for the parameters.
    """
    effort = effort_of(render_irradiance, keywords, default=_DEFAULT)
    require_gather(effort)
    return _picture(scene, view, (columns, rows), effort, "irradiance")


def _picture(
    scene: Scene, view: View, size: tuple[int, int], effort: Effort, quantity: Quantity
) -> Rendering:
    columns, rows = size
    message = f"a picture of {columns} × {rows} pixels; 1 to 2^26 expected"
    require(min(size) >= 1 and columns * rows <= 1 << 26, message)
    _check_light(scene)
    job = PictureJob(
        scene=scene,
        view=view,
        columns=columns,
        rows=rows,
        quantity=quantity,
        **effort.job_options(PICTURE_BATCHES),
    )
    lit = estimate_picture(job, effort)
    warn_if_short(lit, "picture", effort)
    picture = Picture(
        lit.value.reshape(rows, columns, -1).astype(np.float32),
        view=view,
        header=(f"SOFTWARE= clerestory {__version__}",),
        quantity=quantity,
        bands=scene.bands,
    )
    return Rendering(picture, lit.error.reshape(rows, columns, -1), lit.paths)


def irradiance(
    scene: Scene, sensors: Sensors, **keywords: Unpack[EffortKeywords]
) -> Gathered:
    """Trace the irradiance of sensors due to the sky and lamps of the scene [W/m²].

    `relative_error` applies to every sensor, relative to the irradiance of the sensor,
    or to 1 % of the mean irradiance if larger. See `render` for the other parameters.
    """
    effort = effort_of(irradiance, keywords, default=_DEFAULT)
    require_sensors(sensors, effort)
    _check_light(scene)
    job = IrradianceJob(scene=scene, sensors=sensors, **effort.job_options())
    lit = estimate_radiance(job, effort)
    warn_if_short(lit, "irradiance", effort)
    return Gathered(lit.value, lit.error, lit.photometric_error, lit.paths, scene.bands)


def _check_light(scene: Scene) -> None:
    shining = any(hasattr(each, "radiance") for each in scene.materials.values())
    require(shining, "the scene has no light source; a light, a glow or a sky expected")
    warn_of_unsampled_light(scene)
