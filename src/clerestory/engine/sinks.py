"""Sinks of a path tracer: accumulation of path contributions.

A matrix is summed in 64-bit fixed point: exact, independent of the order of additions
and bitwise reproducible. Radiance has no upper limit and is summed in floating point.
Sparse rows are recorded, contribution by contribution.
"""

import math
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import UInt64

from clerestory.engine.derivative_sums import Places
from clerestory.engine.sums import FIXED_POINT, PACKET, PACKET_SUMS, sums_of_place

# Largest number of threads that each have their own copy of the sums, if values are
# added in packets
_MOST_COPIES = 16

# A weight is converted as two integers of at least 20 bits, which is fastest on CPUs.
_HALF = FIXED_POINT**0.5

# Path weights are at most a few π; larger weights than this limit would overflow.
_LARGEST = 2000.0


@dataclass
class MatrixSink:
    """Sums of a matrix in fixed point.

    `sums` are those of `empty_sums`: the first element counts path weights outside the
    valid range. `slot` indexes the path's row and batch.
    """

    sums: mi.UInt64
    columns: int
    channels: int
    slot: mi.UInt32 | int = 0

    def begin(self) -> None:
        """Return None: contributions are added to the matrix immediately."""

    def add(self, _total: None, column, value, active) -> None:
        """Add the contribution of a path to the sum of a row, batch and column."""
        fits = mi.Bool(True)
        for channel in range(self.channels):
            fits &= (value[channel] >= 0) & (value[channel] < _LARGEST)
        one, first = mi.UInt64(1), mi.UInt32(0)
        dr.scatter_add(self.sums, one, first, active & ~fits, self._reduction())
        weights = [value[channel] for channel in range(self.channels)]
        self._scatter(self.slot, column, weights, active & fits)

    def _scatter(
        self, slot, column, weights: list[mi.Float], active, *, signed: bool = False
    ) -> None:
        # Add weights in fixed point to the channels of a row and column
        amounts = [_fixed_point(weight, signed=signed) for weight in weights]
        self._scatter_amounts(slot, column, amounts, active)

    def _scatter_amounts(self, slot, column, amounts: list[mi.UInt64], active) -> None:
        place = slot * self.columns + column
        if self.channels < PACKET:
            index = place * self.channels + 1
            for channel, amount in enumerate(amounts):
                dr.scatter_add(
                    self.sums, amount, index + channel, active, self._reduction()
                )
            return
        packets = sums_of_place(self.channels) // PACKET
        none = [mi.UInt64(0)] * (packets * PACKET - self.channels)
        padded, index = [*amounts, *none], place * packets + 1
        for number in range(packets):
            packet = padded[number * PACKET : (number + 1) * PACKET]
            dr.scatter_add(
                self.sums, mi.ArrayXu64(packet), index + number, active,
                self._reduction(),
            )  # fmt: skip

    def _reduction(self) -> dr.ReduceMode:
        # On a CPU, atomic additions of single numbers by all threads to the same sums
        # are as fast as copies for each thread, which require a separate kernel for
        # every number of sums; packets are several times faster, but not atomic
        if dr.backend_v(mi.UInt64) != dr.JitBackend.LLVM:
            return dr.ReduceMode.Auto
        if self.channels < PACKET or dr.thread_count() > _MOST_COPIES:
            return dr.ReduceMode.Direct
        return dr.ReduceMode.Expand


def _fixed_point(weight: mi.Float, *, signed: bool = False) -> mi.UInt64:
    # A weight in fixed point, in two's complement if it is signed
    scaled = weight * _HALF
    high, low = mi.UInt32, mi.UInt64
    if signed:
        high, low = mi.Int32, mi.Int64
    whole = high(mi.Int32(scaled))
    rest = high(mi.Int32((scaled - mi.Float(whole)) * _HALF))
    return mi.UInt64((low(whole) << 20) + low(rest))


@dataclass
class DerivativeSink(MatrixSink):
    """Sums of a matrix and of its derivatives in fixed point.

    The places of a row are the batches of the matrix, those of the derivative by each
    parameter, and one for each pair of parameters; see `derivative_sums`. Derivatives
    are logarithmic, and added in smaller units.
    """

    batches: int = 1
    parameters: int = 0
    row: mi.UInt32 | int = 0
    batch: mi.UInt32 | int = 0

    @property
    def _places(self) -> Places:
        return Places(self.batches, self.parameters)

    def differentiate(self, column, value, scores, active) -> None:
        """Add the derivatives of the contribution of a path."""
        places = self._places
        batch = self.batch + places.batches * (1 + scores.parameter)
        found = active & (scores.count > 0)
        if scores.value is None:
            self._add_multiple(batch, column, value, scores.count, found)
        else:
            first = places.unit_of_first * scores.count
            self._add(batch, column, value, first, scores.value, found)

        # Most packets are in batches without second derivatives, and skip them
        def second(active):
            self._differentiate_twice(column, value, scores, active)

        summed = found & (self.batch < places.of_pairs)
        dr.if_stmt((summed,), summed, second, lambda _: None)

    def _differentiate_twice(self, column, value, scores, active) -> None:
        # Pairs of vertices, in either order if both have the same parameter
        places = self._places
        one = dr.minimum(scores.one, scores.other)
        other = dr.maximum(scores.one, scores.other)
        pairs = 0.5 * scores.count * (scores.count - 1)
        pairs *= dr.select(one == other, mi.Float(2), mi.Float(1))
        both = active & (scores.count > 1)
        second = places.unit_of_second * pairs
        place = places.pair(one, other)
        self._add(place, column, value, second, scores.product, both)
        if scores.curved is not None:
            own = scores.parameter
            factor, place = places.unit_of_second * scores.count, places.pair(own, own)
            self._add(place, column, value, factor, scores.curved, active)

    def _add_multiple(self, place, column, value, count, active) -> None:
        # Add a first derivative that is a multiple of the value, in integers: a value
        # below 2^11 in units of 2^-40, times at most 2^10 vertices, fits into 64 bits
        slot = self.row * self._places.count + place
        shift = -round(math.log2(self._places.unit_of_first))
        number = mi.UInt64(mi.UInt32(count))
        fits = dr.max(value) < _LARGEST
        amounts = [
            (_fixed_point(value[channel]) * number) >> shift
            for channel in range(self.channels)
        ]
        self._scatter_amounts(slot, column, amounts, active & fits)

    def _add(self, place, column, value, factor, score, active) -> None:
        # Add a derivative, which may be negative
        slot = self.row * self._places.count + place
        weights = [value[channel] * factor for channel in range(self.channels)]
        if score is not None:
            weights = [w * score[channel] for channel, w in enumerate(weights)]
        kept = [dr.clip(w, 1 - _LARGEST, _LARGEST - 1) for w in weights]
        self._scatter(slot, column, kept, active, signed=True)


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


def empty_sums(places: int, channels: int) -> mi.UInt64:
    """Return sums of zero for a number of places (row, batch and column).

    Sums in packets have a common size, for which a single kernel is compiled.
    """
    if channels < PACKET:
        return dr.zeros(mi.UInt64, places * channels + 1)
    size = PACKET + places * sums_of_place(channels)
    return dr.zeros(mi.UInt64, max(PACKET_SUMS, 1 << (size - 1).bit_length()))


def by_place(
    sums: UInt64[np.ndarray, " sum"], places: int, channels: int
) -> UInt64[np.ndarray, "place channel"]:
    """Return the sums of each place and channel."""
    first, width = 1 if channels < PACKET else PACKET, sums_of_place(channels)
    return sums[first : first + places * width].reshape(places, width)[:, :channels]
