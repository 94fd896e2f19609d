"""Low-discrepancy sample points: Sobol' sequences with hashed Owen scrambling.

One table holds the sequence for the first bounces of a path; every row and batch
of a matrix scrambles it with a seed of its own. Batches are then independent,
unbiased estimates, and within a batch the points of each bounce fill their square
evenly. Deeper bounces, where little energy is left, use hashed random numbers.

References: I. M. Sobol', USSR Comput. Math. Math. Phys. 7 (4), 1967, with the
direction numbers of S. Joe and F. Kuo, SIAM J. Sci. Comput. 30, 2008 (as in SciPy);
S. Laine and T. Karras, "Stratified sampling for stochastic transparency", 2011;
B. Burley, "Practical hash-based Owen scrambling", JCGT 9 (4), 2020.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy.stats import qmc

from clerestory.engine.upload import on_device

# Numbers a vertex of a path consumes, by purpose.
CONNECT_U, CONNECT_V, LOBE, DIRECTION_U, DIRECTION_V = range(5)
PER_VERTEX = 5

# Vertices that take Sobol' points; later ones take hashed random numbers.
VERTICES = 8


@dataclass
class Points:
    """A stretch of the sequence, bit-reversed, dimension-major.

    Attributes
    ----------
    table : (dimensions * count,) coordinates as 32-bit integers, bits reversed
    count : points in this stretch
    stride : of the table: the count, in memory, so that kernels serve any stretch
    first : number of its first point in the sequence, by which hashed numbers differ
    """

    table: mi.UInt32
    count: int
    stride: mi.UInt32
    first: mi.UInt32


def points(first: int, count: int) -> Points:
    """Return the points `first` to `first + count` of the sequence."""
    sequence = qmc.Sobol(VERTICES * PER_VERTEX, scramble=False, bits=32)
    if first:
        sequence.fast_forward(first)
    full = sequence.random(1 << (count - 1).bit_length())[:count]
    coordinates = np.round(full.T * 2.0**32).astype(np.uint32)
    table = dr.brev(on_device(mi.UInt32, coordinates))
    dr.eval(table)
    stride, start = (dr.opaque(mi.UInt32, number) for number in (count, first))
    return Points(table, count, stride, start)


def mix(value, salt):
    """Return well-mixed 32-bit integers (the finaliser lowbias32 by C. Wellons)."""
    value = value ^ salt
    value = (value ^ (value >> 16)) * mi.UInt32(0x7FEB352D)
    value = (value ^ (value >> 15)) * mi.UInt32(0x846CA68B)
    return value ^ (value >> 16)


def to_unit(bits):
    """Return a float in [0, 1) from the upper 24 bits of an integer."""
    return mi.Float(bits >> 8) * (1.0 / (1 << 24))


def random_number(seed, index, dimension):
    """Return a hashed random number in [0, 1) that is no part of the sequence."""
    return to_unit(mix(mix(index, seed), dimension * mi.UInt32(0x9E3779B9) + 1))


def coordinate(sequence: Points, seed, index, vertex, purpose: int):
    """Return one coordinate, scrambled for its row and batch, in [0, 1).

    Parameters
    ----------
    seed : of the row and batch; the same for all their paths
    index : number of the path's point in the table
    vertex : vertices of the path so far
    purpose : one of CONNECT_U … DIRECTION_V
    """
    dimension = vertex * PER_VERTEX + purpose
    low = vertex < VERTICES
    entry = dimension * sequence.stride + index
    bits = dr.gather(mi.UInt32, sequence.table, entry, low)

    # Permute each binary digit according to the digits before it
    key = mix(dimension * mi.UInt32(0x9E3779B9), seed)
    bits ^= bits * mi.UInt32(0x3D20ADEA)
    bits += key
    bits *= (key >> 16) | 1
    bits ^= bits * mi.UInt32(0x05526C56)
    bits ^= bits * mi.UInt32(0x53A22864)
    scrambled = to_unit(dr.brev(bits))
    return dr.select(
        low, scrambled, random_number(seed, index + sequence.first, dimension)
    )


def choose(cumulative: mi.Float, count: int, pick):
    """Choose one of several by a number in [0, 1).

    Parameters
    ----------
    cumulative : sum of the probabilities up to and with each

    Returns
    -------
    number, probability : of the chosen one
    rest : what is left of the number, in [0, 1)
    """
    number = mi.UInt32(
        dr.binary_search(
            0, count - 1, lambda i: dr.gather(mi.Float, cumulative, i) <= pick
        )
    )
    low = dr.gather(mi.Float, cumulative, number - 1, number > 0)
    chance = probability(cumulative, number)
    return number, chance, (pick - low) / chance


def probability(cumulative: mi.Float, number):
    """Return the probability of one of several; see `choose`."""
    low = dr.gather(mi.Float, cumulative, number - 1, number > 0)
    return dr.gather(mi.Float, cumulative, number) - low


@dataclass
class PathNumbers:
    """Sample numbers of a path at one of its vertices.

    Attributes
    ----------
    points : of the sequence
    seed : of the row and batch
    index : number of the path's point in the table
    vertex : vertices of the path so far
    """

    points: Points
    seed: mi.UInt32
    index: mi.UInt32
    vertex: mi.UInt32

    def at(self, vertex: mi.UInt32) -> "PathNumbers":
        """Return the numbers of another vertex."""
        return PathNumbers(self.points, self.seed, self.index, vertex)

    def sobol(self, purpose: int):
        """Return a coordinate of the sequence."""
        return coordinate(self.points, self.seed, self.index, self.vertex, purpose)

    def hashed(self, dimension):
        """Return a random number of the path that is no part of the sequence."""
        return random_number(self.seed, self.index + self.points.first, dimension)

    def extra(self, purpose: int):
        """Return a random number of the vertex, by its purpose below 16."""
        return self.hashed(self.vertex * 16 + (0x20000 + purpose))
