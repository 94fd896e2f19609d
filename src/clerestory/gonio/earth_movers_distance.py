"""Earth mover's distance between two scattered distributions."""

import functools

import numpy as np
import ot
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.gonio.angles import angle_between
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.raster import Raster
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square

# Halvings of the cells of the distance, and of those that lobes are rasterized on.
_HALVINGS, _DRAWN = 4, 6

# Smallest fraction of the flux of a cell.
_LEAST = 1e-6


def earth_mover(one: Lobes, other: Lobes) -> float:
    """Mean angle by which flux must be moved to turn one distribution into another
    [rad].

    Distributions are normalized, on cells of equal projected solid angle that are 7°
    wide at the normal. NaN if one has no flux.

    >>> a = Lobes(np.array([[0, 0, 1.0]]), np.array([0.1]), np.array([0.5]))
    >>> b = Lobes(np.array([[0, 0.6, 0.8]]), np.array([0.1]), np.array([0.2]))
    >>> abs(earth_mover(a, b) - float(np.arccos(0.8))) < 0.02
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
