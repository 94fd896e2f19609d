"""Jobs for pictures and sensors at one instant: rounds, batches and their errors.

Every pixel or sensor is estimated by independent batches, each along its own
scrambled sequence; their spread gives the standard error. More accuracy lengthens
the sequences. What shines has no largest radiance, so sums are floating-point; they
are added in the order of their units, whoever traced them.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

import numpy as np
from jaxtyping import Float

from clerestory.engine.controller import GROWTH
from clerestory.engine.effort import Effort
from clerestory.engine.work_units import Job, Unit
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

# Independent batches of a picture's pixel, and of a sensor.
PICTURE_BATCHES, SENSOR_BATCHES = 8, 16

# Most paths in one unit, fewest points of a batch in it, most points of a batch.
_PATHS = 1 << 21
_SHORTEST = 8
_LONGEST = 1 << 20

# Sample points of a batch in the first round, when an error is aimed at.
_PILOT = 8

# Rows darker than this share of the mean need not reach the relative error.
_DARK = 0.01


@dataclass(frozen=True, eq=False)
class RadianceEstimate:
    """Light that was gathered.

    Attributes
    ----------
    value : radiance of pixels or irradiance of sensors
    error : standard error of each
    paths : traced in all
    reached : whether the relative error aimed at was reached
    """

    value: Float[np.ndarray, "row band"]
    error: Float[np.ndarray, "row band"]
    paths: int
    reached: bool


@dataclass
class Batches:
    """Sums over the sample points of each batch."""

    total: Float[np.ndarray, "batch row band"]
    count: int = 0

    def mean(self) -> Float[np.ndarray, "row band"]:
        """Mean over all batches."""
        mean: np.ndarray = self.total.mean(axis=0) / self.count
        return mean

    def error(self) -> Float[np.ndarray, "row band"]:
        """Standard error of the mean."""
        spread: np.ndarray = self.total.std(axis=0, ddof=1)
        return spread / (self.count * math.sqrt(len(self.total)))


class RadianceJob(Job, Protocol):
    """A job whose rows are lights that are gathered.

    Attributes
    ----------
    batches : independent estimates of each row
    """

    batches: ClassVar[int]

    @property
    def receivers(self) -> int:
        """Number of rows."""

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of some rows."""

    def error(self, values: Batches) -> float:
        """Return the error that is to be reached, relative."""


@dataclass(frozen=True, eq=False)
class PictureJob:
    """Radiance of a view's pixels, or irradiance, row by row from the top."""

    tracer: ClassVar[tuple[str, str]] = ("radiance_tracers", "prepare_picture")
    batches: ClassVar[int] = PICTURE_BATCHES

    scene: Scene
    view: View
    columns: int
    rows: int
    bounces: int | None
    seed: int
    device: Literal["cpu", "cuda"]
    quantity: Literal["radiance", "irradiance"] = "radiance"

    @property
    def receivers(self) -> int:
        """Pixels of the picture."""
        return self.columns * self.rows

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of the middle of the picture."""
        return middle_unit(self.receivers, self.batches, paths)

    def error(self, values: Batches) -> float:
        """Return the error of the mean pixel, relative."""
        mean, deviation = values.mean(), values.error()
        return float(np.sqrt(np.mean(deviation**2)) / max(mean.mean(), 1e-30))


@dataclass(frozen=True, eq=False)
class IrradianceJob:
    """Irradiance of sensors."""

    tracer: ClassVar[tuple[str, str]] = ("radiance_tracers", "prepare_irradiance")
    batches: ClassVar[int] = SENSOR_BATCHES

    scene: Scene
    sensors: Sensors
    bounces: int | None
    seed: int
    device: Literal["cpu", "cuda"]

    @property
    def receivers(self) -> int:
        """Number of sensors."""
        return len(self.sensors)

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of some sensors."""
        return middle_unit(self.receivers, self.batches, paths)

    def error(self, values: Batches) -> float:
        """Return the relative error of the worst sensor."""
        mean, deviation = values.mean(), values.error()
        floor = np.maximum(mean, _DARK * mean.mean())
        return float(np.max(deviation / np.where(floor > 0, floor, 1), initial=0.0))


def trace_picture(
    scene: Scene,
    view: View,
    columns: int,
    rows: int,
    effort: Effort,
    *,
    quantity: Literal["radiance", "irradiance"],
) -> RadianceEstimate:
    """Return the radiance of a view's pixels, row by row from the top.

    The relative error is that of the mean pixel: the root mean square of the standard
    errors over the mean radiance.

    Parameters
    ----------
    quantity : radiance, or the irradiance of the surface that a pixel shows
    """
    walk = effort.bounces, effort.seed, effort.resolved_device()
    job = PictureJob(scene, view, columns, rows, *walk, quantity)
    return estimate_radiance(job, effort)


def trace_irradiance(
    scene: Scene, sensors: Sensors, effort: Effort
) -> RadianceEstimate:
    """Return the irradiance of sensors; every one reaches the relative error."""
    job = IrradianceJob(
        scene, sensors, effort.bounces, effort.seed, effort.resolved_device()
    )
    return estimate_radiance(job, effort)


def estimate_radiance(job: RadianceJob, effort: Effort) -> RadianceEstimate:
    """Trace a job until its samples are taken or its error is reached."""
    batches, shape = job.batches, (job.receivers, len(job.scene.bands))
    if not effort.executor.accepts(job, effort.goal):
        return RadianceEstimate(np.zeros(shape), np.zeros(shape), 0, True)
    sums = Batches(np.zeros((batches, *shape)))
    length = _PILOT
    if effort.samples is not None:
        length = max(1, -(-effort.samples // batches))
    start, share = 0.0, 1.0 if effort.samples is not None else 0.05
    while True:
        _lengthen(job, sums, length, effort, start, share)
        if effort.samples is not None:
            reached = True
            break
        ratio = job.error(sums) / (effort.relative_error or 1.0)
        reached = ratio <= 1
        if reached or length >= _LONGEST:
            break
        growth = float(np.clip(ratio**GROWTH, 2, 16))
        start, share = start + share, (1 - start - share) * 0.8
        length = min(int(length * 2 ** np.ceil(np.log2(growth))), _LONGEST)
    if effort.progress:
        effort.progress(1.0, "done")
    return RadianceEstimate(
        sums.mean(), sums.error(), job.receivers * batches * sums.count, reached
    )


def middle_unit(rows: int, batches: int, paths: int) -> Unit:
    """Return a unit of the middle of a job."""
    # Consecutive rows, a good part of them, or all with many samples
    block = max(1, min(rows, paths // (batches * _SHORTEST)))
    first = (rows - block) // 2
    count = int(np.clip(paths // (batches * block), 1, _LONGEST))
    return Unit(np.arange(first, first + block), 0, count)


def _lengthen(
    job: Job, sums: Batches, length: int, effort: Effort, start: float, share: float
) -> None:
    # Bring every batch to `length` sample points, unit by unit
    batches, rows, _ = sums.total.shape
    units = list(_units(rows, batches, sums.count, length))
    work, done = rows * (length - sums.count), 0
    for unit, part in zip(units, effort.executor.map(job, units), strict=True):
        sums.total[:, unit.rows] += part
        done += len(unit.rows) * unit.count
        if effort.progress:
            note = f"{length * batches} samples"
            effort.progress(start + share * done / work, note)
    sums.count = length


def _units(rows: int, batches: int, have: int, length: int) -> Iterator[Unit]:
    # Many rows or many points each; the cut must not depend on the machine
    while have < length:
        count = min(length - have, max(_SHORTEST, _PATHS // (batches * rows)))
        block = max(1, _PATHS // (batches * count))
        for first in range(0, rows, block):
            yield Unit(np.arange(first, min(first + block, rows)), have, count)
        have += count
