"""Earth mover's distance and beam direction of scattered distributions.

The beam direction is the centroid of the directions near the peak where the BSDF is at
least half of the peak value; it is less sensitive to noise than the peak itself.
"""

import functools

import numpy as np
import ot
from jaxtyping import Float

from clerestory.array_types import Values, Vector
from clerestory.gonio.angles import angle_between
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.raster import Raster
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square

# log2 of the number of grid cells along each axis: for the distance, and for the finer
# grid on which lobes are rasterized.
_HALVINGS, _DRAWN = 4, 6

# Cells with less than this fraction of the total flux are ignored.
_LEAST = 1e-6


def earth_movers_distance(one: Lobes, other: Lobes) -> float:
    """Earth mover's distance: mean angle by which flux must be moved [rad].

    Distributions are normalized and sampled on cells of equal projected solid angle, 7°
    wide at the normal. The result is NaN if either distribution has no flux.

    >>> a = Lobes(np.array([[0, 0, 1.0]]), np.array([0.1]), np.array([0.5]))
    >>> b = Lobes(np.array([[0, 0.6, 0.8]]), np.array([0.1]), np.array([0.2]))
    >>> abs(earth_movers_distance(a, b) - float(np.arccos(0.8))) < 0.02
    True
    """
    if not (one.total > 0 and other.total > 0):
        return float("nan")
    give, take = _light(one), _light(other)
    some, others = give > _LEAST, take > _LEAST
    give, take = give[some] / give[some].sum(), take[others] / take[others].sum()
    cost = _angles()[np.ix_(some, others)]
    return float(ot.emd2(give, take, cost, numItermax=1_000_000))


def _light(lobes: Lobes) -> Values:
    wide, part = 1 << _HALVINGS, 1 << _DRAWN - _HALVINGS
    cells = Raster.of(_DRAWN).cells(lobes).reshape(wide, part, wide, part)
    light = cells.sum(axis=(1, 3)).ravel()
    return np.asarray(light / light.sum())


@functools.cache
def _angles() -> Float[np.ndarray, "cells cells"]:
    direction = directions_from_square(*cell_centres(_HALVINGS))
    return angle_between(direction[:, None], direction)


# Directions farther from the peak are not part of the beam [rad].
_REACH = np.radians(20.0)

# log2 of the number of grid cells along each axis, and smallest number of cells for a
# centroid; the peak itself is used if there are fewer cells.
_BEAM_HALVINGS, _FEWEST = 6, 8


def beam_direction(lobes: Lobes, *, near: Vector | None = None) -> Vector:
    """Direction of the strongest beam, or of the local maximum near a direction.

    >>> centre = np.array([[0, 0.6, 0.8]])
    >>> spot = Lobes(centre, np.array([0.2]), np.array([0.5]))
    >>> bool(angle_between(beam_direction(spot), centre[0]) < 0.01)
    True
    """
    peak = lobes.strongest() if near is None else lobes.climb(near)
    grid = Raster.of(_BEAM_HALVINGS).directions[-1]
    grid = grid[angle_between(grid, peak) < _REACH]
    values = lobes.evaluate(grid)
    bright = values >= lobes.evaluate(peak[None])[0] / 2
    if bright.sum() < _FEWEST:
        return peak
    middle = values[bright] @ grid[bright]
    return np.asarray(middle / np.linalg.norm(middle))
