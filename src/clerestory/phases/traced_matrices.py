"""Path tracing of view matrices, daylight matrices and daylight coefficients.

    V  sensors × interior patches     view_matrix
    D  exterior patches × sky         daylight_matrix
    C  sensors × sky                  daylight_coefficients (the two-phase method)

Coefficients are irradiance per unit radiance [sr] for sensors, and radiance per
unit radiance for window patches. `bounces` is counted as -ab of Radiance: the first
gather at a sensor is a bounce, the first ray from a window patch is not.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Literal, Unpack

import numpy as np

from clerestory.bands import Bands
from clerestory.checks import distinct, require
from clerestory.engine.controller import EstimatedJob, estimate
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.matrix_jobs import CoefficientsJob, DaylightJob, ViewJob
from clerestory.engine.radiance_jobs import RadianceEstimate
from clerestory.engine.sums import Estimate
from clerestory.engine.work_units import Goal
from clerestory.errors import ClerestoryWarning
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import Axis, sensor_axis, sky_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.progress import share_of_progress
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Names of materials by which a matrix is differentiated
Differentiated = Sequence[str] | Literal["all"]

# Default, if neither samples nor relative_error is given
_DEFAULT = Goal(samples=None, relative_error=0.01)


def view_matrix(
    scene: Scene,
    window: Window,
    *,
    sensors: Sensors,
    derivatives: Differentiated = (),
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """View matrix of one window: sensor irradiance per patch radiance [sr].

    Paths end at the window, which must not be part of the scene.

    Parameters
    ----------
    scene : room surfaces, without the window
    window : polygons whose front faces the room
    sensors : points and directions of irradiance sensors
    derivatives : names of materials of the scene, or "all", by whose reflectance or
        transmissivity the matrix is differentiated; see `TransferMatrix.derivatives`
    samples : number of paths per sensor
    relative_error : instead of samples: target standard error at every sensor, relative
        to its irradiance for a window of uniform radiance, or to 1 % of the mean over
        the sensors or 0.5 % of an unobstructed sensor's if that is larger
    bounces : maximum number of gathers, as Radiance -ab; default unlimited
    seed : random seed ≥ 0; same seed and device, bitwise identical results
    device : "auto" selects a GPU if one is available
    executor : executor of the tracing jobs, such as a `Cluster`; default: local.
        Results do not depend on the executor
    progress : callback with the completed fraction (0…1) and a status text

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range
    DeviceError : no usable compute device
    """
    effort = matrix_effort(view_matrix, keywords)
    found = view_matrices(
        scene, [window], sensors=sensors, derivatives=derivatives, effort=effort
    )
    return found[window.name]


def view_matrices(
    scene: Scene,
    windows: Sequence[Window],
    *,
    sensors: Sensors,
    derivatives: Differentiated = (),
    **keywords: Unpack[EffortKeywords],
) -> dict[str, TransferMatrix]:
    """View matrices of several windows, traced together, by window name.

    All matrices are estimated from the same paths, in the same batches. See
    `view_matrix` for the parameters.
    """
    effort = matrix_effort(view_matrices, keywords)
    job = view_job(scene, windows, sensors, effort, derivatives)
    rows, columns = sensors_axis(sensors), patch_axes(windows, "interior")
    return _traced(job, effort, "view matrix", rows, columns)


def view_job(
    scene: Scene,
    windows: Sequence[Window],
    sensors: Sensors,
    effort: Effort,
    derivatives: Differentiated = (),
) -> ViewJob:
    """Return the tracing job of view matrices."""
    require_distinct(windows)
    require_sensors(sensors, effort)
    return ViewJob(
        scene=scene,
        windows=tuple(windows),
        sensors=sensors,
        derivatives=material_parameters(scene, derivatives),
        **effort.job_options(),
    )


def daylight_matrix(
    scene: Scene,
    window: Window,
    *,
    subdivision: int = 4,
    derivatives: Differentiated = (),
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Daylight matrix of one window: window patch radiance per sky patch radiance.

    Each row sums to one if the window is exposed to sky and ground alone.

    Parameters
    ----------
    scene : exterior surfaces
    subdivision : MF of the Reinhart sky subdivision, 1…6
    samples : number of paths per window patch
    relative_error : instead of samples: target standard error of the window irradiance
        due to one sky patch (RMS over the patches), relative to the mean irradiance

    The other parameters are those of `view_matrix`.
    """
    effort = matrix_effort(daylight_matrix, keywords)
    sky = reinhart(subdivision)
    parameters = material_parameters(scene, derivatives)
    options = effort.job_options()
    job = DaylightJob(
        scene=scene, window=window, sky=sky, derivatives=parameters, **options
    )
    rows = window_axis("exterior", window.partition, window.name)
    what = f"daylight matrix of {window.name!r}"
    return _traced(job, effort, what, rows, {"": sky_axis(sky)})[""]


def daylight_matrices(
    scene: Scene,
    windows: Sequence[Window],
    *,
    subdivision: int = 4,
    derivatives: Differentiated = (),
    **keywords: Unpack[EffortKeywords],
) -> dict[str, TransferMatrix]:
    """Daylight matrices of several windows by window name; see `daylight_matrix`.

    One acceleration structure is used for all windows within 128 m of the scene centre.
    """
    require_distinct(windows)
    effort = matrix_effort(daylight_matrices, keywords)
    found, share = {}, 1 / len(windows)
    for number, window in enumerate(windows):
        progress = share_of_progress(
            effort.progress, number * share, share, window.name
        )
        own = replace(effort, seed=effort.seed + number, progress=progress)
        found[window.name] = daylight_matrix(
            scene, window, subdivision=subdivision, derivatives=derivatives, effort=own
        )
    return found


def daylight_coefficients(
    scene: Scene,
    *,
    sensors: Sensors,
    subdivision: int = 4,
    derivatives: Differentiated = (),
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Daylight coefficients: irradiance of sensors per radiance of sky patches [sr].

    Each row sums to π if the sensor is exposed to sky and ground alone.
    `relative_error` applies to the irradiance under a uniform sky. See `view_matrix`
    for the parameters.
    """
    effort = matrix_effort(daylight_coefficients, keywords)
    require_sensors(sensors, effort)
    sky = reinhart(subdivision)
    options = effort.job_options()
    parameters = material_parameters(scene, derivatives)
    job = CoefficientsJob(
        scene=scene, sky=sky, sensors=sensors, derivatives=parameters, **options
    )
    rows, columns = sensors_axis(sensors), {"": sky_axis(sky)}
    return _traced(job, effort, "daylight coefficients", rows, columns)[""]


def matrix_effort(function: Callable[..., object], keywords: EffortKeywords) -> Effort:
    """Return the checked sampling parameters for tracing matrices."""
    return effort_of(function, keywords, default=_DEFAULT)


def require_distinct(windows: Sequence[Window]) -> None:
    """Require at least one window, and distinct window names."""
    require(windows, "no window given; at least one expected")
    distinct((window.name for window in windows), "windows")


def require_sensors(sensors: Sensors, effort: Effort) -> None:
    """Require at least one sensor and one bounce."""
    require_gather(effort)
    require(len(sensors), "no sensors given; at least one expected")


def require_gather(effort: Effort) -> None:
    """Require at least one bounce, without which irradiance is zero."""
    require(
        effort.bounces != 0,
        "bounces is 0; 1 or more expected, as the gather at the receiver is a bounce",
    )


def sensors_axis(sensors: Sensors) -> Axis:
    """Return the axis of irradiance sensors."""
    return sensor_axis(len(sensors), sensors.names)


def patch_axes(
    windows: Sequence[Window], side: Literal["interior", "exterior"]
) -> dict[str, Axis]:
    """Return the axis of the patches of each window, by window name."""
    return {w.name: window_axis(side, w.partition, w.name) for w in windows}


def _traced(
    job: EstimatedJob,
    effort: Effort,
    what: str,
    rows: Axis,
    columns: Mapping[str, Axis],
) -> dict[str, TransferMatrix]:
    estimated = estimate(job, effort)
    warn_if_short(estimated, what, effort, depth=4)
    return split_columns(estimated, rows, columns, job.scene.bands)


def split_columns(
    estimated: Estimate, rows: Axis, columns: Mapping[str, Axis], bands: Bands
) -> dict[str, TransferMatrix]:
    """Split the columns of an estimate into matrices, one for each column axis."""
    found, first = {}, 0
    for name, axis in columns.items():
        part = slice(first, first + axis.size)
        values, components = estimated.values[:, :, part], estimated.components
        if components is not None:
            components = components[:, :, :, part]
        if estimated.paths:
            # Not in a dry run, where a copy of the blank matrix would take memory
            values = np.ascontiguousarray(values)
            if components is not None:
                components = np.ascontiguousarray(components)
        derivatives = estimated.derivatives and estimated.derivatives.columns(part)
        found[name] = TransferMatrix(values, rows, axis, components, bands, derivatives)
        first = part.stop
    return found


def warn_if_short(
    traced: Estimate | RadianceEstimate,
    what: str,
    effort: Effort,
    *,
    target: str | None = None,
    depth: int = 3,
) -> None:
    """Warn if tracing ended before the target was reached, the relative error if None.

    `depth` is the level of the call stack to which the warning is attributed.
    """
    if not traced.reached:
        warnings.warn(
            f"{what}: {target or f'the relative error {effort.relative_error}'} was not"
            " reached"
            f" after {traced.paths:,} paths; look at the standard errors",
            ClerestoryWarning,
            stacklevel=depth,
        )
