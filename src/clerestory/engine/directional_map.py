"""Radiance over all directions as a table: two squares, above and below the horizon.

A hemisphere is mapped to a disc by r² = 1 − |z|, which preserves relative solid angle,
and the disc to a square by Shirley and Chiu's map. All cells have equal solid angle; a
cell of a 512 × 512 table is 0.3° wide. Radiance is interpolated between cell centres,
never across the horizon.
"""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.square import square_from_disc
from clerestory.engine.upload import on_device
from clerestory.hemisphere.shirley_chiu import cell_centres, disc_from_square


def map_directions(edge: int) -> Float[np.ndarray, "n 3"]:
    """Return unit vectors through the cell centres, in the order of the tables.

    The number of cells along an edge (`edge`) is a power of two.
    """
    x, y = disc_from_square(*cell_centres(edge.bit_length() - 1))
    height = 1 - (x * x + y * y)
    scale = np.sqrt(1 + height)
    up = np.stack([x * scale, y * scale, height], axis=-1)
    return np.concatenate([up, up * [1, 1, -1]])


class DirectionalMap:
    """One or several tables of radiance over all directions.

    Each table holds the RGB radiance in the directions `map_directions(edge)`.
    """

    def __init__(self, values: Float[np.ndarray, "table n 3"], edge: int):
        self.edge = edge
        self.values = on_device(mi.Float, values)

    def look_up(self, direction, table=0):
        """Return the interpolated radiance of a table in a direction."""
        height = dr.minimum(dr.abs(direction.z), 1)
        scale = dr.rsqrt(1 + height)
        place = square_from_disc(direction.x * scale, direction.y * scale)
        place = dr.clip(place * self.edge - 0.5, 0, self.edge - 1)
        corner = dr.minimum(mi.Point2u(place), self.edge - 2)
        part = place - mi.Point2f(corner)
        below = dr.select(direction.z >= 0, mi.UInt32(0), mi.UInt32(self.edge**2))
        first = mi.UInt32(table) * (2 * self.edge**2) + below
        found = mi.Color3f(0)
        for i in range(2):
            for j in range(2):
                cell = first + (corner.x + i) * self.edge + corner.y + j
                share = (part.x if i else 1 - part.x) * (part.y if j else 1 - part.y)
                found += share * dr.gather(mi.Color3f, self.values, cell)
        return found
