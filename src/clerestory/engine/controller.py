"""Control of Monte Carlo estimates: batches, work units, standard error, progress.

Every row is estimated by independent batches. Each batch has its own scrambled
low-discrepancy sequence; accuracy is increased by longer batches, not by more batches.
The standard error is computed from the variance of the batch means.

A job defines its matrix rows, their sums, and the relative error of sums. A controller
lengthens the batches until all samples are used or the target error is reached, divides
the tracing into work units, adds the sums of units in order, and reports progress.
"""

import time
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.engine.batch_lengths import BatchLengths, Growth
from clerestory.engine.derivative_sums import derivatives_of, joined, values_of
from clerestory.engine.effort import Effort
from clerestory.engine.sums import (
    PACKET,
    PACKET_SUMS,
    Estimate,
    Sums,
    estimated,
    sums_of_place,
)
from clerestory.engine.work_units import Job, Unit, UnitSize, evenly_spaced
from clerestory.matrix.derivatives import Derivatives, Parameter, pair_indices
from clerestory.progress import share_of_progress

# Largest number of consecutive sample points in one work unit
_LONGEST_RANGE = 1 << 16

# Largest size of sums in memory [bytes]. Convergence is tested per block of rows, so
# this number affects the result and must not depend on the machine
_SUMS = 1 << 29

# Number of rows of a pilot unit, unless convergence is tested for all rows together
_PILOT_ROWS = 64


@dataclass(frozen=True, eq=False, kw_only=True)
class EstimatedJob(Job):
    """A job with batches of increasing length, by default with fixed-point sums.

    `together` tells whether convergence is tested for all rows together. A fixed-point
    sum can hold 2^22 paths of weight π. `derivatives` are the parameters by which a
    matrix is differentiated. `cut` is the largest size of a unit; by default
    the executor chooses it: fixed-point sums do not depend on the division into units.
    """

    together: ClassVar[bool]
    growth: ClassVar[Growth] = Growth(pilot=32, longest=1 << 22, most=32)
    cut: ClassVar[UnitSize | None] = None
    derivatives: tuple[Parameter, ...] = ()

    @abstractmethod
    def error(self, sums: Sums) -> float | Float[np.ndarray, " row"]:
        """Return the relative standard error of each row, or one for all rows."""

    def empty_sums(self, rows: int) -> Sums:
        """Return zero sums for a number of rows."""
        return Sums.empty(np.uint64, (rows, *self.shape[1:]))

    def pilot_unit(self, paths: int) -> Unit:
        """Return a pilot unit of rows that are evenly distributed over the matrix."""
        rows, batches = self.shape[0], self.batches
        few = np.arange(rows) if self.together else evenly_spaced(rows, _PILOT_ROWS)
        count = int(np.clip(paths // (len(few) * batches), 1, _LONGEST_RANGE))
        return Unit(few, 0, count)

    def units(
        self, rows: Int[np.ndarray, " row"], first: int, end: int, size: UnitSize
    ) -> Iterator[Unit]:
        """Divide rows and a range of sample points into units of limited size."""
        # A fixed-point unit has few rows and many sample points, since it transfers its
        # sums once; a floating-point unit has all rows and few sample points
        together = 1 if self.cut is None else len(rows)
        points = size.paths // (self.batches * together)
        points = min(_LONGEST_RANGE, max(self.growth.pilot, points))
        rows_of_sums = size.sums // row_bytes(self)
        _, places, columns, channels = self.shape
        if channels >= PACKET and self.device == "cpu":
            of_row = places * columns * sums_of_place(channels)
            rows_of_sums = min(rows_of_sums, (PACKET_SUMS - PACKET) // of_row)
        for begin in range(first, end, points):
            count = min(end - begin, points)
            most = size.paths // (self.batches * count)
            most = max(1, min(most, rows_of_sums))
            for row in range(0, len(rows), most):
                yield Unit(rows[row : row + most], begin, count)


def estimate(job: EstimatedJob, effort: Effort) -> Estimate:
    """Estimate a matrix, one block of rows after another."""
    if not effort.executor.accepts(job, effort.goal):
        return _blank(job, effort)
    rows, _, columns, channels = job.shape
    # Blocks are copied one by one, so that the matrix is not held twice
    values = np.empty((channels, rows, columns))
    shape = job.batches, channels, rows, columns
    derivatives = []
    components = np.empty(shape, np.float32) if effort.components else None
    paths, reached = 0, True
    for part in row_blocks(job):
        first, share = part.start / rows, (part.stop - part.start) / rows
        progress = share_of_progress(effort.progress, first, share)
        block = estimate_rows(job, part, replace(effort, progress=progress))
        values[:, part] = block.values
        if components is not None:
            components[:, :, part] = block.components
        if block.derivatives is not None:
            derivatives.append(block.derivatives)
        paths, reached = paths + block.paths, reached and block.reached
    return Estimate(
        values, components, paths, reached, joined(derivatives) if derivatives else None
    )


def row_blocks(job: EstimatedJob) -> list[slice]:
    """Return the blocks of rows that are traced and tested for convergence together."""
    rows = job.shape[0]
    most = max(1, min(rows, _SUMS // row_bytes(job)))
    block = rows if job.together else most
    return [slice(n, min(rows, n + block)) for n in range(0, rows, block)]


def row_bytes(job: Job) -> int:
    """Return the size of the sums of one matrix row [bytes]."""
    _, batches, columns, channels = job.shape
    return max(1, batches * columns * channels * 8)


def estimate_rows(
    job: EstimatedJob, rows: slice, effort: Effort, *, few: int | None = None
) -> Estimate:
    """Estimate one block of rows (see `row_blocks`) independently of other blocks.

    `few` is a number of error components, a divisor of that of batches, which takes
    less memory. Longer batches may have one component each.
    """
    sums, reached = sum_rows(job, rows, effort, few=few)
    values = values_of(sums, job.batches) if job.derivatives else sums
    found = estimated(values, reached=reached, components=effort.components)
    if not job.derivatives:
        return found
    given = job.batches, job.derivatives
    derivatives = derivatives_of(sums, *given, components=effort.components)
    return replace(found, derivatives=derivatives)


def sum_rows(
    job: EstimatedJob, rows: slice, effort: Effort, *, few: int | None = None
) -> tuple[Sums, bool]:
    """Trace rows in growing batches up to the number of samples or the target error.

    Return the sums, and whether the target error was reached. See `estimate_rows`.
    """
    numbers = np.arange(rows.start, rows.stop)
    sums, active = job.empty_sums(len(numbers)), np.full(len(numbers), True)
    growth, merged = job.growth, job.batches // (few or job.batches)
    # Merged fixed-point sums hold as many paths as others
    fits = (effort.samples or 0) * merged <= job.batches * growth.longest
    if merged > 1 and fits and not job.derivatives:
        sums = Sums.merged((len(numbers), *job.shape[1:]), few or job.batches)
        growth = replace(growth, longest=growth.longest // merged)
    if effort.samples is not None:
        length = -(-effort.samples // job.batches)
        lengthen(job, numbers, sums, active, length, effort)
        return sums, True

    aim, spent = effort.relative_error or 1.0, 0.0
    lengths = BatchLengths.of(len(numbers), growth)
    while lengths.active.any():
        length, share = lengths.step(sums.count)
        share *= 1 - spent
        part = share_of_progress(effort.progress, spent, share)
        here = replace(effort, progress=part)
        lengthen(job, numbers, sums, lengths.active, length, here)
        lengths.update(length, np.asarray(job.error(sums) / aim))
        spent += share
    if effort.progress is not None:
        effort.progress(1.0, "done")
    return sums, bool(lengths.met.all())


def lengthen(
    job: EstimatedJob,
    numbers: Int[np.ndarray, " row"],
    sums: Sums,
    active: Bool[np.ndarray, " row"],
    length: int,
    effort: Effort,
) -> None:
    """Trace the batches of active rows, of equal lengths, up to `length` sample points.

    `numbers` are the consecutive indices of the rows of the sums.
    """
    todo = np.flatnonzero(active)
    size = job.cut or effort.executor.unit_size(job.device)
    units = list(job.units(numbers[todo], int(sums.count[todo[0]]), length, size))

    note = f"{job.batches * length:,} paths a row"
    for unit, part in traced_units(job, units, effort, note):
        sums.add(unit.rows - numbers[0], part, unit.columns)
    sums.count[todo] = length


def traced_units(
    job: Job, units: Sequence[Unit], effort: Effort, note: str
) -> Iterator[tuple[Unit, np.ndarray]]:
    """Trace units; yield each unit and its sums in order, and report progress."""
    begin, done = time.perf_counter(), 0
    work = sum(unit.paths(job.batches) for unit in units)
    for unit, part in zip(units, effort.executor.map(job, units), strict=True):
        yield unit, part
        done += unit.paths(job.batches)
        if effort.progress is not None:
            rate = done / (time.perf_counter() - begin) * 1e-6
            effort.progress(done / work, f"{note}, {rate:.1f} million a second")


def _blank(job: EstimatedJob, effort: Effort) -> Estimate:
    # Estimate of zeros in the shape of the matrix, which occupies hardly any memory
    rows, _, columns, channels = job.shape
    batches, count = job.batches, len(job.derivatives)
    entries, none = (channels, rows, columns), np.float32(0)
    values = np.broadcast_to(0.0, entries)
    components = np.broadcast_to(none, (batches, *entries))
    derivatives = Derivatives(
        job.derivatives,
        np.broadcast_to(0.0, (count, *entries)),
        np.broadcast_to(0.0, (len(pair_indices(count)), *entries)),
        np.broadcast_to(none, (batches, count, *entries)),
    )
    return Estimate(
        values, components if effort.components else None, 0, True,
        derivatives if count else None,
    )  # fmt: skip
