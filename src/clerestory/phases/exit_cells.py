"""Cells of exit directions in which a BSDF is constant, or nearly so."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int, UInt32

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square
from clerestory.scene.window_zones import CELLS, EDGE, cell_directions

# Largest number of halvings of a grid of exit cells
_FINEST = 9


@dataclass(frozen=True, eq=False)
class ExitCells:
    """Exit cells of the BSDF of a window.

    Attributes
    ----------
    key : partition, or the number of halvings of a tensor tree
    number : cell of each cell of a code; see `scene.window_zones`
    directions : representative directions, in the window's frame
    sizes : projected solid angles of the cells [sr]
    """

    key: RingPartition | int
    number: UInt32[np.ndarray, " code"]
    directions: Float[np.ndarray, "cell 3"]
    sizes: Float[np.ndarray, " cell"]

    def sample(
        self, cell: Int[np.ndarray, "*batch"], u: Float[np.ndarray, "*batch 2"]
    ) -> Float[np.ndarray, "*batch 3"]:
        """Return directions in cells, uniform in projected solid angle."""
        if isinstance(self.key, RingPartition):
            return self.key.sample(cell, u)
        edge = 1 << self.key
        place = (np.stack(np.divmod(cell, edge), axis=-1) + u) / edge
        return directions_from_square(place[..., 0], place[..., 1])

    @classmethod
    def of(cls, bsdf: Bsdf) -> "ExitCells":
        """Return the exit cells of the transmission towards the room."""
        part = bsdf.scattering("transmission_front")
        tree = _tree(part)
        if tree is None:
            first = bsdf.function("transmission_front").exits
            return _patches_of(first)
        # Rank 3 trees turn with the azimuth of the sun: cells half as large follow them
        return _halved(min(tree.depth + (tree.rank == 3), _FINEST))


def _tree(part: ScatteringFunction) -> ScatteringTree | None:
    if isinstance(part, ScatteringTree):
        return part
    if isinstance(part, ScatteringMatrix):
        return None
    return _tree(part.reciprocal())


@lru_cache(maxsize=4)
def _patches_of(partition: RingPartition) -> ExitCells:
    number = partition.find(cell_directions()).astype(np.uint32)
    return ExitCells(
        partition, number, partition.centres(), partition.projected_solid_angles()
    )


@lru_cache(maxsize=4)
def _halved(halvings: int) -> ExitCells:
    row, column = np.divmod(np.arange(CELLS, dtype=np.uint32), np.uint32(EDGE))
    shift = np.uint32(EDGE.bit_length() - 1 - halvings)
    number = ((row >> shift) << np.uint32(halvings)) + (column >> shift)
    cells = 1 << 2 * halvings
    centres = directions_from_square(*cell_centres(halvings))
    return ExitCells(halvings, number, centres, np.full(cells, np.pi / cells))
