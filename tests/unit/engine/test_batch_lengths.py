"""The error that a trace reports is the error that it has, whatever ended it."""

from dataclasses import dataclass

import numpy as np
import pytest

from clerestory.engine.controller import EstimatedJob, sum_rows
from clerestory.engine.effort import Effort
from clerestory.engine.matrix_jobs import mean_error, row_errors
from clerestory.engine.sums import Sums, variance
from clerestory.engine.work_units import Local
from clerestory.scene.model import Scene

# Number of estimates of one number, each with its own random numbers
ROWS = 6000

# Paths of mean 1: standard deviation, and how much of it few paths have
NORMAL, HEAVY = "normal", "heavy tail"


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimates(EstimatedJob):
    """Rows that estimate 1; each row is complete by itself, or all are together."""

    together = False
    alone: bool = True

    @property
    def shape(self):
        return ROWS, self.batches, 1, 1

    def empty_sums(self, rows):
        return Sums.empty(float, (rows, *self.shape[1:]), 1.0)

    def error(self, sums):
        return row_errors(sums) if self.alone else mean_error(sums.collected(), axis=1)


class Dice(Local):
    """Sums of independent paths, drawn from their known distributions."""

    def __init__(self, tail, deviation):
        self.tail, self.deviation = tail, deviation
        self.random = np.random.default_rng(7)

    def map(self, job, units):
        for unit in units:
            shape = len(unit.rows), job.batches, 1, 1
            if self.tail == NORMAL:
                noise = self.random.standard_normal(shape)
                yield unit.count + np.sqrt(unit.count) * self.deviation * noise
            else:
                form = self.deviation**-2.0
                yield self.random.gamma(form * unit.count, 1 / form, shape)


def estimates(tail, deviation, aim, *, alone=True):
    """Return the estimates of 1, their standard errors, and the paths per row."""
    job = Estimates(
        scene=Scene(), batches=16, seed=1, bounces=None, device="cpu", alone=alone
    )
    effort = Effort(relative_error=aim, executor=Dice(tail, deviation), device="cpu")
    sums, reached = sum_rows(job, slice(0, ROWS), effort)
    assert reached
    means = sums.collected()[..., 0]
    return means.mean(axis=1), np.sqrt(variance(means, axis=1)), 16 * sums.count.mean()


@pytest.mark.parametrize("tail", [NORMAL, HEAVY])
@pytest.mark.parametrize("deviation", [2, 4, 7, 12])
@pytest.mark.parametrize("aim", [0.02, 0.01])
def test_errors_do_not_depend_on_having_ended_the_trace(tail, deviation, aim):
    """Deviations from the truth are as large, over all rows, as the stated errors."""
    found, error, _ = estimates(tail, deviation, aim)
    ratio = np.sqrt(np.mean((found - 1) ** 2) / np.mean(error**2))
    assert 0.96 < ratio < 1.045


@pytest.mark.parametrize("tail", [NORMAL, HEAVY])
@pytest.mark.parametrize("deviation", [2, 4, 7, 12])
def test_the_target_is_met_at_the_cost_it_needs(tail, deviation):
    """Nine of ten rows report at most the target; paths are not wasted.

    Independent paths need (deviation / target)² of them.
    """
    found, error, paths = estimates(tail, deviation, 0.01)
    assert np.mean(error > 0.01) < 0.15
    assert np.mean(error > 0.014) < 0.01
    assert np.sqrt(np.mean((found - 1) ** 2)) < 0.01
    assert 1 < paths / (deviation / 0.01) ** 2 < 2.2


@pytest.mark.parametrize("tail", [NORMAL, HEAVY])
@pytest.mark.parametrize("deviation", [2, 7])
def test_rows_that_end_together_meet_the_target_together(tail, deviation):
    """The root mean square of all errors is certain, and it is the target or less."""
    found, error, paths = estimates(tail, deviation, 0.01, alone=False)
    assert np.sqrt(np.mean(error**2)) < 0.011
    assert np.sqrt(np.mean((found - 1) ** 2) / np.mean(error**2)) < 1.03
    assert 0.8 < paths / (deviation / 0.01) ** 2 < 2.6
