"""Cells of a room for path guiding, by position and normal.

Sampling probabilities learned at a few points of a cell are used for all points of the
cell with similar normals.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.upload import vectors

# Cell size [m], increased if an axis would need more cells than the limit; fraction of
# points outside the grid at either end of an axis, which belong to the boundary cells.
_SIZE, _MOST = 0.75, 16
_OUTLYING = 0.01

# Number of classes of normals: nearest direction of ±x, ±y and ±z.
_FACINGS = 6


@dataclass
class GuidingCells:
    """A grid with six cells per position, one for each class of normals.

    `low` is the corner of the grid and `size` the cell size [m]. `shape` is the number
    of positions along each axis, `count` the number of all cells.
    """

    low: mi.Point3f
    size: mi.Vector3f
    shape: mi.Vector3u
    count: int

    @classmethod
    def around(cls, point: Float[np.ndarray, "n 3"]) -> "GuidingCells":
        """Return a grid that covers points; without points, a grid of one position."""
        low, size, shape = np.zeros(3), np.ones(3), np.ones(3, dtype=int)
        if len(point):
            low, high = np.quantile(point, [_OUTLYING, 1 - _OUTLYING], axis=0)
            extent = np.maximum(high - low, 1e-3)
            shape = np.clip(np.ceil(extent / _SIZE), 1, _MOST).astype(int)
            size = extent / shape
        return cls(
            vectors(mi.Point3f, low[None]),
            vectors(mi.Vector3f, size[None]),
            vectors(mi.Vector3u, shape[None]),
            int(shape.prod()) * _FACINGS,
        )

    def number(self, point: mi.Point3f, normal: mi.Vector3f) -> mi.UInt32:
        """Return the index of the cell that contains a surface point with a normal."""
        place = (point - self.low) / self.size
        number = mi.UInt32(0)
        for here, cells in zip(place, self.shape, strict=True):
            last = mi.Float(cells - 1)
            number = number * cells + mi.UInt32(dr.clip(here, 0, last))
        size = dr.abs(normal)
        upright = (size.z >= size.x) & (size.z >= size.y)
        axis = dr.select(upright, 2, dr.select(size.x >= size.y, 0, 1))
        along = dr.select(upright, normal.z, dr.select(axis == 0, normal.x, normal.y))
        facing = mi.UInt32(axis) * 2 + dr.select(along > 0, mi.UInt32(1), mi.UInt32(0))
        return number * _FACINGS + facing
