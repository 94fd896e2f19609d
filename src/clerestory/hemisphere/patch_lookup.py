"""Fast look-up of the patches of a partition for very many directions.

A fine grid over the disc below the hemisphere names the patch of every cell that no
border crosses. Directions in the other cells, a few in a hundred, are looked up in
the partition itself, so the answers are those of `RingPartition.find`.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float, Int, Int16

from clerestory.array_types import Directions, Indices, Values
from clerestory.hemisphere.partition import RingPartition

# The grid: cells along an axis, and their range, which keeps the lines of the grid off
# the borders that partitions have at x = 0, y = 0 and on the diagonals.
_CELLS = 640
_LEAST, _MOST = -1.00471, 1.00313

# A patch number that stands for a cell with a border.
_BORDER = -1

# Lengths may be this far from 1 for the disc to tell the direction.
_NOT_UNIT = 1e-5

# Fewer directions than this are not worth the grid, which takes 0.1 s to make.
_FEW = 1 << 11


@dataclass(frozen=True, eq=False)
class PatchTable:
    """Patches of a grid over the disc.

    Attributes
    ----------
    partition : what is looked up
    patch : patch of each cell, x-major; -1 where a border crosses it
    """

    partition: RingPartition
    patch: Int16[np.ndarray, " cells"]

    def find(self, x: Values, y: Values, z: Values) -> Indices:
        """Patch that holds each direction; those below the rim count as mirrored up."""
        length = x * x + y * y + z * z
        length -= 1
        if np.abs(length, out=length).max(initial=0) > _NOT_UNIT:
            return _find(self.partition, x, y, z)
        scale = _CELLS / (_MOST - _LEAST)
        column, row = ((c * scale - _LEAST * scale).astype(np.int32) for c in (x, y))
        column *= _CELLS
        column += row
        patch = np.take(self.patch, column, mode="clip")
        border = np.flatnonzero(patch == _BORDER)
        patch[border] = _find(self.partition, x[border], y[border], z[border])
        return patch


def find_patches(partition: RingPartition, direction: Directions) -> Indices:
    """Patch that holds each unit vector; those below the rim count as mirrored up.

    >>> from clerestory.hemisphere.klems import klems
    >>> find_patches(klems("full"), np.array([[0.6, 0.0, -0.8]])).tolist()
    [45]
    """
    x, y, z = direction.T
    if len(x) < _FEW or len(partition) > np.iinfo(np.int16).max:
        return _find(partition, x, y, z)
    return patch_table(partition).find(x, y, z)


def patch_table(partition: RingPartition) -> PatchTable:
    """Return the table of a partition, made when it is first asked for."""
    theta, count = np.asarray(partition.theta, float), np.asarray(partition.count, int)
    return _table(partition.azimuth, theta.tobytes(), count.tobytes())


@lru_cache(maxsize=8)
def _table(
    azimuth: Literal["compass", "polar"], theta: bytes, count: bytes
) -> PatchTable:
    # Partitions of other names that cut the hemisphere alike share a table
    partition = RingPartition(
        "table", np.frombuffer(count, dtype=int), np.frombuffer(theta), azimuth
    )
    line = np.linspace(_LEAST, _MOST, _CELLS + 1)
    corner = _on_disc(partition, *np.meshgrid(line, line, indexing="ij"))

    # A sector that holds all corners of a cell can only be left towards the pole
    nearest = np.clip(0, line[:-1], line[1:])
    middle = _on_disc(partition, *np.meshgrid(nearest, nearest, indexing="ij"))
    ring = np.repeat(np.arange(len(partition.count)), partition.count)
    one = corner[1:, 1:]
    inside = ring[one] == ring[middle]
    for other in (corner[:-1, :-1], corner[1:, :-1], corner[:-1, 1:]):
        inside &= one == other
    patch = np.where(inside, one, _BORDER).astype(np.int16)
    return PatchTable(partition, patch.ravel())


def _on_disc(
    partition: RingPartition,
    x: Float[np.ndarray, "row column"],
    y: Float[np.ndarray, "row column"],
) -> Int[np.ndarray, "row column"]:
    # Patches below points of the disc; beyond its rim those at the rim
    height = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    return _find(partition, x.ravel(), y.ravel(), height.ravel()).reshape(x.shape)


def _find(partition: RingPartition, x: Values, y: Values, z: Values) -> Indices:
    # The rim is in
    height = np.maximum(np.abs(z), 1e-300)
    return partition.find(np.stack([x, y, height], axis=-1))
