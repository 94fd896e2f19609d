"""Cost estimates of planned jobs from pilot runs.

A plan is an executor that records jobs without tracing them. One job of each kind is
then traced for about a second, to measure the time of preparation, the rate of paths,
and the number of paths required for the target error. A pilot run includes all steps of
the actual run: the given number of paths per row, means and deviations of the sums, and
a second job of the kind in the same scene.
"""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clerestory.engine.controller import CONVERGENCE, EstimatedJob, row_bytes
from clerestory.engine.device import Device, Processor
from clerestory.engine.sums import Sums, estimated
from clerestory.engine.work_units import (
    Executor,
    Goal,
    Job,
    Unit,
    UnitSize,
    evenly_spaced,
)

# Paths of a pilot run per worker, and largest size of its sums [bytes]
_PILOT_PATHS, _PILOT_BYTES = 1 << 19, 1 << 27


@dataclass(frozen=True, eq=False)
class PlannedJob:
    """A job and its goal."""

    job: Job
    goal: Goal


@dataclass(frozen=True)
class JobCost:
    """Estimated total number of paths and wall time [s] of a job."""

    paths: int
    seconds: float


@dataclass(frozen=True)
class _Rates:
    # Time to prepare the first job of a kind and further jobs in its scene [s], paths
    # per second, time per receiver in addition to its paths [s], and points per batch
    # for a relative error of 1
    preparation: float
    next_preparation: float
    paths: float
    receiver: float
    needed: float


class Plan:
    """An executor that records jobs without tracing them, for the executor `place`."""

    def __init__(self, place: Executor):
        self.place = place
        self.planned: list[PlannedJob] = []

    def resolve(self, device: Device) -> Processor:
        """Return the device of the actual run."""
        return self.place.resolve(device)

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Record the job; return False."""
        self.planned.append(PlannedJob(job, goal))
        return False

    def unit_size(self, device: Processor) -> UnitSize:
        """Return the limits of the size of units."""
        return self.place.unit_size(device)

    def workers(self) -> int:
        """Return the number of units traced in parallel."""
        return self.place.workers()

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield nothing: no job is accepted."""
        return iter(())


def estimate_costs(plan: Plan) -> list[JobCost]:
    """Return the cost of each planned job, after a pilot run of each kind of job.

    The pilot run traces the largest job of a kind, and the start of the next job in its
    scene. Jobs of one kind are assumed to have equal times of preparation, equal rates
    of paths, and equal numbers of paths per row.
    """
    kinds: dict[type, list[PlannedJob]] = {}
    for planned in sorted(plan.planned, key=lambda each: -each.job.receivers):
        if planned.job.receivers:
            kinds.setdefault(type(planned.job), []).append(planned)
    rates = {kind: _pilot_run(jobs, plan.place) for kind, jobs in kinds.items()}
    costs, built = [], None
    for planned in plan.planned:
        place = type(planned.job), planned.job.scene
        costs.append(_cost(planned, rates.get(place[0]), again=place == built))
        built = place
    return costs


def _cost(planned: PlannedJob, rates: _Rates | None, *, again: bool) -> JobCost:
    job, goal = planned.job, planned.goal
    if rates is None:
        return JobCost(0, 0.0)
    if goal.samples is not None or not isinstance(job, EstimatedJob):
        length: float = _length(planned)
    else:
        aim = goal.relative_error or 1.0
        length = max(job.growth.pilot, rates.needed / aim**CONVERGENCE)
    paths = round(length * job.batches * job.receivers)
    seconds = rates.next_preparation if again else rates.preparation
    seconds += paths / rates.paths + rates.receiver * job.receivers
    return JobCost(paths, seconds)


def _length(planned: PlannedJob) -> int:
    # Points per batch, if samples are given
    return max(1, -(-(planned.goal.samples or 1) // planned.job.batches))


def _pilot_run(kind: Sequence[PlannedJob], place: Executor) -> _Rates:
    # Run twice: the first run builds the scene and compiles its kernels
    planned, workers = kind[0], place.workers()
    job, unit = planned.job, _pilot_unit(planned)
    units = [unit] * workers
    first, _ = _timed(job, units, place)
    seconds, sums = _timed(job, units, place)
    paths = workers * unit.paths(job.batches)
    preparation = following = max(0.0, first - seconds)
    for other in [each for each in kind[1:] if each.job.scene is job.scene][:1]:
        taken, _ = _timed(other.job, [_pilot_unit(other)] * workers, place)
        following = min(preparation, max(0.0, taken - seconds))
    receiver, needed = _summed(job, unit, sums)
    return _Rates(preparation, following, paths / seconds, receiver, needed)


def _timed(
    job: Job, units: Sequence[Unit], place: Executor
) -> tuple[float, np.ndarray]:
    start = time.perf_counter()
    sums = list(place.map(job, units)).pop()
    return time.perf_counter() - start, sums


def _pilot_unit(planned: PlannedJob) -> Unit:
    # Unit with the number of paths per row of the actual run, if known
    job, unit = planned.job, planned.job.pilot_unit(_PILOT_PATHS)
    if not isinstance(job, EstimatedJob) or unit.columns is not None:
        return unit
    length = _length(planned)
    if job.cut or planned.goal.samples is None or unit.count <= length:
        return unit
    if job.together:
        return Unit(unit.rows, 0, length)
    rows = min(_PILOT_PATHS // (length * job.batches), _PILOT_BYTES // row_bytes(job))
    return Unit(evenly_spaced(job.shape[0], max(1, rows)), 0, length)


def _summed(job: Job, unit: Unit, part: np.ndarray) -> tuple[float, float]:
    # Time per row in addition to its paths, for addition, mean and deviations [s], and
    # points per batch for a relative error of 1
    if not isinstance(job, EstimatedJob) or unit.columns is not None:
        return 0.0, 0.0
    start = time.perf_counter()
    sums: Sums = job.empty_sums(len(unit.rows))
    sums.add(np.arange(len(unit.rows)), part)
    sums.count[:] = unit.count
    estimated(sums, reached=True, components=True)
    seconds = (time.perf_counter() - start) / len(unit.rows)
    error = float(np.max(job.error(sums)))
    return seconds, unit.count * error**CONVERGENCE
