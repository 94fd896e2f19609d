"""Lengths of batches that reach a target error, predicted from shorter batches.

The number of samples that a row of a matrix needs is predicted from the errors of
shorter batches. Stopping at the first error below the target would select errors that
are small by chance: the reported errors would be 5 to 12 % too small.

Reference: C. Stein, Annals of Mathematical Statistics 16 (3), 1945 (two-stage samples).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

# Exponent of convergence: the error decreases approximately as n^(-1/1.6) for n points
# per batch
CONVERGENCE = 1.6

# Largest ratio of the final length to the length of the batches that predict it, and
# planned length of these batches as a fraction of the final length. A small fraction
# keeps the final error independent of the prediction
_LAST, _BEFORE = 16.0, 1 / 8

# Safety factor on predicted lengths, and ratio of error to target above which batches
# are lengthened again: for errors of single rows, and of the whole matrix. The former
# are less certain: with 16 batches, their standard deviation is 18 %
_ROWS, _OVERALL = (2.0, 1.4), (1.25, 1.1)


@dataclass(frozen=True)
class Growth:
    """Lengths of batches, increased in steps until a target error is reached.

    A batch grows from `pilot` to at most `longest` sample points, by a factor of at
    most `most` per step. Target errors that need longer batches are not reached.
    """

    pilot: int
    longest: int
    most: int


@dataclass
class BatchLengths:
    """Planned lengths of the batches of all rows.

    Attributes
    ----------
    growth : limits of the lengths
    planned : length of the next step of each row
    needed : predicted length that reaches the target error
    last : whether the next step is the last one
    active : whether a row is incomplete
    met : whether the error of a row reaches the target, within a tolerance
    """

    growth: Growth
    planned: Int[np.ndarray, " row"]
    needed: Float[np.ndarray, " row"]
    last: Bool[np.ndarray, " row"]
    active: Bool[np.ndarray, " row"]
    met: Bool[np.ndarray, " row"]

    @classmethod
    def of(cls, rows: int, growth: Growth) -> "BatchLengths":
        """Return the plan for the pilot run, which counts as 2 % of the samples."""
        pilot = np.full(rows, min(growth.pilot, growth.longest))
        none = np.full(rows, False)
        return cls(growth, pilot, pilot * 50.0, none, ~none, none.copy())

    def step(self, count: Int[np.ndarray, " row"]) -> tuple[int, float]:
        """Return the next batch length, and its fraction of the remaining paths.

        `count` is the present batch length of each row.
        """
        length, count = int(self.planned[self.active].min()), count[self.active]
        left = np.maximum(self.needed[self.active], length) - count
        return length, min(0.9, float((length - count).sum() / left.sum()))

    def update(self, length: int, error: Float[np.ndarray, "*row"]) -> None:
        """Complete rows at their last step; plan the next step of the other rows.

        `error` is the error of the batches of the given length, relative to the target:
        one value per row, or one for all rows.
        """
        reached = self.active & (self.planned == length)
        tolerance = _uncertainty(error)[1]
        self.met = np.where(reached, error <= tolerance, self.met)
        complete = (self.last & self.met) | (length >= self.growth.longest)
        self.active = self.active & ~(reached & complete)

        # Plan the last step, or a step that will predict it
        needed = needed_length(length, error)
        factor = needed / length
        last = factor <= _LAST
        step = np.where(last, factor, np.minimum(factor * _BEFORE, self.growth.most))
        doublings = np.ceil(np.log2(np.maximum(step, 2))).astype(np.int64)
        planned = np.minimum(length << doublings, self.growth.longest)
        again = reached & self.active
        self.needed = np.where(again, needed, self.needed)
        self.planned = np.where(again, planned, self.planned)
        self.last = np.where(again, last, self.last)


def needed_length(
    length: int, error: Float[np.ndarray, "*row"]
) -> Float[np.ndarray, "*row"]:
    """Return the batch length at which the target error is reached.

    `error` is the error of batches of the given length, relative to the target: one
    value per row, or one for all rows.

    >>> float(needed_length(32, np.array(1.0)))
    40.0
    """
    needed: np.ndarray = _uncertainty(error)[0] * length * error**CONVERGENCE
    return needed


def _uncertainty(error: Float[np.ndarray, "*row"]) -> tuple[float, float]:
    return _ROWS if np.ndim(error) else _OVERALL
