"""Primary rays of matrices: numbering of paths, and rays from window patches.

A launch traces all given rows, batches and sample points: lane index =
(row × batches + batch) × points + point.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.sampler import (
    CONNECT_U,
    CONNECT_V,
    DIRECTION_U,
    DIRECTION_V,
    PathNumbers,
    Points,
)
from clerestory.engine.upload import on_device
from clerestory.engine.windows import WindowTable


@dataclass
class Lanes:
    """Paths of one launch.

    Each path has the index of its row within the launch (`row`) and in the matrix
    (`number`), the index of its row and batch within the launch (`slot`), and the
    sample numbers of its first vertex (`numbers`).
    """

    row: mi.UInt32
    slot: mi.UInt32
    number: mi.UInt32
    numbers: PathNumbers


def lanes(
    points: Points, *, rows: np.ndarray, batches: int, seed: int, stream: int
) -> Lanes:
    """Return the paths of a launch over the matrix rows with the given indices.

    Different streams make matrices with the same seed independent, as required for V
    and D. The seed of a row and batch depends only on their indices, so results do not
    depend on the division of rows into launches.
    """
    lane = dr.arange(mi.UInt32, len(rows) * batches * points.count)
    slot = lane // points.stride
    row = slot // batches
    number = dr.gather(mi.UInt32, on_device(mi.UInt32, rows), row)
    absolute = number * batches + slot % batches
    key = mi.sample_tea_32(absolute, dr.opaque(mi.UInt32, seed))[stream]
    first = PathNumbers(points, key, lane % points.stride, mi.UInt32(0))
    return Lanes(row, slot, number, first)


def window_ray(window: WindowTable, paths: Lanes) -> mi.Ray3f:
    """Return rays from random points of a window outwards, in directions of patches.

    A row of a daylight matrix is the radiance incident on the window from one patch. A
    patch index refers to the direction of travel into the room, which is unchanged by
    unscattered transmission; rays are traced in the opposite direction.
    """
    numbers = paths.numbers
    a, b = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
    u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
    direction = window.to_scene(
        mi.UInt32(0), window.tables[0].sample(paths.number, u, v)
    )
    return mi.Ray3f(window.sample_point_along(direction, a, b), -direction)
