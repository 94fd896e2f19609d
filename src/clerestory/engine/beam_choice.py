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

    Seed, points per batch, batches, beams per batch, and beams from point to point.
    """

    seed: mi.UInt32
    points: mi.UInt32
    batches: mi.UInt32
    own: mi.UInt32
    apart: mi.UInt32


def chosen_beam(place, number, key, order: BeamOrder):
    """Return the index of the beam of a sample point and sun.

    Batches have beams of their own; points of a batch take beams that are far apart.
    """
    slot, index = place // order.points, place % order.points
    start = mix(mix(slot, order.seed), key)
    own = (start + index * order.apart) % order.own
    beams = order.own * order.batches
    return number * beams + own * order.batches + slot % order.batches


@dr.syntax
def crossed(
    points,
    normals,
    both,
    valid,
    directions,
    keys,
    count,
    words,
    corner,
    plane,
    across,
    up,
    order,
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
    apart = mi.Vector3f(corner - dr.gather(mi.Point3f, points, place))
    height = dr.dot(apart, plane)
    masks = mi.UInt32(0)
    while number < last:
        key = dr.gather(mi.UInt32, keys, number)
        beam = chosen_beam(place, number, key, order)
        toward = dr.gather(mi.Vector3f, directions, beam)
        distance = height / dr.dot(toward, plane)
        offset = toward * distance - apart
        x, y = dr.dot(offset, across), dr.dot(offset, up)
        crosses = (distance > 0) & (dr.dot(toward, plane) < 0)
        crosses &= (x > -_SLACK) & (x < 1 + _SLACK) & (y > -_SLACK) & (y < 1 + _SLACK)
        crosses &= dr.dot(normal, toward) > _FACING
        masks |= dr.select(crosses | every, mi.UInt32(1) << (number & 31), 0)
        number += 1
    return masks
