"""Lookup table of patch indices for large numbers of directions.

A fine grid over the projected hemisphere stores the patch of every cell that no patch
boundary crosses. Directions in the remaining few per cent of cells are looked up in the
partition, so that patch indices equal those of `RingPartition.find`.
"""

from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float, Int, Int16

from clerestory.array_types import Directions, Indices, Values
from clerestory.hemisphere.partition import RingPartition

# Number of cells along each axis, and limits of the grid in x and y. No grid line
# coincides with patch boundaries at x = 0, y = 0 or on the diagonals.
_CELLS = 640
_LEAST, _MOST = -1.00471, 1.00313

# Table entry of a cell that a patch boundary crosses.
_BORDER = -1

# Largest difference between 1 and the squared length of a unit vector.
_NOT_UNIT = 1e-5

# Smallest number of directions for which a table is built, which takes 0.1 s.
_FEW = 1 << 11


def find_patches(partition: RingPartition, direction: Directions) -> Indices:
    """Patch index of each unit vector; downward vectors are mirrored upwards.

    >>> from clerestory.hemisphere.klems import klems
    >>> find_patches(klems("full"), np.array([[0.6, 0.0, -0.8]])).tolist()
    [45]
    """
    x, y, z = direction.T
    if len(x) < _FEW or len(partition) > np.iinfo(np.int16).max:
        return _find(partition, x, y, z)
    length = x * x + y * y + z * z
    length -= 1
    if np.abs(length, out=length).max(initial=0) > _NOT_UNIT:
        return _find(partition, x, y, z)
    theta, count = np.asarray(partition.theta, float), np.asarray(partition.count, int)
    table = _table(partition.azimuth, theta.tobytes(), count.tobytes())
    scale = _CELLS / (_MOST - _LEAST)
    column, row = ((c * scale - _LEAST * scale).astype(np.int32) for c in (x, y))
    column *= _CELLS
    column += row
    patch: np.ndarray = np.take(table, column, mode="clip")
    border = np.flatnonzero(patch == _BORDER)
    patch[border] = _find(partition, x[border], y[border], z[border])
    return patch


@lru_cache(maxsize=8)
def _table(
    azimuth: Literal["compass", "polar"], theta: bytes, count: bytes
) -> Int16[np.ndarray, " cells"]:
    # Patch of each grid cell, x-major; the name of the partition has no effect
    partition = RingPartition(
        "table", np.frombuffer(count, dtype=int), np.frombuffer(theta), azimuth
    )
    line = np.linspace(_LEAST, _MOST, _CELLS + 1)
    corner = _on_disc(partition, *np.meshgrid(line, line, indexing="ij"))

    # If all corners of a cell are in one patch, only the point of the cell nearest the
    # pole may be in another patch
    nearest = np.clip(0, line[:-1], line[1:])
    middle = _on_disc(partition, *np.meshgrid(nearest, nearest, indexing="ij"))
    ring = np.repeat(np.arange(len(partition.count)), partition.count)
    one = corner[1:, 1:]
    inside = ring[one] == ring[middle]
    for other in (corner[:-1, :-1], corner[1:, :-1], corner[:-1, 1:]):
        inside &= one == other
    return np.where(inside, one, _BORDER).astype(np.int16).ravel()


def _on_disc(
    partition: RingPartition,
    x: Float[np.ndarray, "row column"],
    y: Float[np.ndarray, "row column"],
) -> Int[np.ndarray, "row column"]:
    # Patches at points of the unit disc; points outside are projected onto the circle
    height = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    return _find(partition, x.ravel(), y.ravel(), height.ravel()).reshape(x.shape)


def _find(partition: RingPartition, x: Values, y: Values, z: Values) -> Indices:
    # Horizontal directions belong to the outermost ring
    return partition.find(np.stack([x, y, np.maximum(np.abs(z), 1e-300)], axis=-1))
