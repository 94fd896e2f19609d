"""Adaptive sampling of the pixels of a picture, in rounds.

The first round traces a few paths for every pixel, from coarse to fine. For a target
error, all pixels are then sampled equally until the number of paths that the target
needs can be predicted (pilot run); further paths are distributed by the estimated
errors (`pixel_allocation`) until the target is reached. The division into rounds
depends on sums alone, so pictures are bitwise equal for any number of workers.
"""

import math
from collections import deque
from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Int

from clerestory.engine.controller import lengthen
from clerestory.engine.effort import Effort
from clerestory.engine.pixel_allocation import Allocation
from clerestory.engine.pixel_goals import PixelEstimates, PixelGoal
from clerestory.engine.radiance_jobs import (
    PictureJob,
    RadianceEstimate,
    black,
    radiance_of,
)
from clerestory.engine.sums import Sums
from clerestory.progress import share_of_progress

# Edges of the blocks of pixels in the first round, of which one pixel is traced
BLOCKS = (8, 4, 2, 1)

# The pilot run has at most this number of sample points per batch, and is at least this
# share of the predicted paths
_LONGEST_PILOT, _PILOT_SHARE = 32, 1 / 16

# Ratio of error to target above which paths are added after the predicted ones, as for
# matrices, and number of paths expected before anything is known, per path of the first
# round
_TOLERANCE, _EXPECTED = 1.1, 50.0

# Safety factor on the predicted error
_MARGIN = 1.15


@dataclass(frozen=True, eq=False)
class Round:
    """Sums after a round of tracing.

    `block` is the edge of the square blocks of which at least one pixel has been traced
    [pixels]; `reached` tells whether the samples are used, or the target is reached.
    """

    sums: Sums
    block: int
    reached: bool


def traced_rounds(
    job: PictureJob, effort: Effort, goal: PixelGoal | None
) -> Iterator[Round]:
    """Trace a picture; yield the same sums, extended, after each round.

    The last round reaches the goal, or has the samples of the effort.
    """
    pilot, samples = job.growth.pilot, effort.samples
    length = pilot if goal else -(-(samples or 1) // job.batches)
    first = min(pilot, length)
    expected = first * _EXPECTED if goal else float(length)
    pixels = _Pixels(job, effort, expected * job.receivers)
    for block in BLOCKS:
        pixels.extend(_coarse(job, block), first)
        complete = goal is None and block == 1 and first == length
        yield Round(pixels.sums, block, complete)
    if goal is not None:
        yield from _until(pixels, goal)
    while first < length:
        first = min(2 * first, length)
        pixels.extend(pixels.every, first)
        yield Round(pixels.sums, 1, first == length)


def estimate_picture(
    job: PictureJob, effort: Effort, goal: PixelGoal | None
) -> RadianceEstimate:
    """Return the picture after the last round; see `estimated_rounds`."""
    if not effort.executor.accepts(job, effort.goal):
        return black(job)
    [last] = deque(traced_rounds(job, effort, goal), maxlen=1)
    return _filled(job, last)


def estimated_rounds(
    job: PictureJob, effort: Effort, goal: PixelGoal | None
) -> Iterator[RadianceEstimate]:
    """Return the pictures after each round; a traced pixel stands for its block.

    `goal` is None if the effort gives the number of samples.
    """
    if not effort.executor.accepts(job, effort.goal):
        return iter([black(job)])
    return (_filled(job, each) for each in traced_rounds(job, effort, goal))


def _filled(job: PictureJob, each: Round) -> RadianceEstimate:
    # Estimates of all pixels; that of a block for its pixels not yet traced
    sums, block = each.sums, each.block
    paths = int(sums.count.sum()) * job.batches
    if block > 1:
        row, column = np.ogrid[: job.rows, : job.columns]
        first = row // block * block * job.columns + column // block * block
        own = np.arange(job.receivers)
        source = np.where(sums.count > 0, own, first.ravel())
        sums = Sums(sums.total[source], sums.count[source], sums.one)
    return replace(radiance_of(job, sums, reached=each.reached), paths=paths)


def _until(pixels: "_Pixels", goal: PixelGoal) -> Iterator[Round]:
    # Distribute the paths predicted by a pilot run, then add to them if needed
    most = pixels.job.growth.longest
    plan = yield from _pilot_run(pixels, goal)
    steps, factor, ratio = plan.steps, plan.factor, math.inf
    before = np.zeros_like(steps)
    while ratio > _TOLERANCE and (steps > before).any():
        yield from pixels.double(steps, plan.length)
        ratio, before = goal.error(pixels.estimates()), steps
        yield Round(pixels.sums, 1, ratio <= _TOLERANCE)
        factor *= _MARGIN * max(1.0, ratio)
        further = plan.allocation.doublings(factor, _doublings(most, plan.length))
        steps = np.maximum(steps, further)


@dataclass(frozen=True, eq=False)
class _Plan:
    """Allocation after a pilot run of a length, and doublings that reach the goal.

    `factor` is the ratio of the error of the pilot run to the planned error.
    """

    length: int
    allocation: Allocation
    steps: Int[np.ndarray, " pixel"]
    factor: float


def _pilot_run(pixels: "_Pixels", goal: PixelGoal) -> Generator[Round, None, _Plan]:
    # Sample all pixels equally until the needed number of paths can be predicted
    length, most = int(pixels.sums.count[0]), pixels.job.growth.longest
    while True:
        estimates = pixels.estimates()
        allocation = Allocation.of(goal.contributions(estimates))
        # A target that the pilot run reaches is confirmed by further paths
        factor = _MARGIN * max(1.0, goal.error(estimates))
        steps = allocation.doublings(factor, _doublings(most, length))
        needed = length * float(np.exp2(steps).mean())
        pixels.expected = needed * steps.size
        longer = _longer_pilot(length, needed)
        if longer == length:
            return _Plan(length, allocation, steps, factor)
        length = longer
        pixels.extend(pixels.every, length)
        yield Round(pixels.sums, 1, False)


def _longer_pilot(length: int, needed: float) -> int:
    # Next length of the pilot run, from the predicted mean length of all pixels
    wanted = min(_LONGEST_PILOT, needed * _PILOT_SHARE)
    return length << max(0, math.ceil(math.log2(wanted / length)))


def _doublings(most: int, length: int) -> int:
    return int(math.log2(most / length))


def _coarse(job: PictureJob, block: int) -> Bool[np.ndarray, " pixel"]:
    # Upper left pixels of square blocks
    row, column = np.ogrid[: job.rows, : job.columns]
    first: np.ndarray = (row % block == 0) & (column % block == 0)
    return first.ravel()


class _Pixels:
    """Sums of all pixels, extended pixel by pixel, with progress.

    `expected` is the predicted total number of sample points of all pixels.
    """

    def __init__(self, job: PictureJob, effort: Effort, expected: float) -> None:
        self.job, self.effort, self.expected = job, effort, expected
        self.sums = job.empty_sums(job.receivers)
        self.every = np.full(job.receivers, True)

    def estimates(self) -> PixelEstimates:
        """Return values and variances of all pixels."""
        return PixelEstimates.of(self.sums, self.job)

    def extend(self, chosen: Bool[np.ndarray, " pixel"], length: int) -> None:
        """Extend the batches of chosen pixels, of equal lengths, to a length."""
        count = self.sums.count
        chosen = chosen & (count < length)
        if not chosen.any():
            return
        done = float(count.sum())
        more = float((length - count[chosen]).sum())
        total = max(self.expected, done + more)
        progress = share_of_progress(self.effort.progress, done / total, more / total)
        here = replace(self.effort, progress=progress)
        numbers = np.arange(self.job.receivers)
        lengthen(self.job, numbers, self.sums, chosen, length, here)

    def double(self, steps: Int[np.ndarray, " pixel"], length: int) -> Iterator[Round]:
        """Double the batches of each pixel a number of times, from a length on.

        Yield a round after each doubling but the last.
        """
        self.expected = length * float(np.exp2(steps).sum())
        last = int(steps.max())
        for number in range(1, last + 1):
            before = int(self.sums.count.sum())
            self.extend(steps >= number, length << number)
            if number < last and int(self.sums.count.sum()) > before:
                yield Round(self.sums, 1, False)
