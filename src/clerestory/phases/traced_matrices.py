"""Traced transfer matrices: view, daylight, daylight coefficients.

    V  sensors × interior patches     view_matrix
    D  exterior patches × sky         daylight_matrix
    C  sensors × sky                  daylight_coefficients (the two-phase method)

Coefficients are irradiance per unit radiance [sr] for sensors, and radiance per
unit radiance for window patches. `bounces` counts like Radiance's -ab for the same
job: for an irradiance sensor the first gather is one, for a window patch the first
ray is none.
"""

import warnings
from collections.abc import Callable, Sequence
from typing import Any, TypedDict, Unpack

import numpy as np

from clerestory.bands import Bands
from clerestory.engine.controller import Effort, Estimate
from clerestory.engine.device import Device
from clerestory.engine.matrix_jobs import trace_coefficients, trace_daylight, trace_view
from clerestory.engine.work_units import Executor, Local
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import Axis, sensor_axis, sky_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

Progress = Callable[[float, str], None]

# Used when neither samples nor an error is asked for.
DEFAULT_RELATIVE_ERROR = 0.01


class Tracing(TypedDict, total=False):
    """Keywords of all functions that trace; see `view_matrix` for what they mean.

    Attributes
    ----------
    samples : paths per row; none by default
    relative_error : instead of samples: standard error to reach
    bounces : most reflections; no limit by default
    seed : whole number ≥ 0; 0 by default
    device : "auto" by default
    executor : where the work is done; this process by default
    progress : called with the share done, 0…1, and a note
    """

    samples: int | None
    relative_error: float | None
    bounces: int | None
    seed: int
    device: Device
    executor: Executor | None
    progress: Progress | None


def view_matrix(
    scene: Scene,
    window: Window,
    *,
    sensors: Sensors,
    **tracing: Unpack[Tracing],
) -> TransferMatrix:
    """View matrix of one window: irradiance of sensors per radiance of patches [sr].

    The window itself ends the paths; it must not be part of the scene.

    Parameters
    ----------
    scene : what light meets on its way from the window to the sensors
    window : polygons whose front faces the room
    sensors : points and directions of irradiance sensors
    samples : paths per sensor
    relative_error : instead of samples: standard error to reach at every sensor,
        relative to its irradiance under a window of uniform radiance; sensors
        darker than 1 % of the mean are judged as if they had that much
    bounces : most gathers, as Radiance's -ab; no limit by default
    seed : whole number ≥ 0; the same seed on the same device gives the same bits
    device : "auto" takes a GPU if there is one
    executor : where the work is done, such as a `Cluster`; this process by default.
        It changes no bit of the result
    progress : called with the share done, 0…1, and a note

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range
    DeviceError : no usable device
    """
    return view_matrices(scene, [window], sensors=sensors, **tracing)[window.name]


def view_matrices(
    scene: Scene,
    windows: Sequence[Window],
    *,
    sensors: Sensors,
    **tracing: Unpack[Tracing],
) -> dict[str, TransferMatrix]:
    """View matrices of several windows, traced at once, by window name.

    The windows share their paths: component k of all of them comes from batch k.
    See `view_matrix` for the parameters.
    """
    require_distinct(windows)
    rows = _sensor_rows(sensors, tracing.get("bounces"))
    effort = matrix_effort(**tracing)
    estimate = trace_view(scene, tuple(windows), sensors, effort)
    found, first = {}, 0
    for window in windows:
        columns = window_axis("interior", window.partition, window.name)
        part = slice(first, first + columns.size)
        found[window.name] = traced_matrix(estimate, rows, columns, part, scene.bands)
        first += columns.size
    warn_if_short(estimate, "view matrix", effort)
    return found


def daylight_matrix(
    scene: Scene,
    window: Window,
    *,
    subdivision: int = 4,
    **tracing: Unpack[Tracing],
) -> TransferMatrix:
    """Daylight matrix of one window: radiance of its patches per radiance of the sky's.

    Rows of a window that sees nothing but sky and ground sum to one.

    Parameters
    ----------
    scene : what light meets on its way from the sky to the window
    subdivision : Reinhart's MF of the sky, 1…6
    samples : paths per window patch
    relative_error : instead of samples: standard error to reach for the window's
        irradiance from one sky patch, as root mean square over the sky, relative to
        the mean patch

    The other parameters are those of `view_matrix`.
    """
    effort = matrix_effort(**tracing)
    sky = reinhart(subdivision)
    estimate = trace_daylight(scene, window, sky, effort)
    warn_if_short(estimate, f"daylight matrix of {window.name!r}", effort)
    rows = window_axis("exterior", window.partition, window.name)
    return traced_matrix(estimate, rows, sky_axis(sky), slice(None), scene.bands)


def daylight_matrices(
    scene: Scene,
    windows: Sequence[Window],
    *,
    subdivision: int = 4,
    **tracing: Unpack[Tracing],
) -> dict[str, TransferMatrix]:
    """Daylight matrices of several windows by window name; see `daylight_matrix`.

    The scene is built once for all windows less than 128 m from its middle.
    """
    require_distinct(windows)
    tracing["executor"] = tracing.get("executor") or Local()
    found = {}
    seed, progress = tracing.get("seed", 0), tracing.get("progress")
    for number, window in enumerate(windows):
        tracing["seed"] = seed + number
        tracing["progress"] = _part(progress, number, len(windows), window.name)
        found[window.name] = daylight_matrix(
            scene, window, subdivision=subdivision, **tracing
        )
    return found


def daylight_coefficients(
    scene: Scene,
    *,
    sensors: Sensors,
    subdivision: int = 4,
    **tracing: Unpack[Tracing],
) -> TransferMatrix:
    """Daylight coefficients: irradiance of sensors per radiance of sky patches [sr].

    A sensor that sees nothing but sky and ground collects π in all. The error aimed
    at is that of the irradiance under a uniform sky. See `view_matrix`.
    """
    rows = _sensor_rows(sensors, tracing.get("bounces"))
    effort = matrix_effort(**tracing)
    sky = reinhart(subdivision)
    estimate = trace_coefficients(scene, sky, sensors, effort)
    warn_if_short(estimate, "daylight coefficients", effort)
    return traced_matrix(estimate, rows, sky_axis(sky), slice(None), scene.bands)


def matrix_effort(
    *, default_error: float = DEFAULT_RELATIVE_ERROR, **tracing: Unpack[Tracing]
) -> Effort:
    """Check how long to trace, and find the device that it is done on.

    Parameters
    ----------
    default_error : relative error to reach where neither it nor samples are given

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range
    """
    samples, relative_error = tracing.get("samples"), tracing.get("relative_error")
    bounces, seed = tracing.get("bounces"), tracing.get("seed", 0)
    if samples is not None and relative_error is not None:
        raise InputError("both samples and relative_error given; one of them expected")
    if samples is not None and not 1 <= samples <= 1 << 26:
        raise InputError(f"samples = {samples}; a whole number from 1 to 2^26 expected")
    if samples is None and relative_error is None:
        relative_error = default_error
    if relative_error is not None and not 1e-5 <= relative_error < 1:
        raise InputError(f"relative_error = {relative_error}; 0.00001 to 1 expected")
    if bounces is not None and bounces < 0:
        raise InputError(f"bounces = {bounces}; 0 or more expected")
    if not 0 <= seed < 1 << 32:
        raise InputError(f"seed = {seed}; a whole number from 0 to 2^32 - 1 expected")
    executor = tracing.get("executor") or Local()
    return Effort(
        samples=samples,
        relative_error=relative_error,
        bounces=bounces,
        seed=seed,
        progress=tracing.get("progress"),
        device=executor.resolve(tracing.get("device", "auto")),
        executor=executor,
    )


def require_distinct(windows: Sequence[Window]) -> None:
    """Refuse windows of the same name, or none at all.

    Raises
    ------
    InputError : names the first that comes twice
    """
    names = [window.name for window in windows]
    if not names:
        raise InputError("no window given; at least one expected")
    double = sorted({name for name in names if names.count(name) > 1})
    if double:
        raise InputError(
            f"several windows are named {double[0]!r}; a name each expected"
        )


def require_sensors(sensors: Sensors, bounces: int | None) -> None:
    """Refuse no sensors at all, or none that gather any light.

    Raises
    ------
    InputError : says which
    """
    if bounces == 0:
        raise InputError(
            "bounces = 0; the first gather of a sensor counts: 1 or more expected"
        )
    if len(sensors.position) == 0:
        raise InputError("no sensors given; at least one expected")


def _sensor_rows(sensors: Sensors, bounces: int | None) -> Axis:
    require_sensors(sensors, bounces)
    return sensor_axis(len(sensors.position), sensors.names)


def traced_matrix(
    estimate: Estimate, rows: Axis, columns: Axis, part: slice, bands: Bands
) -> TransferMatrix:
    """Return some columns of what was traced, with their axes and bands."""
    values, components = estimate.values[:, :, part], estimate.components[:, :, :, part]
    if estimate.paths:
        # What a plan leaves blank takes no memory
        values, components = map(np.ascontiguousarray, (values, components))
    return TransferMatrix(values, rows, columns, components, bands)


def warn_if_short(estimate: Any, what: str, effort: Effort) -> None:
    """Warn when a trace ended before it reached the error aimed at."""
    if not estimate.reached:
        warnings.warn(
            f"{what}: the relative error {effort.relative_error} was not reached"
            f" after {estimate.paths:,} paths; look at the standard errors",
            ClerestoryWarning,
            stacklevel=3,
        )


def _part(
    progress: Progress | None, number: int, count: int, name: str
) -> Progress | None:
    if progress is None:
        return None
    return lambda done, note: progress((number + done) / count, f"{name}: {note}")
