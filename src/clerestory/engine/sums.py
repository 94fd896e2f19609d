"""Sums of what paths carry, and the means and errors that they amount to.

Every row of a matrix is estimated by sixteen independent batches. Their sums are exact
whole numbers; their spread is the standard error.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, UInt64

BATCHES = 16

# Sums that are brought to means at a time [bytes]
_CACHED = 1 << 20

# One unit of a sum is 2⁻⁴⁰ of a weight; sums stay exact below 2²⁴.
FIXED_POINT = float(1 << 40)


@dataclass(frozen=True, eq=False)
class Estimate:
    """A traced matrix.

    Attributes
    ----------
    values : mean over the batches
    components : error components; the sum of their squares is the variance; None if
        they are not kept
    paths : traced in all
    reached : whether the relative error aimed at was reached in all rows
    """

    values: Float[np.ndarray, "channel row column"]
    components: Float[np.ndarray, "component channel row column"] | None
    paths: int
    reached: bool


@dataclass
class Sums:
    """Fixed-point sums of some rows, and how many points each batch has seen."""

    total: UInt64[np.ndarray, "row batch column channel"]
    count: Int[np.ndarray, " row"]

    @classmethod
    def none(cls, shape: tuple[int, int, int, int]) -> "Sums":
        """Return sums of rows, batches, columns and channels that have seen nothing."""
        return cls(np.zeros(shape, np.uint64), np.zeros(shape[0], np.int64))

    def add(self, rows: Int[np.ndarray, " some"], part: np.ndarray) -> None:
        """Add what a unit returned to some rows; in place if they are consecutive."""
        if rows[-1] - rows[0] == len(rows) - 1:
            self.total[rows[0] : rows[-1] + 1] += part
        else:
            self.total[rows] += part

    def means(self) -> Float[np.ndarray, "row batch column channel"]:
        """Mean weight of each batch's paths."""
        means: np.ndarray = self.total / (FIXED_POINT * self.count[:, None, None, None])
        return means

    def collected(self) -> Float[np.ndarray, "row batch channel"]:
        """Mean weight of each batch's paths, all columns together."""
        sums: np.ndarray = self.total.sum(axis=2)
        return sums / (FIXED_POINT * self.count[:, None, None])


def estimated(sums: Sums, *, reached: bool, components: bool) -> Estimate:
    """Return means of what was summed, and error components if they are asked for."""
    rows, batches, columns, channels = sums.total.shape
    values = np.empty((channels, rows, columns))
    shape = batches, channels, rows, columns
    spread = np.empty(shape, np.float32) if components else None
    # A few rows at a time, which stay in the cache
    few = max(1, _CACHED // sums.total[:1].nbytes)
    for part in (slice(n, n + few) for n in range(0, rows, few)):
        means = Sums(sums.total[part], sums.count[part]).means()
        mean = means.mean(axis=1)
        values[:, part] = np.moveaxis(mean, -1, 0)
        if spread is not None:
            means -= mean[:, None]
            means /= np.sqrt(batches * (batches - 1))
            spread[:, :, part] = np.moveaxis(means, (1, 3), (0, 1))
    return Estimate(values, spread, int(sums.count.sum()) * batches, reached)
