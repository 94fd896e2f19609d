"""What traces will take, known before they are done.

A plan is an executor that takes note of the jobs it is handed and does none of them.
A trial of one job of each kind, about a second long, then tells how fast it is traced
where the work is to be done, and how many paths the error aimed at will take.
"""

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from clerestory.engine.device import Device
from clerestory.engine.estimate import GROWTH, PILOT, Sums
from clerestory.engine.lit import Batches
from clerestory.engine.work import Executor, Goal, Grain, Job, Unit

# Paths of a trial on each worker
_TRIAL = 1 << 19


@dataclass(frozen=True, eq=False)
class Noted:
    """A job and when it is done."""

    job: Job
    goal: Goal


@dataclass(frozen=True)
class Foreseen:
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
    # Time to prepare [s], paths a second, and the error's part: paths of a receiver
    # that reach the relative error of 1, as if error fell with the power of GROWTH
    preparation: float
    rate: float
    needed: float | None


class Plan:
    """Takes note of jobs and does none.

    Parameters
    ----------
    place : where the work is to be done
    """

    def __init__(self, place: Executor):
        self.place = place
        self.noted: list[Noted] = []

    def resolve(self, device: Device) -> Literal["cpu", "cuda"]:
        """Return the device that the work is to be done on."""
        return self.place.resolve(device)

    def accepts(self, job: Job, goal: Goal) -> bool:
        """Return False: take note of the job, and leave it."""
        self.noted.append(Noted(job, goal))
        return False

    def grain(self, device: Literal["cpu", "cuda"]) -> Grain:
        """Return how large units will be."""
        return self.place.grain(device)

    def workers(self) -> int:
        """Return how many units will be done at once."""
        return self.place.workers()

    def map(self, job: Job, units: Iterable[Unit]) -> Iterator[np.ndarray]:
        """Yield nothing: no job is accepted."""
        return iter(())


def foresee(plan: Plan) -> list[Foreseen]:
    """Return what each noted job will take, after one trial of each kind of job.

    The largest job of a kind is tried. Jobs of one kind take as long to prepare and
    trace as many paths a second, and need as many paths for each row.
    """
    trials: dict[type, _Trial] = {}
    for noted in sorted(plan.noted, key=lambda n: -n.job.receivers):
        kind = type(noted.job)
        if kind not in trials and noted.job.receivers:
            trials[kind] = _try(noted, plan.place)
    return [_foreseen(noted, trials.get(type(noted.job))) for noted in plan.noted]


def _foreseen(noted: Noted, trial: _Trial | None) -> Foreseen:
    job, goal = noted.job, noted.goal
    if trial is None:
        return Foreseen(0, 0.0)
    if goal.samples is not None:
        length = max(1, -(-goal.samples // job.batches))
    else:
        aim = goal.relative_error or 1.0
        length = max(PILOT, (trial.needed or 0.0) / aim**GROWTH)
    paths = round(length * job.batches * job.receivers)
    return Foreseen(paths, trial.preparation + paths / trial.rate)


def _try(noted: Noted, place: Executor) -> _Trial:
    # Twice the same: the first time builds the scene and compiles its kernels
    job, workers = noted.job, place.workers()
    unit = job.trial(_TRIAL)
    units = [unit] * workers
    start = time.perf_counter()
    sums = list(place.map(job, units)).pop()
    middle = time.perf_counter()
    list(place.map(job, units))
    seconds = time.perf_counter() - middle
    pairs = len(unit.rows) * (1 if unit.columns is None else len(unit.columns))
    paths = workers * pairs * unit.count * job.batches
    preparation = max(0.0, middle - start - seconds)
    return _Trial(preparation, paths / seconds, _needed(job, unit, sums))


def _needed(job: Job, unit: Unit, sums: np.ndarray) -> float | None:
    # Points of a batch at which the relative error would be one
    if hasattr(job, "error"):
        return unit.count * job.error(Batches(sums, unit.count)) ** GROWTH
    if hasattr(job, "unfinished"):
        count = np.full(len(unit.rows), unit.count)
        _, error = job.unfinished(Sums(sums, count), 1.0)
        return unit.count * error**GROWTH
    return None
