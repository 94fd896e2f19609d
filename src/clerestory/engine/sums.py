"""Sums of path contributions, their means and standard errors.

Every row is estimated by independent batches. The standard error is computed from the
variance of the batch means. Fixed-point sums are exact in any order of addition;
floating-point sums are added in the order of the units.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from clerestory.matrix.derivatives import Derivatives

# Default number of independent batches per row
BATCHES = 16

# Size of the sums that are averaged at a time, to fit in the processor's cache [bytes]
_CACHED = 1 << 20

# A path of weight 1 adds 2⁴⁰ to a fixed-point sum; the sum of weights must stay below
# 2²⁴
FIXED_POINT = float(1 << 40)

# Sums of this many channels or more are added to in packets of consecutive sums, and
# number at most PACKET_SUMS in a unit of several rows on a CPU
PACKET = 8
PACKET_SUMS = 1 << 22


def sums_of_place(channels: int) -> int:
    """Return the number of sums of a row, batch and column, some of them unused.

    >>> sums_of_place(3), sums_of_place(8), sums_of_place(81)
    (3, 8, 88)
    """
    return channels if channels < PACKET else -(-channels // PACKET) * PACKET


@dataclass(frozen=True, eq=False)
class Estimate:
    """Traced matrix: mean values over all batches, and error components by batch.

    The variance of a value is the sum of its squared error components, which are
    optional. `reached` tells whether all rows reached the target relative error.
    `derivatives` are those asked for by a matrix job.
    """

    values: Float[np.ndarray, "channel row column"]
    components: Float[np.ndarray, "component channel row column"] | None
    paths: int
    reached: bool
    derivatives: Derivatives | None = None


@dataclass
class Sums:
    """Sums of the path contributions of some rows, in fixed or floating point.

    `count` is the number of sample points that each batch of a row has traced; a path
    of weight 1 adds `one` to a sum. Where consecutive batches are merged into fewer,
    `of_batches` has the sums of each batch over all columns.
    """

    total: np.ndarray
    count: Int[np.ndarray, " row"]
    one: float = FIXED_POINT
    of_batches: np.ndarray | None = None

    @classmethod
    def empty(
        cls, kind: type, shape: tuple[int, ...], one: float = FIXED_POINT
    ) -> "Sums":
        """Return zero sums over (row, batch, column, channel)."""
        return cls(np.zeros(shape, kind), np.zeros(shape[0], np.int64), one)

    @classmethod
    def merged(cls, shape: tuple[int, int, int, int], groups: int) -> "Sums":
        """Return zero fixed-point sums whose batches are merged into `groups`."""
        rows, batches, columns, channels = shape
        sums = cls.empty(np.uint64, (rows, groups, columns, channels))
        of_batches = np.zeros((rows, batches, channels), np.uint64)
        return replace(sums, of_batches=of_batches)

    @property
    def merged_batches(self) -> int:
        """Number of batches that each sum has."""
        if self.of_batches is None:
            return 1
        return int(self.of_batches.shape[1] // self.total.shape[1])

    def add(
        self,
        rows: Int[np.ndarray, " some"],
        part: np.ndarray,
        columns: Int[np.ndarray, " some_columns"] | None = None,
    ) -> None:
        """Add the sums of a unit that has all columns, or consecutive columns."""
        if self.of_batches is not None:
            # Row by row, as the sums of one fit in the processor's cache
            _, groups, *size = self.total.shape
            for row, own in zip(rows.tolist(), part, strict=True):
                self.total[row] += own.reshape(groups, -1, *size).sum(axis=1)
                self.of_batches[row] += own.sum(axis=1)
            return
        chosen: slice | np.ndarray = rows
        if rows[-1] - rows[0] == len(rows) - 1:
            chosen = slice(rows[0], rows[-1] + 1)
        if columns is None:
            self.total[chosen] += part
        else:
            self.total[chosen, :, columns[0] : columns[-1] + 1] += part

    def means(self) -> Float[np.ndarray, "row batch column channel"]:
        """Return the mean path weight of each batch, by row and column."""
        one = self.one * self.merged_batches
        means: np.ndarray = self.total / (one * self.count[:, None, None, None])
        return means

    def collected(self) -> Float[np.ndarray, "row batch channel"]:
        """Return the mean path weight of each batch, summed over all columns."""
        means = self.of_batches
        if means is None:
            means = self.total.sum(axis=2)
        return np.asarray(means / (self.one * self.count[:, None, None]))


def variance(values: np.ndarray, *, axis: int) -> np.ndarray:
    """Variance of the mean of independent batches."""
    of_batches: np.ndarray = np.var(values, axis=axis, ddof=1)
    of_mean: np.ndarray = of_batches / values.shape[axis]
    return of_mean


def estimated(sums: Sums, *, reached: bool, components: bool) -> Estimate:
    """Return the mean values of sums and, on request, their error components."""
    rows, batches, columns, channels = sums.total.shape
    values = np.empty((channels, rows, columns))
    shape = batches, channels, rows, columns
    deviations = np.empty(shape, np.float32) if components else None
    few = max(1, _CACHED // max(1, sums.total[:1].nbytes))
    for part in (slice(n, n + few) for n in range(0, rows, few)):
        means = replace(sums, total=sums.total[part], count=sums.count[part]).means()
        mean = means.mean(axis=1)
        values[:, part] = np.moveaxis(mean, -1, 0)
        if deviations is not None:
            means -= mean[:, None]
            means /= np.sqrt(batches * (batches - 1))
            deviations[:, :, part] = np.moveaxis(means, (1, 3), (0, 1))
    paths = int(sums.count.sum()) * batches * sums.merged_batches
    return Estimate(values, deviations, paths, reached)
