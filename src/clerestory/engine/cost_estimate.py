"""What traces will take, known before they are done.

A plan is an executor that takes note of the jobs it is handed and does none of them.
A trial of one job of each kind, about a second long, then tells how fast it is traced
where the work is to be done, and how many paths the error aimed at will take. It does
what the run will do: as many paths a row where their number is given, sums brought to
means and deviations, and another job of the kind that takes over the scene.
"""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from clerestory.engine.controller import GROWTH, PILOT, row_bytes
from clerestory.engine.device import Device
from clerestory.engine.radiance_jobs import Batches
from clerestory.engine.sums import Sums, estimated
from clerestory.engine.work_units import (
    Executor,
    Goal,
    Job,
    Unit,
    UnitSize,
    evenly_spaced,
)

# Paths of a trial on each worker, and what it returns at most [bytes]
_TRIAL, _SUMS = 1 << 19, 1 << 27


@dataclass(frozen=True, eq=False)
class PlannedJob:
    """A job and when it is done."""

    job: Job
    goal: Goal


@dataclass(frozen=True)
class JobCost:
    """What a job will take.

    Attributes
    ----------
    paths : in all
    seconds : from the clock
    """

    paths: int
    seconds: float


@dataclass(frozen=True)
class _Trial:
    # Time to prepare a first job and the next ones in its scene [s], paths a second,
    # time of a receiver beside its paths [s], and the error's part: paths of a receiver
    # that reach the relative error of 1, as if error fell with the power of GROWTH
    preparation: float
    next_preparation: float
    rate: float
    beside: float
    needed: float | None


class Plan:
    """Takes note of jobs and does none.

    Parameters
    ----------
    place : where the work is to be done
    """

    def __init__(self, place: Executor):
        self.place = place
        self.noted: list[PlannedJob] = []

    def resolve(self, device: Device) -> Literal["cpu", "cuda"]:
        """Return the device that the work is to be done on."""
        return self.place.resolve(device)

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return False: take note of the job, and leave it."""
        self.noted.append(PlannedJob(job, goal))
        return False

    def unit_size(self, device: Literal["cpu", "cuda"]) -> UnitSize:
        """Return how large units will be."""
        return self.place.unit_size(device)

    def workers(self) -> int:
        """Return how many units will be done at once."""
        return self.place.workers()

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield nothing: no job is accepted."""
        return iter(())


def estimate_costs(plan: Plan) -> list[JobCost]:
    """Return what each noted job will take, after a trial of each kind of job.

    The largest job of a kind is tried, and the start of the next one in its scene. Jobs
    of one kind take as long to prepare and trace as many paths a second, and need as
    many paths for each row.
    """
    kinds: dict[type, list[PlannedJob]] = {}
    for noted in sorted(plan.noted, key=lambda n: -n.job.receivers):
        if noted.job.receivers:
            kinds.setdefault(type(noted.job), []).append(noted)
    trials = {kind: _try(jobs, plan.place) for kind, jobs in kinds.items()}
    found, built = [], None
    for noted in plan.noted:
        place = type(noted.job), noted.job.scene
        found.append(_foreseen(noted, trials.get(place[0]), again=place == built))
        built = place
    return found


def _foreseen(noted: PlannedJob, trial: _Trial | None, *, again: bool) -> JobCost:
    job, goal = noted.job, noted.goal
    if trial is None:
        return JobCost(0, 0.0)
    if goal.samples is not None:
        length: float = _length(noted)
    else:
        aim = goal.relative_error or 1.0
        length = max(PILOT, (trial.needed or 0.0) / aim**GROWTH)
    paths = round(length * job.batches * job.receivers)
    seconds = trial.next_preparation if again else trial.preparation
    seconds += paths / trial.rate + trial.beside * job.receivers
    return JobCost(paths, seconds)


def _length(noted: PlannedJob) -> int:
    # Points of a batch, where samples are given
    return max(1, -(-(noted.goal.samples or 1) // noted.job.batches))


def _try(kind: Sequence[PlannedJob], place: Executor) -> _Trial:
    # Twice the same: the first time builds the scene and compiles its kernels
    noted, workers = kind[0], place.workers()
    job, unit = noted.job, _like_all(noted)
    units = [unit] * workers
    first, _ = _timed(job, units, place)
    seconds, sums = _timed(job, units, place)
    pairs = len(unit.rows) * (1 if unit.columns is None else len(unit.columns))
    paths = workers * pairs * unit.count * job.batches
    preparation = following = max(0.0, first - seconds)
    for other in [n for n in kind[1:] if n.job.scene is job.scene][:1]:
        taken, _ = _timed(other.job, [_like_all(other)] * workers, place)
        following = min(preparation, max(0.0, taken - seconds))
    return _Trial(
        preparation,
        following,
        paths / seconds,
        _beside(job, unit, sums),
        _needed(job, unit, sums),
    )


def _timed(
    job: Job, units: Sequence[Unit], place: Executor
) -> tuple[float, np.ndarray]:
    start = time.perf_counter()
    sums = list(place.map(job, units)).pop()
    return time.perf_counter() - start, sums


def _like_all(noted: PlannedJob) -> Unit:
    # A unit of as many paths a row as the run will trace, where that is known
    job, unit = noted.job, noted.job.pilot_unit(_TRIAL)
    shape = getattr(job, "shape", None)
    if shape is None or noted.goal.samples is None or unit.count <= _length(noted):
        return unit
    length = _length(noted)
    if job.together:
        return Unit(unit.rows, 0, length)
    rows = min(_TRIAL // (length * job.batches), _SUMS // row_bytes(job))
    return Unit(evenly_spaced(shape[0], max(1, rows)), 0, length)


def _beside(job: Job, unit: Unit, part: np.ndarray) -> float:
    # Time that a row of a matrix takes to be added, and for its mean and deviations
    if not hasattr(job, "unfinished"):
        return 0.0
    start = time.perf_counter()
    sums = Sums.none((len(unit.rows), *job.shape[1:]))
    sums.add(np.arange(len(unit.rows)), part)
    sums.count[:] = unit.count
    estimated(sums, reached=True, components=True)
    return (time.perf_counter() - start) / len(unit.rows)


def _needed(job: Job, unit: Unit, sums: np.ndarray) -> float | None:
    # Points of a batch at which the relative error would be one
    if hasattr(job, "error"):
        return unit.count * job.error(Batches(sums, unit.count)) ** GROWTH
    if hasattr(job, "unfinished"):
        count = np.full(len(unit.rows), unit.count)
        _, error = job.unfinished(Sums(sums, count), 1.0)
        return unit.count * error**GROWTH
    return None
