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

    Their row is counted within the launch (`row`) and in the whole matrix (`number`);
    `slot` numbers rows and batches within the launch. The sample numbers are those of
    the paths' first vertex.
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
    """Return outward rays from the patches of one window, distributed over its area.

    A row of a daylight matrix is the radiance incident from one patch. Unscattered
    light keeps its patch index, so rays are traced against the patch's direction.
    """
    numbers = paths.numbers
    a, b = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
    u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
    point, number = window.sample_point(a, b)
    local = window.tables[0].sample(paths.number, u, v)
    return mi.Ray3f(point, -window.to_scene(number, local))
