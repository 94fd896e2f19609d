"""Direction of the main beam of a scattered distribution.

The beam direction is the centroid of all directions near the peak with at least half of
its BSDF, which is less sensitive to noise than the peak itself.
"""

import numpy as np

from clerestory.array_types import Vector
from clerestory.gonio.angles import angle_between
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.raster import Raster

# Largest distance from the peak of directions of the same beam [rad].
_REACH = np.radians(20.0)

# Resolution of the grid, and fewest cells for a centroid.
_HALVINGS, _FEWEST = 6, 8


def beam_direction(lobes: Lobes, *, near: Vector | None = None) -> Vector:
    """Direction of the strongest beam, or of the local maximum near a direction.

    >>> centre = np.array([[0, 0.6, 0.8]])
    >>> spot = Lobes(centre, np.array([0.2]), np.array([0.5]))
    >>> bool(angle_between(beam_direction(spot), centre[0]) < 0.01)
    True
    """
    peak = lobes.strongest() if near is None else lobes.climb(near)
    grid = Raster.of(_HALVINGS).directions[-1]
    grid = grid[angle_between(grid, peak) < _REACH]
    values = lobes.evaluate(grid)
    bright = values >= lobes.evaluate(peak[None])[0] / 2
    if bright.sum() < _FEWEST:
        return peak
    middle = values[bright] @ grid[bright]
    return np.asarray(middle / np.linalg.norm(middle))
