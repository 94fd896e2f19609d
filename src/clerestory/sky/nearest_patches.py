"""Nearest sky patches of directions.

The candidates are a few patches of the rings around a direction. SciPy's search tree
takes longer to import than the search of a year of solar positions takes here.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from clerestory.hemisphere.partition import RingPartition

# Candidates: rings around that of a direction, and patches of each. Patches are at most
# 1.5 times as wide as high
_RINGS = 5
_MOST = 4


class Nearest(NamedTuple):
    """Nearest patches, in order of distance.

    Attributes
    ----------
    distance : chord from the direction to the centre of the patch
    patch : its number
    """

    distance: Float[np.ndarray, "direction neighbour"]
    patch: Int[np.ndarray, "direction neighbour"]


def nearest_patches(
    dome: RingPartition, directions: Float[np.ndarray, "direction 3"], *, count: int
) -> Nearest:
    """Return the patches of a sky whose centres are nearest to some directions.

    Parameters
    ----------
    dome : Tregenza's or Reinhart's partition, azimuths clockwise from north
    directions : unit vectors
    count : how many patches each, 1 to 4

    Examples
    --------
    >>> from clerestory.hemisphere.reinhart import reinhart
    >>> dome = reinhart(1).dome
    >>> nearest_patches(dome, dome.centres()[[7]], count=2).patch[0].tolist()[0]
    7
    """
    centres = dome.centres()
    rings = min(_RINGS, len(dome.count))

    # Take the rings around each direction, by the height of their centres
    height = np.arcsin(centres[dome.first, 2])
    altitude = np.arcsin(np.clip(directions[:, 2], -1, 1))
    own = np.abs(height[:, None] - altitude).argmin(axis=0)
    lowest = np.clip(own - rings // 2, 0, len(height) - rings)
    ring = lowest[:, None] + np.arange(rings)

    # Of each ring, take the patches around the azimuth; the first is in the north
    each = dome.count[ring]
    azimuth = np.arctan2(directions[:, 0], directions[:, 1])[:, None]
    offset = np.arange(_MOST)
    place = np.floor(azimuth * each / (2 * np.pi)).astype(int)[..., None] - 1 + offset
    patch = dome.first[ring][..., None] + place % each[..., None]

    # Choose the nearest; exclude the repeated patches of rings with fewer patches
    apart = centres[patch] - directions[:, None, None]
    distance = np.sqrt(np.einsum("drpx,drpx->drp", apart, apart))
    distance[offset >= each[..., None]] = np.inf
    table = len(directions), rings * _MOST
    distance, patch = distance.reshape(table), patch.reshape(table)
    order = np.argsort(distance, axis=1, kind="stable")[:, :count]
    return Nearest(
        np.take_along_axis(distance, order, axis=1),
        np.take_along_axis(patch, order, axis=1),
    )
