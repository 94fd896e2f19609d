"""Where the beam of a distribution points: the middle of its brightest part.

The single brightest direction of a wide, flat beam is a matter of noise. The middle of
what is at least half as bright about it is not.
"""

import numpy as np

from clerestory.array_types import Vector
from clerestory.gonio.angles import angle_between
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.raster import Raster

# What is farther from the peak belongs to another beam [rad].
_REACH = np.radians(20.0)

# Cells of the grid on which the middle is found; fewer than these say no more than
# the peak itself.
_HALVINGS, _FEWEST = 6, 8


def beam_direction(lobes: Lobes, *, near: Vector | None = None) -> Vector:
    """Direction of the brightest beam, or of the one uphill of a direction.

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
