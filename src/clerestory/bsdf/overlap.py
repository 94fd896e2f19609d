"""How much of each patch of one partition lies in each cell of another.

Overlaps are counted on a fine grid of equal projected solid angles and then scaled
until the sums over patches and over cells are the exact ones. So flux that moves
from one partition to another is neither lost nor made.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse

from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.square import disc_from_square

# Halvings of the unit square down to the points that are counted.
_POINT_HALVINGS = 10

# Rounds of scaling; each brings sums nearer by a factor of about a thousand.
_ROUNDS = 12


def patches_in_cells(partition: RingPartition, halvings: int) -> sparse.csr_array:
    """Overlap of patches and cells of the unit square [sr], (patch, cell).

    Parameters
    ----------
    halvings : the cells are 2^halvings along each axis, the second running faster

    >>> from clerestory.hemisphere.klems import klems
    >>> overlap = patches_in_cells(klems("quarter"), 3)
    >>> overlap.shape, round(float(overlap.sum()), 9)
    ((41, 64), 3.141592654)
    """
    points = max(_POINT_HALVINGS, halvings + 2)
    patch = partition.find(_points(points))
    along = np.arange(1 << points) >> points - halvings
    cell = ((along[:, None] << halvings) + along).ravel()
    cells = np.full(1 << 2 * halvings, np.pi * 0.25**halvings)
    return _scaled(patch, cell, partition.projected_solid_angles(), cells)


def patches_in_patches(old: RingPartition, new: RingPartition) -> sparse.csr_array:
    """Overlap of the patches of two partitions [sr], (old, new)."""
    points = _points(_POINT_HALVINGS)
    return _scaled(
        old.find(points),
        new.find(points),
        old.projected_solid_angles(),
        new.projected_solid_angles(),
    )


def opposite_patches(partition: RingPartition) -> Int[np.ndarray, " patches"]:
    """Patch on the other side of the pole, half a turn away, for each patch."""
    return partition.find(partition.centres() * [-1, -1, 1])


def _points(halvings: int) -> Float[np.ndarray, "points 3"]:
    middle = (np.arange(1 << halvings) + 0.5) / (1 << halvings)
    a, b = np.meshgrid(middle, middle, indexing="ij")
    x, y = disc_from_square(a.ravel(), b.ravel())
    return np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 1e-300))], axis=-1)


def _scaled(
    row: Int[np.ndarray, " points"],
    column: Int[np.ndarray, " points"],
    rows: Float[np.ndarray, " rows"],
    columns: Float[np.ndarray, " columns"],
) -> sparse.csr_array:
    # Count the points, then scale rows and columns in turn
    pair, count = np.unique(row * len(columns) + column, return_counts=True)
    row, column = np.divmod(pair, len(columns))
    weight = count.astype(float)
    for _ in range(_ROUNDS):
        weight *= _ratio(rows, np.bincount(row, weight, minlength=len(rows)))[row]
        sums = np.bincount(column, weight, minlength=len(columns))
        weight *= _ratio(columns, sums)[column]
    return sparse.csr_array((weight, (row, column)), shape=(len(rows), len(columns)))


def _ratio(
    wanted: Float[np.ndarray, " sums"], is_now: Float[np.ndarray, " sums"]
) -> Float[np.ndarray, " sums"]:
    ratio: Float[np.ndarray, " sums"] = np.divide(
        wanted, is_now, out=np.ones_like(wanted), where=is_now > 0
    )
    return ratio
