"""Cells of exit and incident directions in which a BSDF is constant, or nearly so."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int, UInt32

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import (
    cell_centres,
    cells_from_disc,
    directions_from_square,
)
from clerestory.scene.window_zones import DIRECTION_BITS

# Finest grid of exit cells: 2ⁿ × 2ⁿ
_FINEST = 9

# Coarsest grid for trees of rank 3
_TURNED = 8

# Number of sectors into which incident directions are divided for trees of rank 3
_SECTORS = 128

# Number of halvings of the grid on which patches are tabulated, mark of cells that
# belong to several patches, and bits of a recorded direction
_HALVINGS, _BORDER = 10, 0xFFFFFFFF
_BITS, _MASK = np.uint32(DIRECTION_BITS), np.uint32((1 << DIRECTION_BITS) - 1)


@dataclass(frozen=True, eq=False)
class ExitCells:
    """Exit cells of the BSDF of a window.

    Attributes
    ----------
    key : partition, or the number of halvings of a tensor tree
    directions : representative directions, in the window's frame
    sizes : projected solid angles of the cells [sr]
    """

    key: RingPartition | int
    directions: Float[np.ndarray, "cell 3"]
    sizes: Float[np.ndarray, " cell"]

    @classmethod
    def of(cls, bsdf: Bsdf) -> "ExitCells":
        """Return the exit cells of the transmission towards the room."""
        part = bsdf.scattering("transmission_front")
        tree = _tree(part)
        if tree is None:
            return cls.of_partition(bsdf.function("transmission_front").exits)
        # Rank 3 trees turn with the azimuth of the sun: smaller cells follow them
        halvings = tree.depth if tree.rank == 4 else max(tree.depth + 1, _TURNED)
        return _halved(min(halvings, _FINEST))

    @classmethod
    def of_partition(cls, partition: RingPartition) -> "ExitCells":
        """Return the patches of a partition as cells."""
        sizes = partition.projected_solid_angles()
        return cls(partition, partition.centres(), sizes)

    def find(
        self, directions: UInt32[np.ndarray, " contribution"]
    ) -> UInt32[np.ndarray, " contribution"]:
        """Return the cells of recorded exit directions; see `scene.window_zones`."""
        row, column = directions >> _BITS, directions & _MASK
        if not isinstance(self.key, RingPartition):
            shift = _BITS - np.uint32(self.key)
            return ((row >> shift) << np.uint32(self.key)) + (column >> shift)
        few = _BITS - np.uint32(_HALVINGS)
        coarse = ((row >> few) << np.uint32(_HALVINGS)) + (column >> few)
        found = _patches(self.key)[coarse]
        border = np.flatnonzero(found == _BORDER)
        size = 1 << int(_BITS)
        places = ((part[border] + 0.5) / size for part in (row, column))
        found[border] = self.key.find(directions_from_square(*places))
        return np.asarray(found)

    def sample(
        self, cell: Int[np.ndarray, "*batch"], u: Float[np.ndarray, "*batch 2"]
    ) -> Float[np.ndarray, "*batch 3"]:
        """Return directions in cells, uniform in projected solid angle."""
        if isinstance(self.key, RingPartition):
            return self.key.sample(cell, u)
        edge = 1 << self.key
        place = (np.stack(np.divmod(cell, edge), axis=-1) + u) / edge
        return directions_from_square(place[..., 0], place[..., 1])


@dataclass(frozen=True, eq=False)
class IncidentCells:
    """Cells of incident directions, of a tensor tree or else of a partition."""

    tree: ScatteringTree | None
    partition: RingPartition | None

    @classmethod
    def of(cls, bsdf: Bsdf) -> "IncidentCells":
        """Return the cells of the transmission towards the room."""
        tree = _tree(bsdf.scattering("transmission_front"))
        if tree is not None:
            return cls(tree, None)
        return cls(None, bsdf.function("transmission_front").incidents)

    def find(self, light: Float[np.ndarray, "ray 3"]) -> Int[np.ndarray, " ray"]:
        """Return the cells of light into the room, in the window's frame."""
        if self.tree is None:
            assert self.partition is not None
            return np.asarray(self.partition.find(light))
        return _cells_of_tree(self.tree, light)


def _cells_of_tree(
    tree: ScatteringTree, light: Float[np.ndarray, "ray 3"]
) -> Int[np.ndarray, " ray"]:
    x, y = light[:, 0], light[:, 1]
    if tree.rank == 4:
        row, column = cells_from_disc(x, y, halvings=tree.depth)
        return np.asarray((row.astype(int) << tree.depth) + column)
    # Rings around the normal, and sectors in which the tree hardly turns
    ring = (1 - np.hypot(x, y)) * 2.0 ** (tree.depth - 1)
    sector = (np.arctan2(y, x) / (2 * np.pi) % 1) * _SECTORS
    return np.asarray(ring.astype(int) * _SECTORS + sector.astype(int))


def _tree(part: ScatteringFunction) -> ScatteringTree | None:
    if isinstance(part, ScatteringTree):
        return part
    if isinstance(part, ScatteringMatrix):
        return None
    return _tree(part.reciprocal())


@lru_cache(maxsize=4)
def _patches(partition: RingPartition) -> UInt32[np.ndarray, " cell"]:
    # Patch that contains each cell of a square grid, or _BORDER if several overlap it
    edge = 1 << _HALVINGS
    corner = np.arange(edge + 1) / edge
    x, y = np.meshgrid(corner, corner, indexing="ij")
    found = partition.find(directions_from_square(x, y))
    parts = found[:-1, :-1], found[1:, :-1], found[:-1, 1:], found[1:, 1:]
    same = np.logical_and.reduce([parts[0] == each for each in parts[1:]])
    return np.where(same, parts[0], _BORDER).astype(np.uint32).ravel()


@lru_cache(maxsize=4)
def _halved(halvings: int) -> ExitCells:
    cells = 1 << 2 * halvings
    centres = directions_from_square(*cell_centres(halvings))
    return ExitCells(halvings, centres, np.full(cells, np.pi / cells))
