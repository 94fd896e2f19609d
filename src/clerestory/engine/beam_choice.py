"""Choice of a beam of sunlight for each sample point, and test against the window."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine.sampler import mix

# Tolerance of the test: relative to the window, and cosine of a surface turned away
_SLACK, _FACING = 1e-3, -1e-3


@dataclass
class BeamOrder:
    """Numbers from which the beam of a sample point and sun follows.

    Attributes
    ----------
    seed, points, batches : seed, points per batch, and batches
    own, apart : beams per batch, and beams from one point to the next
    binary : whether all numbers of points, batches and beams are powers of two
    """

    seed: mi.UInt32
    points: mi.UInt32
    batches: mi.UInt32
    own: mi.UInt32
    apart: mi.UInt32
    binary: bool

    @classmethod
    def of(cls, *, seed: int, points: int, batches: int, beams: int) -> "BeamOrder":
        """Return the order of the beams of each sun."""
        own = beams // batches
        counts = points, batches, own
        numbers = (seed, *counts, max(1, own // points))
        return cls(
            *(dr.opaque(mi.UInt32, number) for number in numbers),
            binary=all(count & (count - 1) == 0 for count in counts),
        )

    def divided(self, value, count: mi.UInt32) -> tuple[mi.UInt32, mi.UInt32]:
        """Return quotient and remainder by one of the numbers."""
        # Divisions of integers take most of the time of a kernel on CPUs
        if self.binary:
            return value >> dr.tzcnt(count), value & (count - 1)
        return value // count, value % count


def chosen_beam(place, number, key, order: BeamOrder):
    """Return the index of the beam of a sample point and sun; see `beam_of`."""
    slot, index = order.divided(place, order.points)
    _, batch = order.divided(slot, order.batches)
    return beam_of(slot, batch, index, number, key, order)


def beam_of(slot, batch, index, number, key, order: BeamOrder):
    """Return the index of the beam of a point of a receiver in a batch, and a sun.

    Batches have beams of their own; points of a batch take beams that are far apart.
    `slot` is the number of the receiver and batch.
    """
    start = mix(mix(slot, order.seed), key)
    _, own = order.divided(start + index * order.apart, order.own)
    return (number * order.own + own) * order.batches + batch


@dataclass
class Rectangle:
    """Rectangle around a window: corner, unit normal, and edges.

    The edges are divided by the squares of their lengths.
    """

    corner: mi.Point3f
    plane: mi.Vector3f
    across: mi.Vector3f
    up: mi.Vector3f

    def crossed(self, point, toward, slack: float = _SLACK) -> mi.Bool:
        """Whether rays from points cross the rectangle, to the outside.

        `slack` is a tolerance, relative to the rectangle.
        """
        apart = mi.Vector3f(self.corner - point)
        outwards = dr.dot(toward, self.plane)
        distance = dr.dot(apart, self.plane) / outwards
        offset = toward * distance - apart
        x, y = dr.dot(offset, self.across), dr.dot(offset, self.up)
        crosses = (distance > 0) & (outwards < 0)
        crosses &= (x > -slack) & (x < 1 + slack) & (y > -slack) & (y < 1 + slack)
        return crosses


@dr.syntax
def crossed(
    points, normals, both, valid, directions, keys, count, words, rectangle, order
):
    """Return bit masks of the suns whose beam reaches each point by way of the window.

    A point has `words` masks of 32 suns each. A sun's bit is set if the line from the
    point towards the sun, along the beam chosen for both, crosses the rectangle of the
    window. Occlusion is not tested.
    """
    lane = dr.arange(mi.UInt32, dr.width(valid) * words)
    each = dr.opaque(mi.UInt32, words)
    place, number = lane // each, (lane % each) * 32
    last = dr.minimum(number + 32, count)
    inside = dr.gather(mi.Bool, valid, place)
    number = dr.select(inside, number, last)
    normal = dr.gather(mi.Vector3f, normals, place)
    every = dr.gather(mi.Bool, both, place)
    point = dr.gather(mi.Point3f, points, place)
    masks = mi.UInt32(0)
    while number < last:
        key = dr.gather(mi.UInt32, keys, number)
        beam = chosen_beam(place, number, key, order)
        toward = dr.gather(mi.Vector3f, directions, beam)
        crosses = rectangle.crossed(point, toward)
        crosses &= dr.dot(normal, toward) > _FACING
        masks |= dr.select(crosses | every, mi.UInt32(1) << (number & 31), 0)
        number += 1
    return masks
