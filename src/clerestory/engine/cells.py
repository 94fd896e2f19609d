"""Cells of a room, by place and by the way a surface faces.

What is known of light at a few places, such as which portals are bright, holds for the
surfaces around them that face alike.
"""

import math
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

# Size of a cell [m], grown where an axis would need more than so many; points beyond
# the outermost share of those given belong to the cells at the rim.
_SIZE, _MOST = 0.75, 16
_OUTLYING = 0.01

# Ways to face: along the axes, either way.
_FACINGS = 6


@dataclass
class Cells:
    """A grid, with six cells at each of its places.

    Attributes
    ----------
    low : corner of the grid [m]
    size : of the cells along each axis [m]
    shape : cells along each axis
    """

    low: mi.Point3f
    size: mi.Vector3f
    shape: tuple[int, int, int]

    @classmethod
    def around(cls, point: Float[np.ndarray, "n 3"]) -> "Cells":
        """Return cells around points; without any, one place for everything."""
        if len(point) == 0:
            return cls(mi.Point3f(0), mi.Vector3f(1), (1, 1, 1))
        low, high = np.quantile(point, [_OUTLYING, 1 - _OUTLYING], axis=0)
        extent = np.maximum(high - low, 1e-3)
        shape = np.clip(np.ceil(extent / _SIZE), 1, _MOST).astype(int)
        place, size = low.tolist(), (extent / shape).tolist()
        along = (int(shape[0]), int(shape[1]), int(shape[2]))
        cells = cls(mi.Point3f(*place), mi.Vector3f(*size), along)
        dr.make_opaque(cells.low, cells.size)
        return cells

    @property
    def count(self) -> int:
        """Number of cells."""
        return math.prod(self.shape) * _FACINGS

    def number(self, point: mi.Point3f, normal: mi.Vector3f) -> mi.UInt32:
        """Return the cell of a place whose surface faces along a normal."""
        place = (point - self.low) / self.size
        number = mi.UInt32(0)
        for axis, cells in enumerate(self.shape):
            here = mi.UInt32(dr.clip(place[axis], 0, cells - 1))
            number = number * cells + here
        size = dr.abs(normal)
        upright = (size.z >= size.x) & (size.z >= size.y)
        axis = dr.select(upright, 2, dr.select(size.x >= size.y, 0, 1))
        along = dr.select(upright, normal.z, dr.select(axis == 0, normal.x, normal.y))
        facing = mi.UInt32(axis) * 2 + dr.select(along > 0, mi.UInt32(1), mi.UInt32(0))
        return number * _FACINGS + facing
