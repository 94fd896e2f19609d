"""Low-discrepancy sample points: Sobol' sequences with hashed Owen scrambling.

One table contains the sequence for the first vertices of a path; it is scrambled with a
different seed for every row and batch of a matrix. Batches are therefore independent,
unbiased estimates, and the points of each vertex in a batch are evenly distributed.
Later vertices, of low throughput, use hashed random numbers.

References: S. Laine and T. Karras, "Stratified sampling for stochastic transparency",
2011; B. Burley, "Practical hash-based Owen scrambling", JCGT 9 (4), 2020.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.sobol import sobol
from clerestory.engine.upload import on_device, search

# Dimensions of the sample point used at a path vertex, by purpose.
CONNECT_U, CONNECT_V, LOBE, DIRECTION_U, DIRECTION_V = range(5)
PER_VERTEX = 5

# Number of vertices with Sobol' points; later vertices use hashed random numbers.
VERTICES = 8


@dataclass
class Points:
    """A range of the Sobol' sequence, as bit-reversed integers by dimension.

    `stride` is `count` as a Dr.Jit value, so that one kernel serves any range; `first`
    is the index of the first point in the sequence, which seeds the hashed numbers.
    """

    table: mi.UInt32
    count: int
    stride: mi.UInt32
    first: mi.UInt32


def points(first: int, count: int) -> Points:
    """Return the points `first` to `first + count` of the sequence."""
    table = dr.brev(on_device(mi.UInt32, sobol(first, count)))
    dr.eval(table)
    stride, start = (dr.opaque(mi.UInt32, number) for number in (count, first))
    return Points(table, count, stride, start)


def mix(value, salt):
    """Return hashes of 32-bit integers (function lowbias32 by C. Wellons)."""
    value = value ^ salt
    value = (value ^ (value >> 16)) * mi.UInt32(0x7FEB352D)
    value = (value ^ (value >> 15)) * mi.UInt32(0x846CA68B)
    return value ^ (value >> 16)


def to_unit(bits):
    """Return a float in [0, 1) from the upper 24 bits of an integer."""
    return mi.Float(bits >> 8) * (1.0 / (1 << 24))


def random_number(seed, index, dimension):
    """Return a hashed random number in [0, 1), independent of the sequence."""
    return to_unit(mix(mix(index, seed), dimension * mi.UInt32(0x9E3779B9) + 1))


def random_numbers(seed: int, index, count: int) -> list[mi.Float]:
    """Return several hashed random numbers in [0, 1)."""
    # Small seeds that are not hashed would only permute the indices
    key = mix(mi.UInt32(seed), mi.UInt32(0x5BD1E995))
    return [random_number(key, index, mi.UInt32(n)) for n in range(count)]


@dataclass
class Distribution:
    """Discrete distribution of the numbers from 0 to `count` - 1."""

    cumulative: mi.Float
    count: int

    @classmethod
    def of(cls, weights: np.ndarray) -> "Distribution":
        """Return the distribution with probabilities proportional to weights."""
        cumulative = np.cumsum(weights) / weights.sum() if len(weights) else weights
        cumulative[-1:] = 1
        return cls(on_device(mi.Float, cumulative), len(weights))

    def sample(self, pick):
        """Return a sampled number, its probability, and `pick` rescaled to [0, 1)."""
        number = search(self.cumulative, self.count, pick)
        low = dr.gather(mi.Float, self.cumulative, number - 1, number > 0)
        chance = self.probability(number)
        return number, chance, (pick - low) / chance

    def probability(self, number):
        """Return the probability of sampling a number."""
        low = dr.gather(mi.Float, self.cumulative, number - 1, number > 0)
        return dr.gather(mi.Float, self.cumulative, number) - low


@dataclass
class PathNumbers:
    """Random numbers of a path at one vertex, from the sequence or hashed.

    `seed` is the seed of the row and batch, `index` the index of the sample point.
    """

    points: Points
    seed: mi.UInt32
    index: mi.UInt32
    vertex: mi.UInt32

    def at(self, vertex: mi.UInt32) -> "PathNumbers":
        """Return the random numbers of another path vertex."""
        return PathNumbers(self.points, self.seed, self.index, vertex)

    def sobol(self, purpose: int):
        """Return a coordinate of the sequence in [0, 1), scrambled by the seed."""
        dimension = self.vertex * PER_VERTEX + purpose
        low = self.vertex < VERTICES
        entry = dimension * self.points.stride + self.index
        bits = dr.gather(mi.UInt32, self.points.table, entry, low)

        # Permute each binary digit according to the digits before it
        key = mix(dimension * mi.UInt32(0x9E3779B9), self.seed)
        bits ^= bits * mi.UInt32(0x3D20ADEA)
        bits += key
        bits *= (key >> 16) | 1
        bits ^= bits * mi.UInt32(0x05526C56)
        bits ^= bits * mi.UInt32(0x53A22864)
        return dr.select(low, to_unit(dr.brev(bits)), self.hashed(dimension))

    def hashed(self, dimension):
        """Return a hashed random number of the path."""
        return random_number(self.seed, self.index + self.points.first, dimension)

    def extra(self, purpose: int):
        """Return a hashed random number of the vertex, for a purpose below 16."""
        return self.hashed(self.vertex * 16 + (0x20000 + purpose))
