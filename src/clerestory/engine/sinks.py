"""Sinks of a path tracer: accumulation of path contributions.

A matrix is summed in 64-bit fixed point: exact, independent of the order of additions
and bitwise reproducible. Radiance has no upper limit and is summed in floating point.
Sparse rows are recorded, contribution by contribution.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine.sums import FIXED_POINT

# A weight is converted as two integers of at least 20 bits, which is fastest on CPUs.
_HALF = FIXED_POINT**0.5

# Path weights are at most a few π; larger weights than this limit would overflow.
_LARGEST = 2000.0


@dataclass
class MatrixSink:
    """Sums of a matrix in fixed point.

    The first element of `sums` counts path weights outside the valid range; the others
    are sums by row and batch, column, and channel. `slot` indexes the path's row and
    batch.
    """

    sums: mi.UInt64
    columns: int
    channels: int
    slot: mi.UInt32 | int = 0

    def begin(self) -> None:
        """Return None: contributions are added to the matrix immediately."""

    def add(self, _total: None, column, value, active) -> None:
        """Add the contribution of a path to the sum of a row, batch and column."""
        index = (self.slot * self.columns + column) * self.channels + 1
        mode = _reduction()
        fits = mi.Bool(True)
        for channel in range(self.channels):
            fits &= (value[channel] >= 0) & (value[channel] < _LARGEST)
        one, first = mi.UInt64(1), mi.UInt32(0)
        dr.scatter_add(self.sums, one, first, active & ~fits, mode)
        for channel in range(self.channels):
            weight = value[channel]
            scaled = weight * _HALF
            whole = mi.UInt32(mi.Int32(scaled))
            rest = mi.UInt32(mi.Int32((scaled - mi.Float(whole)) * _HALF))
            amount = (mi.UInt64(whole) << 20) + mi.UInt64(rest)
            dr.scatter_add(self.sums, amount, index + channel, active & fits, mode)


class RadianceSink:
    """Sum of a path's contributions in floating point, carried along the path."""

    def begin(self) -> mi.Color3f:
        """Return a sum of zero."""
        return mi.Color3f(0)

    def add(self, total: mi.Color3f, _column, value, active) -> mi.Color3f:
        """Return the sum with the contribution of a path added."""
        return total + dr.select(active, value, 0)


@dataclass
class RecordSink:
    """Record of the contributions of each path: exit direction, zone and weights.

    A path has room for `most` contributions; its sum is the number of contributions
    that it made, which may be larger.
    """

    directions: mi.UInt32
    zones: mi.UInt32
    weights: list[mi.Float]
    most: int
    lane: mi.UInt32

    @classmethod
    def of(cls, lanes: int, most: int, channels: int) -> "RecordSink":
        """Return an empty record for a number of paths."""
        size = lanes * most
        codes = (dr.zeros(mi.UInt32, size) for _ in range(2))
        weights = [dr.zeros(mi.Float, size) for _ in range(channels)]
        return cls(*codes, weights, most, dr.arange(mi.UInt32, lanes))

    def begin(self) -> mi.UInt32:
        """Return zero contributions."""
        return mi.UInt32(0)

    def add(self, total: mi.UInt32, column, value, active) -> mi.UInt32:
        """Record a contribution; return the number of contributions of the path."""
        kept = active & (total < self.most)
        place = self.lane * self.most + total
        dr.scatter(self.directions, column.x, place, kept)
        dr.scatter(self.zones, column.y, place, kept)
        for channel, weights in enumerate(self.weights):
            dr.scatter(weights, value[channel], place, kept)
        return total + dr.select(active, mi.UInt32(1), 0)


Sink = MatrixSink | RadianceSink | RecordSink


def _reduction() -> dr.ReduceMode:
    # On a CPU, all threads add to the same sums: copies for each thread are no faster,
    # and require a separate kernel for every number of sums
    processor = dr.backend_v(mi.UInt64) == dr.JitBackend.LLVM
    return dr.ReduceMode.Direct if processor else dr.ReduceMode.Auto
