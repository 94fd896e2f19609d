"""Pictures and irradiance at one moment, by path tracing.

The scene contains surfaces, lamps, and sky and sun as sources at infinity, as in the
output of `gensky` and `gendaylit`. Every pixel and sensor has a standard error.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Unpack

import numpy as np
from jaxtyping import Float

from clerestory import __version__
from clerestory.bands import RGB, Bands
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.engine.adaptive_pixels import estimate_picture, estimated_rounds
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.pixel_goals import PixelGoal, RelativePixelError
from clerestory.engine.radiance_jobs import (
    PICTURE_BATCHES,
    IrradianceJob,
    PictureJob,
    RadianceEstimate,
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
    goal: PixelGoal | None = None,
    **keywords: Unpack[EffortKeywords],
) -> Rendering:
    """Trace a picture.

    Parameters
    ----------
    scene : surfaces and light sources
    view : camera; pixels outside its projection are black
    columns, rows : size of the picture; see `View.size_for`
    samples : number of paths per pixel
    goal : instead of samples: a target such as `DgpError(0.01)`; paths are distributed
        over the pixels such that it is reached with few paths
    relative_error : instead of both: target RMS of the pixels' standard errors,
        relative to the mean pixel value; 0.02 if none is given
    bounces : maximum number of diffuse reflections, as Radiance -ab; default unlimited
    seed : random seed ≥ 0; same seed and device, bitwise identical results
    device : "auto" selects a GPU if one is available
    executor : executor of the tracing jobs, such as a `Cluster`; default: local
    progress : callback with the completed fraction (0…1) and a status text

    Raises
    ------
    InputError : two of samples, relative_error and goal given, a number out of range,
        or a view that does not suit the goal
    DeviceError : no usable compute device
    """
    effort = _effort(render, keywords, goal)
    return _Task.of(scene, view, (columns, rows), effort, goal).last()


def render_progressively(
    scene: Scene,
    view: View,
    *,
    columns: int,
    rows: int,
    goal: PixelGoal | None = None,
    **keywords: Unpack[EffortKeywords],
) -> Iterator[Rendering]:
    """Trace a picture and yield it after each round, from coarse to fine.

    In the first pictures, one pixel stands for a block of 8 × 8, 4 × 4 and 2 × 2. Each
    of the following ones has about twice as many paths as the one before. The last
    picture is bitwise that of `render` with the same arguments.
    """
    effort = _effort(render_progressively, keywords, goal)
    return _Task.of(scene, view, (columns, rows), effort, goal).rounds()


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
    task = _Task.of(scene, view, (columns, rows), effort, quantity="irradiance")
    return task.last()


@dataclass(frozen=True, eq=False)
class _Task:
    """Job of a picture, with effort and target; no target if samples are given."""

    job: PictureJob
    effort: Effort
    goal: PixelGoal | None

    @classmethod
    def of(
        cls,
        scene: Scene,
        view: View,
        size: tuple[int, int],
        effort: Effort,
        goal: PixelGoal | None = None,
        quantity: Quantity = "radiance",
    ) -> "_Task":
        """Check the picture, and return its task."""
        columns, rows = size
        message = f"a picture of {columns} × {rows} pixels; 1 to 2^26 expected"
        require(min(size) >= 1 and columns * rows <= 1 << 26, message)
        _check_light(scene)
        if goal is not None:
            goal.check_view(view, columns, rows)
        elif effort.relative_error is not None:
            goal = RelativePixelError(effort.relative_error)
        job = PictureJob(
            scene=scene,
            view=view,
            columns=columns,
            rows=rows,
            quantity=quantity,
            **effort.job_options(PICTURE_BATCHES),
        )
        return cls(job, effort, goal)

    def rounds(self) -> Iterator[Rendering]:
        """Yield the picture after each round."""
        for lit in estimated_rounds(self.job, self.effort, self.goal):
            yield self._picture(lit)
        self._warn(lit)

    def last(self) -> Rendering:
        """Return the picture after the last round."""
        lit = estimate_picture(self.job, self.effort, self.goal)
        self._warn(lit)
        return self._picture(lit)

    def _picture(self, lit: RadianceEstimate) -> Rendering:
        job = self.job
        picture = Picture(
            lit.value.reshape(job.rows, job.columns, -1).astype(np.float32),
            view=job.view,
            header=(f"SOFTWARE= clerestory {__version__}",),
            quantity=job.quantity,
            bands=job.scene.bands,
        )
        return Rendering(picture, lit.error.reshape(picture.radiance.shape), lit.paths)

    def _warn(self, lit: RadianceEstimate) -> None:
        if self.goal is not None:
            what = self.goal.name
            warn_if_short(lit, "picture", self.effort, target=what, depth=5)


def _effort(
    function: Callable[..., object], keywords: EffortKeywords, goal: PixelGoal | None
) -> Effort:
    # Effort of a picture, with the default if there is no other target
    none = Goal(samples=None)
    effort = effort_of(function, keywords, default=none if goal else _DEFAULT)
    require(
        goal is None or effort.goal == none,
        "a goal and samples or relative_error given; one of them expected",
    )
    return effort


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
