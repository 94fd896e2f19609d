"""Matrices by Monte Carlo: how many paths, in which launches, with which error.

Every row of a matrix is estimated by sixteen independent batches. A batch walks
along its own scrambled sequence of sample points; more accuracy means longer
batches, never more of them. Their spread is the standard error.

A launch is one unit of work: some rows, all batches, one stretch of the sequence.
It is pure: what it adds depends on its rows, its stretch and the seed alone.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Bool, Float, Int, UInt64

from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.patches import SkyTable
from clerestory.engine.points import points
from clerestory.engine.starts import lanes, trace_sensors, trace_window_patches
from clerestory.engine.upload import launching
from clerestory.engine.walk import FIXED_POINT, Target
from clerestory.engine.windows import window_shapes
from clerestory.errors import DeviceError
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

BATCHES = 16

# Sample points of a batch in the first round, when an error is aimed at.
_PILOT = 32

# Longest stretch of the sequence in one launch, and most paths in one launch.
_STRETCH = 1 << 16
_PATHS = 1 << 22

# The error falls nearly like n to the power of -1/1.6 with the points of a batch.
_GROWTH = 1.6

# Most sample points of one batch: an aim that needs more is out of reach. A sum of
# as many weights of π still fits into its fixed-point number.
_LONGEST = 1 << 22

# Most sums held at a time [bytes]; the host holds as much again.
_SUMS = 1 << 29

# Rows darker than this share of the mean row need not reach the relative error.
_DARK = 0.01

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Effort:
    """How long to trace.

    Attributes
    ----------
    samples : paths per row; None to aim at an error
    relative_error : standard error to reach, relative; see the tracing functions
    bounces : most diffuse reflections or gathers, as Radiance's -ab; None: no limit
    seed : any whole number; the same seed gives the same result
    progress : called with the share done and a note
    batches : independent estimates of each row
    components : whether the batches' deviations are kept, as error components
    """

    samples: int | None = None
    relative_error: float | None = None
    bounces: int | None = None
    seed: int = 0
    progress: Progress | None = None
    batches: int = BATCHES
    components: bool = True


@dataclass(frozen=True, eq=False)
class Estimate:
    """A traced matrix.

    Attributes
    ----------
    values : mean over the batches
    components : error components; the sum of their squares is the variance; None if
        they are not kept
    paths : traced in all
    reached : whether the relative error aimed at was reached in all rows
    """

    values: Float[np.ndarray, "channel row column"]
    components: Float[np.ndarray, "component channel row column"] | None
    paths: int
    reached: bool


Launch = Callable[[Target, "np.ndarray", int, int], None]
Unfinished = Callable[["Sums"], tuple[np.ndarray, float]]


@dataclass
class Sums:
    """Fixed-point sums of some rows, and how many points each batch has seen."""

    total: UInt64[np.ndarray, "row batch column channel"]
    count: Int[np.ndarray, " row"]

    def means(self) -> Float[np.ndarray, "row batch column channel"]:
        """Mean weight of each batch's paths."""
        return self.total / (FIXED_POINT * self.count[:, None, None, None])


def trace_view(
    scene: Scene, windows: tuple[Window, ...], sensors: Sensors, effort: Effort
) -> Estimate:
    """Trace from sensors to the patches of all windows (columns: window by window).

    The relative error of a row is that of the irradiance [W/m²] under windows of
    uniform radiance; every row goes on until it reaches it.
    """
    origin = np.mean(sensors.position, axis=0)
    model = lower(scene, origin=origin, receivers=windows)
    target = matrix_target(model, None, model.windows.columns)
    return _from_sensors(target, sensors, origin, effort)


def trace_coefficients(
    scene: Scene, sky: SkyPartition, sensors: Sensors, effort: Effort
) -> Estimate:
    """Trace from sensors to the patches of the sky.

    The relative error of a row is that of the irradiance under a uniform sky.
    """
    origin = np.mean(sensors.position, axis=0)
    target = matrix_target(lower(scene, origin=origin), SkyTable.of(sky), len(sky))
    return _from_sensors(target, sensors, origin, effort)


def trace_daylight(
    scene: Scene, window: Window, sky: SkyPartition, effort: Effort
) -> Estimate:
    """Trace from the outer side of a window's patches to the patches of the sky.

    The relative error is the root mean square, over the sky's patches, of the error
    of the window's irradiance from one patch, relative to the mean patch: it holds
    for a sun that stands in any patch, not only for a uniform sky.
    """
    origin = np.mean([p.vertices.mean(axis=0) for p in window.polygons], axis=0)
    model = lower(scene, origin=origin)
    table, _ = window_shapes((window,), origin)
    segments = _segments(effort.bounces, first=1)
    projected = window.partition.projected_solid_angles()
    units = {"batches": effort.batches, "seed": effort.seed}

    def launch(target: Target, rows: np.ndarray, first: int, count: int) -> None:
        sequence = points(first, count)
        paths = lanes(sequence, rows=rows, stream=1, **units)
        trace_window_patches(target, sequence, paths, window=table, segments=segments)

    def noisy(sums: Sums) -> tuple[np.ndarray, float]:
        irradiance = np.einsum("r,rbcx->bcx", projected, sums.means())
        error = np.sqrt(np.mean(variance(irradiance, axis=0)))
        mean = float(np.mean(irradiance))
        ratio = error / (effort.relative_error * mean) if mean > 0 else 0.0
        return np.full(len(sums.count), ratio > 1), float(ratio)

    target = matrix_target(model, SkyTable.of(sky), len(sky))
    return estimate(launch, target, len(window.partition), effort, noisy, together=True)


def _from_sensors(
    target: Target, sensors: Sensors, origin: Float[np.ndarray, "3"], effort: Effort
) -> Estimate:
    position = sensors.position - origin
    segments = _segments(effort.bounces, first=0)
    units = {"batches": effort.batches, "seed": effort.seed}

    def launch(target: Target, rows: np.ndarray, first: int, count: int) -> None:
        sequence = points(first, count)
        paths = lanes(sequence, rows=rows, stream=0, **units)
        start = {"position": position[rows], "normal": sensors.direction[rows]}
        trace_sensors(target, sequence, paths, **start, segments=segments)

    return estimate(launch, target, len(position), effort, _dim_rows(effort))


def _segments(bounces: int | None, *, first: int) -> int:
    # Radiance counts an irradiance sensor's own gather as a bounce, a sample ray not
    return (1 << 30) if bounces is None else bounces + first


def matrix_target(model: LoweredScene, sky: SkyTable | None, columns: int) -> Target:
    """Return the target of a matrix's paths; each launch gives it its sums."""
    return Target(model, sky, mi.UInt64(), columns, 1 if model.grey else 3)


def variance(values: np.ndarray, *, axis: int) -> np.ndarray:
    """Variance of the mean of independent batches."""
    return np.var(values, axis=axis, ddof=1) / values.shape[axis]


def _dim_rows(effort: Effort) -> Unfinished:
    def noisy(sums: Sums) -> tuple[np.ndarray, float]:
        irradiance = sums.means().sum(axis=2)
        mean = irradiance.mean(axis=1)
        error = np.sqrt(variance(irradiance, axis=1))
        floor = np.maximum(mean, _DARK * mean.mean())
        share = np.max(error / np.where(floor > 0, floor, 1), axis=-1)
        ratio = share / effort.relative_error
        return ratio > 1, float(ratio.max(initial=0.0))

    return noisy


def estimate(
    launch: Launch,
    target: Target,
    rows: int,
    effort: Effort,
    unfinished: Unfinished,
    *,
    together: bool = False,
) -> Estimate:
    """Trace block after block of rows, each to its end.

    Parameters
    ----------
    launch : traces some rows along a stretch of the sequence
    rows : of the matrix
    unfinished : which rows need more paths, and how far the worst is from its aim
    together : whether all rows are judged as one
    """
    row_bytes = effort.batches * target.columns * target.channels * 8
    block = rows if together else max(1, min(rows, _SUMS // row_bytes))
    values, components, paths, reached = [], [], 0, True
    for first in range(0, rows, block):
        numbers = np.arange(first, min(rows, first + block))
        progress = _share_of_progress(
            effort.progress, first / rows, len(numbers) / rows
        )
        sums, good = _trace_rows(launch, target, numbers, effort, unfinished, progress)
        means = sums.means()
        mean = means.mean(axis=1)
        values.append(np.moveaxis(mean, -1, 0))
        if effort.components:
            batches = effort.batches
            spread = (means - mean[:, None]) / np.sqrt(batches * (batches - 1))
            components.append(np.moveaxis(spread, (1, 3), (0, 1)).astype(np.float32))
        paths += int(sums.count.sum()) * effort.batches
        reached &= good
    return Estimate(
        np.concatenate(values, axis=1),
        np.concatenate(components, axis=2) if components else None,
        paths,
        reached,
    )


def _share_of_progress(
    progress: Progress | None, start: float, share: float
) -> Progress:
    if progress is None:
        return lambda done, note: None
    return lambda done, note: progress(start + share * done, note)


def _trace_rows(
    launch: Launch,
    target: Target,
    numbers: Int[np.ndarray, " row"],
    effort: Effort,
    unfinished: Unfinished,
    progress: Progress,
) -> tuple[Sums, bool]:
    # Lengthen the batches until the samples are spent or the error is reached
    shape = (len(numbers), effort.batches, target.columns, target.channels)
    sums = Sums(
        np.zeros(shape, dtype=np.uint64), np.zeros(len(numbers), dtype=np.int64)
    )
    if effort.samples is not None:
        length = -(-effort.samples // effort.batches)
        everything = np.full(len(numbers), True)
        _lengthen(launch, target, numbers, sums, everything, length, progress)
        return sums, True

    # The pilot takes a sliver of the progress bar, the rest is shared by expected work
    active, length, spent, share = np.full(len(numbers), True), _PILOT, 0.0, 0.02
    while active.any():
        if length > _LONGEST:
            return sums, False
        part = _share_of_progress(progress, spent, share)
        _lengthen(launch, target, numbers, sums, active, length, part)
        spent += share
        active, ratio = unfinished(sums)
        growth = np.clip(ratio**_GROWTH, 2, 32)
        share = (1 - spent) * 0.9 * min(1.0, growth / max(ratio**_GROWTH, 1e-9))
        length *= int(2 ** np.ceil(np.log2(growth)))
    progress(1.0, "done")
    return sums, True


def _lengthen(
    launch: Launch,
    target: Target,
    numbers: Int[np.ndarray, " row"],
    sums: Sums,
    active: Bool[np.ndarray, " row"],
    length: int,
    progress: Progress,
) -> None:
    # Bring the batches of the active rows to `length` points, launch by launch
    todo = np.flatnonzero(active)
    have = int(sums.count[todo[0]])
    batches = sums.total.shape[1]
    row_bytes = batches * target.columns * target.channels * 8
    work, done, start_time = len(todo) * (length - have), 0, time.perf_counter()
    while have < length:
        count = min(length - have, _STRETCH)
        rows_at_once = max(1, min(_PATHS // (batches * count), _SUMS // row_bytes))
        for start in range(0, len(todo), rows_at_once):
            rows = todo[start : start + rows_at_once]
            part = _launch(launch, target, numbers[rows], have, count, batches)
            sums.total[rows] += part
            done += len(rows) * count
            rate = batches * done / (time.perf_counter() - start_time) * 1e-6
            note = f"{batches * length:,} paths a row, {rate:.1f} million a second"
            progress(done / work, note)
        have += count
        sums.count[todo] = have


def _launch(
    launch: Launch,
    target: Target,
    rows: Int[np.ndarray, " row"],
    first: int,
    count: int,
    batches: int,
) -> UInt64[np.ndarray, "row batch column channel"]:
    # Run one unit of work and fetch what it scored
    size = len(rows) * batches * target.columns * target.channels
    target.sums = dr.zeros(mi.UInt64, size + 1)
    with launching():
        launch(target, rows, first, count)
        added = target.sums.numpy()
    if added[-1]:
        raise DeviceError(
            f"{added[-1]} paths carry more than a path can: a fault of the tracer"
        )
    return added[:-1].reshape(len(rows), batches, target.columns, target.channels)
