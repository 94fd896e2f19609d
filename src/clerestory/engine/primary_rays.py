"""Where paths begin: at irradiance sensors, or on the outer side of windows.

Each launch covers all rows, batches and sample points it is given: lane number =
(row × batches + batch) × points + point.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine import sampler
from clerestory.engine.sampler import Points
from clerestory.engine.upload import on_device, vectors
from clerestory.engine.walk import (
    CONNECTIONS,
    Target,
    connect,
    spread,
    visibility,
    walk,
)
from clerestory.engine.windows import WindowTable


@dataclass
class Lanes:
    """The paths of one launch.

    Attributes
    ----------
    row : row of the matrix, counted within the launch
    slot : row and batch within the launch
    number : number of the row in the whole matrix
    seed : of the row and batch in the whole trace
    index : number of the sample point in the table
    """

    row: mi.UInt32
    slot: mi.UInt32
    number: mi.UInt32
    seed: mi.UInt32
    index: mi.UInt32


def lanes(
    points: Points, *, rows: np.ndarray, batches: int, seed: int, stream: int
) -> Lanes:
    """Return the paths of a launch over the matrix rows with the given numbers.

    Streams keep matrices of one seed independent: errors of V and D must not agree.

    The seed of a row and batch depends on nothing but their numbers, so results do
    not depend on how rows are spread over launches.
    """
    lane = dr.arange(mi.UInt32, len(rows) * batches * points.count)
    slot = lane // points.stride
    row = slot // batches
    number = dr.gather(mi.UInt32, on_device(mi.UInt32, rows), row)
    absolute = number * batches + slot % batches
    return Lanes(
        row=row,
        slot=slot,
        number=number,
        seed=mi.sample_tea_32(absolute, dr.opaque(mi.UInt32, seed))[stream],
        index=lane % points.stride,
    )


def trace_sensors(
    target: Target,
    points: Points,
    paths: Lanes,
    *,
    position: np.ndarray,
    normal: np.ndarray,
    segments: int,
) -> None:
    """Trace from irradiance sensors; what meets unit radiance everywhere sums to π.

    Parameters
    ----------
    position, normal : (rows, 3) in the device's frame [m]
    segments : most segments of a path, the first from the sensor included
    """
    o = dr.gather(mi.Point3f, vectors(mi.Point3f, position), paths.row)
    n = dr.gather(mi.Vector3f, vectors(mi.Vector3f, normal), paths.row)
    first = mi.UInt32(0)
    seed, index = paths.seed, paths.index
    limit = dr.opaque(mi.UInt32, segments)
    channels = mi.Color3f(1)

    if target.sky is None:
        # Connect each sensor to points of the windows
        a = sampler.coordinate(points, seed, index, first, sampler.CONNECT_U)
        b = sampler.coordinate(points, seed, index, first, sampler.CONNECT_V)
        for number in range(CONNECTIONS):
            line = connect(target.model, o, *spread(a, b, number))
            cosine = dr.dot(n, line.direction)
            lit = line.valid & (cosine > 0)
            seen = visibility(target.model, o, line, lit)
            density = CONNECTIONS * line.pdf + cosine * dr.inv_pi
            gain = channels * seen * cosine / density
            target.score(paths.slot, line.column, gain, lit & (dr.max(seen) > 0))

    # Leave each sensor in a cosine-distributed direction
    u = sampler.coordinate(points, seed, index, first, sampler.DIRECTION_U)
    v = sampler.coordinate(points, seed, index, first, sampler.DIRECTION_V)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    ray = mi.Ray3f(o, mi.Frame3f(n).to_world(local))
    pdf = local.z * dr.inv_pi
    active = local.z > 0
    weight = channels * dr.pi
    walk(target, points, ray, weight, pdf, paths.slot, seed, index, active, limit)


def trace_window_patches(
    target: Target, points: Points, paths: Lanes, *, window: WindowTable, segments: int
) -> None:
    """Trace outwards from the patches of one window; an open window's rows sum to 1.

    A row stands for the light that arrives through one patch. Straight-through light
    keeps its patch number, so paths leave against the patch's direction.

    Parameters
    ----------
    window : table of this window alone
    segments : most segments of a path, the first from the window included
    """
    seed, index = paths.seed, paths.index
    first = mi.UInt32(0)
    a = sampler.coordinate(points, seed, index, first, sampler.CONNECT_U)
    b = sampler.coordinate(points, seed, index, first, sampler.CONNECT_V)
    u = sampler.coordinate(points, seed, index, first, sampler.DIRECTION_U)
    v = sampler.coordinate(points, seed, index, first, sampler.DIRECTION_V)
    o, number = window.sample_point(a, b)
    local = window.tables[0].sample(paths.number, u, v)
    ray = mi.Ray3f(o, -window.to_scene(number, local))
    active = mi.Bool(local.z > 0)
    weight, pdf = mi.Color3f(1), mi.Float(0)
    limit = dr.opaque(mi.UInt32, segments)
    walk(target, points, ray, weight, pdf, paths.slot, seed, index, active, limit)
