"""Cost estimates of planned jobs from pilot runs.

A plan is an executor that records the jobs it is given and traces none. One job of each
kind is then traced for about a second, which gives the time of preparation, the rate of
paths, and the number of paths that the relative error aimed at needs. A pilot run does
what the run will do: as many paths a row where their number is given, means and
deviations of its sums, and another job of the kind in the same scene.
"""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from clerestory.engine.controller import CONVERGENCE, EstimatedJob, row_bytes
from clerestory.engine.device import Device
from clerestory.engine.sums import Sums, estimated
from clerestory.engine.work_units import (
    Executor,
    Goal,
    Job,
    Unit,
    UnitSize,
    evenly_spaced,
)

# Paths of a pilot run on each worker, and most bytes of its sums
_PILOT_PATHS, _PILOT_BYTES = 1 << 19, 1 << 27


@dataclass(frozen=True, eq=False)
class PlannedJob:
    """A job and when it is done."""

    job: Job
    goal: Goal


@dataclass(frozen=True)
class JobCost:
    """Estimated cost of a job.

    Attributes
    ----------
    paths : in all
    seconds : of wall time
    """

    paths: int
    seconds: float


@dataclass(frozen=True)
class _Rates:
    # Time to prepare the first job of a kind and the next ones in its scene [s], paths
    # a second, time of a receiver beside its paths [s], and points of a batch at which
    # the relative error would be 1
    preparation: float
    next_preparation: float
    paths: float
    receiver: float
    needed: float


class Plan:
    """An executor that records jobs and traces none.

    Parameters
    ----------
    place : where the work is to be done
    """

    def __init__(self, place: Executor):
        self.place = place
        self.planned: list[PlannedJob] = []

    def resolve(self, device: Device) -> Literal["cpu", "cuda"]:
        """Return the device that the work is to be done on."""
        return self.place.resolve(device)

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Record the job; return False."""
        self.planned.append(PlannedJob(job, goal))
        return False

    def unit_size(self, device: Literal["cpu", "cuda"]) -> UnitSize:
        """Return the limits of the size of units."""
        return self.place.unit_size(device)

    def workers(self) -> int:
        """Return how many units will be traced at once."""
        return self.place.workers()

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield nothing: no job is accepted."""
        return iter(())


def estimate_costs(plan: Plan) -> list[JobCost]:
    """Return the cost of each planned job, after a pilot run of each kind of job.

    The largest job of a kind is run, and the start of the next one in its scene. Jobs
    of one kind are assumed to take as long to prepare, to trace as many paths a second,
    and to need as many paths for each row.
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
    # Points of a batch, where samples are given
    return max(1, -(-(planned.goal.samples or 1) // planned.job.batches))


def _pilot_run(kind: Sequence[PlannedJob], place: Executor) -> _Rates:
    # Twice the same: the first time builds the scene and compiles its kernels
    planned, workers = kind[0], place.workers()
    job, unit = planned.job, _pilot_unit(planned)
    units = [unit] * workers
    first, _ = _timed(job, units, place)
    seconds, sums = _timed(job, units, place)
    pairs = len(unit.rows) * (1 if unit.columns is None else len(unit.columns))
    paths = workers * pairs * unit.count * job.batches
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
    # A unit of as many paths a row as the run will trace, where that is known
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
    # Time that a row takes beside its paths, to be added and for its mean and
    # deviations [s], and points of a batch at which the relative error would be 1
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
