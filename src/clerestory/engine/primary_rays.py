"""Primary rays of matrices: numbering of paths, and rays from patches of windows.

Each launch covers all rows, batches and sample points it is given: lane number =
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

    def numbers(self, points: Points) -> PathNumbers:
        """Return the sample numbers of the paths' first vertex."""
        return PathNumbers(points, self.seed, self.index, mi.UInt32(0))


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


def window_ray(window: WindowTable, patch: mi.UInt32, numbers: PathNumbers) -> mi.Ray3f:
    """Return rays outwards from the patches of one window, spread over its area.

    A row of a daylight matrix is the light that arrives through one patch.
    Straight-through light keeps its patch number, so rays leave against the patch's
    direction.

    Parameters
    ----------
    window : table of this window alone
    """
    a, b = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
    u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
    point, number = window.sample_point(a, b)
    local = window.tables[0].sample(patch, u, v)
    return mi.Ray3f(point, -window.to_scene(number, local))
