"""Launches of matrices: what traces the units of V, F, D and C on the device.

Each function takes a job, lowers its scene once, and returns what traces its units.
Sums leave the device once, when a unit is done.
"""

from collections.abc import Callable
from functools import lru_cache

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, UInt64

from clerestory.engine.controller import EstimatedJob
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.matrix_jobs import (
    CoefficientsJob,
    DaylightJob,
    FacadeJob,
    ViewJob,
)
from clerestory.engine.origin import middle_of_window, window_origin
from clerestory.engine.patches import SkyTable
from clerestory.engine.primary_rays import (
    Lanes,
    lanes,
    trace_sensors,
    trace_window_patches,
)
from clerestory.engine.sampler import Points, points
from clerestory.engine.upload import launching
from clerestory.engine.walk import Target
from clerestory.engine.windows import window_shapes
from clerestory.engine.work_units import Tracer, Unit
from clerestory.errors import DeviceError

# Streams of random numbers: errors of V and D must not agree
_SENSORS, _WINDOWS = 0, 1

# Nor may those of F and D, which both start at patches of windows
_FACADE_SEED = 0x5FACADE5

Launch = Callable[[Target, Points, Lanes, Unit], None]


def prepare_view(job: ViewJob) -> Tracer:
    """Return what traces from sensors to windows."""
    origin = np.mean(job.sensors.position, axis=0)
    model = lower(job.scene, origin=origin, receivers=job.windows)
    return _from_sensors(job, model, None, origin)


def prepare_coefficients(job: CoefficientsJob) -> Tracer:
    """Return what traces from sensors to the sky."""
    origin = np.mean(job.sensors.position, axis=0)
    return _from_sensors(
        job, lower(job.scene, origin=origin), SkyTable.of(job.sky), origin
    )


def prepare_daylight(job: DaylightJob) -> Tracer:
    """Return what traces from a window to the sky."""
    origin = window_origin(job.scene, job.window)
    model = lower(job.scene, origin=origin)
    target = Target(model, SkyTable.of(job.sky), mi.UInt64(), *job.shape[2:])
    return _from_window(job, target, job.seed, origin)


def prepare_facade(job: FacadeJob) -> Tracer:
    """Return what traces from a window to ports before it."""
    origin = middle_of_window(job.window)
    model = lower(job.scene, origin=origin, receivers=job.ports)
    target = Target(model, None, mi.UInt64(), *job.shape[2:])
    return _from_window(job, target, job.seed ^ _FACADE_SEED, origin)


def _from_window(
    job: DaylightJob | FacadeJob,
    target: Target,
    seed: int,
    origin: Float[np.ndarray, "3"],
) -> Tracer:
    table, _ = window_shapes((job.window,), origin)
    segments = _segments(job.bounces, first=1)

    def launch(target: Target, sequence: Points, paths: Lanes, _unit: Unit) -> None:
        trace_window_patches(target, sequence, paths, window=table, segments=segments)

    return matrix_tracer(job, target, launch, stream=_WINDOWS, seed=seed)


def _from_sensors(
    job: ViewJob | CoefficientsJob,
    model: LoweredScene,
    sky: SkyTable | None,
    origin: Float[np.ndarray, "3"],
) -> Tracer:
    position, normal = job.sensors.position - origin, job.sensors.direction
    segments = _segments(job.bounces, first=0)

    def launch(target: Target, sequence: Points, paths: Lanes, unit: Unit) -> None:
        start = {"position": position[unit.rows], "normal": normal[unit.rows]}
        trace_sensors(target, sequence, paths, **start, segments=segments)

    target = Target(model, sky, mi.UInt64(), *job.shape[2:])
    return matrix_tracer(job, target, launch, stream=_SENSORS)


def _segments(bounces: int | None, *, first: int) -> int:
    # Radiance counts an irradiance sensor's own gather as a bounce, a sample ray not
    return (1 << 30) if bounces is None else bounces + first


def matrix_tracer(
    job: EstimatedJob,
    target: Target,
    launch: Launch,
    *,
    stream: int,
    seed: int | None = None,
) -> Tracer:
    """Return what traces units of a matrix and fetches what they scored.

    Parameters
    ----------
    launch : traces the paths of a unit into the target
    stream : of random numbers
    seed : that of the job by default
    """
    _, batches, columns, channels = job.shape
    start = job.seed if seed is None else seed
    stretch = lru_cache(maxsize=1)(points)

    def trace(unit: Unit) -> UInt64[np.ndarray, "row batch column channel"]:
        size = len(unit.rows) * batches * columns * channels
        target.sums = dr.zeros(mi.UInt64, size + 1)
        with launching():
            sequence = stretch(unit.first, unit.count)
            paths = lanes(
                sequence, rows=unit.rows, batches=batches, seed=start, stream=stream
            )
            launch(target, sequence, paths, unit)
            added = target.sums.numpy()
        target.sums = mi.UInt64()
        if added[0]:
            raise DeviceError(
                f"{added[0]} paths carry more than a path can: a fault of the tracer"
            )
        return added[1:].reshape(len(unit.rows), batches, columns, channels)

    return trace
