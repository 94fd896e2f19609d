"""Overlap areas between two partitions of the hemisphere.

The Shirley–Chiu map turns rings into concentric squares and azimuths into straight
lines through the centre. Each overlap area is summed over thin strips, from the exact
overlap length in each strip. The total areas per patch and per cell are exact, so that
resampling conserves flux.
"""

import numpy as np
from scipy import sparse

from clerestory.array_types import Indices, Values
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import directions_from_square

# Number of strips between consecutive cell or ring boundaries.
_STRIPS = 8

# The four triangular quarters of the square: axis (x, y) pointing outwards, and the
# perpendicular axis in the sense of increasing azimuth.
_QUARTERS = (((1, 0), (0, 1)), ((0, 1), (-1, 0)), ((-1, 0), (0, -1)), ((0, -1), (1, 0)))


def patches_in_cells(partition: RingPartition, halvings: int) -> sparse.csr_array:
    """Projected solid angle of the overlap of each patch with each cell [sr].

    `halvings`: log2 of the number of cells along each axis of the unit square; cells
    are in row-major order.
    """
    wide = 1 << halvings
    lines = 2 * np.arange(wide + 1) / wide - 1
    limits = np.unique([*np.abs(lines), 0.0, 1.0, *np.sin(partition.theta)])
    part = (np.arange(_STRIPS) + 0.5) / _STRIPS
    width = np.diff(limits)
    along = (limits[:-1, None] + width[:, None] * part).ravel()
    width = np.repeat(width / _STRIPS, _STRIPS)
    azimuth = _azimuth_limits(partition)
    shape = len(partition), wide**2
    overlap = sparse.csr_array(shape)
    for quarter, (axis, side) in enumerate(_QUARTERS):
        # Cut each strip at the cell boundaries and the azimuth limits of the patches
        turn = np.remainder(azimuth - quarter * np.pi / 2 + np.pi, 2 * np.pi) - np.pi
        slope = np.concatenate(
            [[-1.0, 1.0], turn[np.abs(turn) < np.pi / 4] * 4 / np.pi]
        )
        cuts = np.concatenate(
            [np.tile(lines, (len(along), 1)), np.outer(along, slope)], axis=1
        )
        cuts = np.sort(np.clip(cuts, -along[:, None], along[:, None]), axis=1)
        length = np.diff(cuts, axis=1)
        strip, piece = np.nonzero(length > 0)
        across = (cuts[strip, piece] + cuts[strip, piece + 1]) / 2
        a, b = (0.5 + 0.5 * (axis[i] * along[strip] + side[i] * across) for i in (0, 1))
        cell = np.minimum(np.stack([a, b]) * wide, wide - 1).astype(int)
        area = np.pi / 4 * width[strip] * length[strip, piece]
        place = partition.find(directions_from_square(a, b)), cell[0] * wide + cell[1]
        overlap = overlap + sparse.csr_array((area, place), shape=shape)
    return overlap


def patches_in_patches(old: RingPartition, new: RingPartition) -> sparse.csr_array:
    """Projected solid angle of the overlap of each old with each new patch [sr]."""
    ring = np.unique(np.sin([*old.theta, *new.theta]) ** 2)
    turn = np.unique([*_azimuth_limits(old), *_azimuth_limits(new)])
    turn = np.append(turn, turn[0] + 2 * np.pi)
    radius = np.sqrt((ring[:-1] + ring[1:]) / 2)[:, None]
    phi = (turn[:-1] + turn[1:]) / 2
    middle = np.stack(
        [
            radius * np.cos(phi),
            radius * np.sin(phi),
            np.broadcast_to(np.sqrt(1 - radius**2), (len(radius), len(phi))),
        ],
        axis=-1,
    )
    measure = np.outer(np.diff(ring) / 2, np.diff(turn))
    place = old.find(middle).ravel(), new.find(middle).ravel()
    return sparse.csr_array((measure.ravel(), place), shape=(len(old), len(new)))


def opposite_patches(partition: RingPartition) -> Indices:
    """For each patch, index of the patch 180° away in azimuth."""
    return partition.find(partition.centres() * [-1, -1, 1])


def _azimuth_limits(partition: RingPartition) -> Values:
    # Azimuth limits of the patches of all rings, from +x towards +y [rad]
    turns = [(np.arange(n) + 0.5) / n for n in np.unique(partition.count)]
    angle = 2 * np.pi * np.concatenate(turns)
    if partition.azimuth == "compass":
        angle = np.pi / 2 - angle
    return np.unique(np.remainder(angle, 2 * np.pi))
