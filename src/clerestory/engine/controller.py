"""Matrices by Monte Carlo: how many paths, in which launches, with which error.

Every row of a matrix is estimated by sixteen independent batches. A batch walks
along its own scrambled sequence of sample points; more accuracy means longer
batches, never more of them. Their spread is the standard error.

A unit of work is some rows, all batches, one stretch of the sequence. Its sums are
exact whole numbers, so neither the cut into units nor their order changes a bit of
the result; after each round the sums decide which rows go on.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar, Literal, final

import numpy as np
from jaxtyping import Bool, Int

from clerestory.engine.effort import Effort
from clerestory.engine.sums import Estimate, Sums, estimated
from clerestory.engine.work_units import Unit, UnitSize, evenly_spaced
from clerestory.progress import share_of_progress
from clerestory.scene.model import Scene

# Sample points of a batch in the first round, when an error is aimed at.
PILOT = 32

# Longest stretch of the sequence in one unit.
_STRETCH = 1 << 16

# The error falls nearly like n to the power of -1/1.6 with the points of a batch.
GROWTH = 1.6

# Most sample points of one batch: an aim that needs more is out of reach. A sum of
# as many weights of π still fits into its fixed-point number.
_LONGEST = 1 << 22

# Most sums held at a time [bytes]. Rows are judged block by block, so this number is
# part of the result: it must not depend on the machine.
_SUMS = 1 << 29

# Rows that a trial takes, unless all are judged as one
_TRIAL_ROWS = 64


class MatrixJob(ABC):
    """A job whose units return sums of weights in fixed point; see `Job`.

    Attributes
    ----------
    together : whether all rows are judged as one
    """

    tracer: ClassVar[tuple[str, str]]
    together: ClassVar[bool]

    scene: Scene
    batches: int
    device: Literal["cpu", "cuda"]

    @property
    @abstractmethod
    def shape(self) -> tuple[int, int, int, int]:
        """Rows, batches, columns and channels of the whole matrix."""

    @property
    @final
    def receivers(self) -> int:
        """Rows of the matrix."""
        return self.shape[0]

    @final
    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of rows spread over the matrix."""
        rows, batches, _, _ = self.shape
        few = np.arange(rows) if self.together else evenly_spaced(rows, _TRIAL_ROWS)
        return Unit(few, 0, int(np.clip(paths // (len(few) * batches), 1, _STRETCH)))

    @abstractmethod
    def unfinished(self, sums: "Sums", aim: float) -> tuple[np.ndarray, float]:
        """Return which rows need more paths for a relative error, and the worst ratio.

        The ratio is how many times the error aimed at remains.
        """


def variance(values: np.ndarray, *, axis: int) -> np.ndarray:
    """Variance of the mean of independent batches."""
    of_batches: np.ndarray = np.var(values, axis=axis, ddof=1)
    mean: np.ndarray = of_batches / values.shape[axis]
    return mean


def all_or_none(
    sums: Sums, error: float, mean: float, aim: float
) -> tuple[np.ndarray, float]:
    """Return the judgement of rows that go on until the error of all is reached."""
    ratio = error / (aim * mean) if mean > 0 else 0.0
    return np.full(len(sums.count), ratio > 1), ratio


def estimate(job: MatrixJob, effort: Effort) -> Estimate:
    """Trace block after block of rows, each to its end."""
    if not effort.executor.accepts(job, effort.goal):
        return _blank(job, effort)
    whole = job.shape[0]
    blocks = [
        estimate_rows(job, rows, _part_of_progress(effort, rows, whole))
        for rows in row_blocks(job)
    ]
    kept = [b.components for b in blocks if b.components is not None]
    return Estimate(
        np.concatenate([block.values for block in blocks], axis=1),
        np.concatenate(kept, axis=2) if kept else None,
        sum(block.paths for block in blocks),
        all(block.reached for block in blocks),
    )


def row_blocks(job: MatrixJob) -> list[slice]:
    """Return the blocks of rows that are traced and judged together, in order."""
    rows = job.shape[0]
    most = max(1, min(rows, _SUMS // row_bytes(job)))
    block = rows if job.together else most
    return [slice(n, min(rows, n + block)) for n in range(0, rows, block)]


def estimate_rows(job: MatrixJob, rows: slice, effort: Effort) -> Estimate:
    """Trace one of the blocks of `row_blocks` to its end.

    What it returns is the same to the bit whether other blocks are traced or not.
    """
    sums, reached = _trace_rows(job, np.arange(rows.start, rows.stop), effort)
    return estimated(sums, reached=reached, components=effort.components)


def _part_of_progress(effort: Effort, rows: slice, whole: int) -> Effort:
    size = rows.stop - rows.start
    part = share_of_progress(effort.progress, rows.start / whole, size / whole)
    return replace(effort, progress=part)


def _blank(job: MatrixJob, effort: Effort) -> Estimate:
    # The right shape, without any memory
    rows, batches, columns, channels = job.shape
    values = np.broadcast_to(0.0, (channels, rows, columns))
    none = np.float32(0)
    components = np.broadcast_to(none, (batches, channels, rows, columns))
    return Estimate(values, components if effort.components else None, 0, True)


def row_bytes(job: MatrixJob) -> int:
    """Return what the sums of one row take [bytes]."""
    _, batches, columns, channels = job.shape
    return batches * columns * channels * 8


def _trace_rows(
    job: MatrixJob, numbers: Int[np.ndarray, " row"], effort: Effort
) -> tuple[Sums, bool]:
    # Lengthen the batches until the samples are spent or the error is reached
    sums = Sums.none((len(numbers), *job.shape[1:]))
    if effort.samples is not None:
        length = -(-effort.samples // job.batches)
        everything = np.full(len(numbers), True)
        _lengthen(job, numbers, sums, everything, length, effort)
        return sums, True

    # The pilot takes a sliver of the progress bar, the rest is shared by expected work
    active, length, spent, share = np.full(len(numbers), True), PILOT, 0.0, 0.02
    while active.any():
        if length > _LONGEST:
            return sums, False
        part = share_of_progress(effort.progress, spent, share)
        _lengthen(job, numbers, sums, active, length, replace(effort, progress=part))
        spent += share
        active, ratio = job.unfinished(sums, effort.relative_error or 1.0)
        growth = np.clip(ratio**GROWTH, 2, 32)
        share = (1 - spent) * 0.9 * min(1.0, growth / max(ratio**GROWTH, 1e-9))
        length *= int(2 ** np.ceil(np.log2(growth)))
    if effort.progress is not None:
        effort.progress(1.0, "done")
    return sums, True


def _lengthen(
    job: MatrixJob,
    numbers: Int[np.ndarray, " row"],
    sums: Sums,
    active: Bool[np.ndarray, " row"],
    length: int,
    effort: Effort,
) -> None:
    # Bring the batches of the active rows to `length` points, unit by unit
    todo = np.flatnonzero(active)
    have, batches = int(sums.count[todo[0]]), job.batches
    unit_size = effort.executor.unit_size(job.device)
    units = list(_units(job, numbers[todo], have, length, unit_size))
    work, done, start_time = len(todo) * (length - have), 0, time.perf_counter()
    for unit, part in zip(units, effort.executor.map(job, units), strict=True):
        sums.add(unit.rows - numbers[0], part)
        done += len(unit.rows) * unit.count
        rate = batches * done / (time.perf_counter() - start_time) * 1e-6
        note = f"{batches * length:,} paths a row, {rate:.1f} million a second"
        if effort.progress is not None:
            effort.progress(done / work, note)
    sums.count[todo] = length


def _units(
    job: MatrixJob,
    rows: Int[np.ndarray, " row"],
    have: int,
    length: int,
    unit_size: UnitSize,
) -> Iterator[Unit]:
    batches = job.shape[1]
    stretch = min(_STRETCH, max(PILOT, unit_size.paths // batches))
    for first in range(have, length, stretch):
        count = min(length - first, stretch)
        most = min(
            unit_size.paths // (batches * count), unit_size.sums // row_bytes(job)
        )
        for start in range(0, len(rows), max(1, most)):
            yield Unit(rows[start : start + max(1, most)], first, count)
