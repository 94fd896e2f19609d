"""Cost estimates of planned jobs from pilot runs.

A plan is an executor that records jobs without tracing them. One job of each kind is
then traced for about a second, to measure the preparation time, the paths traced per
second, and the paths required for the target error. As in the actual run, the pilot run
traces the given number of paths per row, computes mean values and standard errors, and
prepares a second job of the kind in the same scene.
"""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clerestory.engine.batch_lengths import CONVERGENCE, needed_length
from clerestory.engine.controller import EstimatedJob, row_bytes
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

# Number of paths of a pilot run per worker, and largest size of the sums [bytes]
_PILOT_PATHS, _PILOT_BYTES = 1 << 19, 1 << 27


@dataclass(frozen=True, eq=False)
class PlannedJob:
    """A recorded job and its stopping criterion."""

    job: Job
    goal: Goal


@dataclass(frozen=True)
class JobCost:
    """Estimated total number of paths and wall time [s] of a job."""

    paths: int
    seconds: float


@dataclass(frozen=True)
class _Rates:
    # Preparation time of the first job of a kind, and of another job in the same scene
    # [s]; paths traced per second; time per receiver apart from tracing [s]; sample
    # points per batch for a relative error of 1, mean of the rows
    preparation: float
    next_preparation: float
    paths: float
    receiver: float
    needed: float


class Plan:
    """An executor that records jobs of the executor `place` without tracing them."""

    def __init__(self, place: Executor):
        self.place = place
        self.planned: list[PlannedJob] = []

    def resolve(self, device: Device) -> Processor:
        """Return the compute device of the actual run."""
        return self.place.resolve(device)

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Record the job, and return False: the job is not traced."""
        self.planned.append(PlannedJob(job, goal))
        return False

    def unit_size(self, device: Processor) -> UnitSize:
        """Return the largest size of a work unit of the actual run."""
        return self.place.unit_size(device)

    def workers(self) -> int:
        """Return the number of units traced in parallel."""
        return self.place.workers()

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield nothing: no job is accepted."""
        return iter(())


def estimate_costs(plan: Plan) -> list[JobCost]:
    """Return the cost of each planned job, after a pilot run of each kind of job.

    A pilot run traces one unit of the largest job of a kind, and one unit of another
    job in the same scene. Jobs of one kind are assumed to have equal preparation times,
    paths per second, and paths per row.
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
    # Number of sample points per batch, if the number of samples is given
    return max(1, -(-(planned.goal.samples or 1) // planned.job.batches))


def _pilot_run(kind: Sequence[PlannedJob], place: Executor) -> _Rates:
    # Trace the unit twice: only the first run builds the scene and compiles kernels
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
    # Pilot unit, with as many paths per row as the actual run if that number is known
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
    # Time per row apart from tracing, to add sums and compute mean and standard error
    # [s]; sample points per batch for a relative error of 1
    if not isinstance(job, EstimatedJob) or unit.columns is not None:
        return 0.0, 0.0
    start = time.perf_counter()
    sums: Sums = job.empty_sums(len(unit.rows))
    sums.add(np.arange(len(unit.rows)), part)
    sums.count[:] = unit.count
    estimated(sums, reached=True, components=True)
    seconds = (time.perf_counter() - start) / len(unit.rows)
    needed = needed_length(unit.count, np.asarray(job.error(sums)))
    return seconds, float(np.mean(needed))
