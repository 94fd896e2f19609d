"""Cells of exit directions in which a BSDF is constant, or nearly so."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, UInt32

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square
from clerestory.scene.window_zones import CELLS, EDGE, cell_directions

# Largest number of halvings of a grid of exit cells
_FINEST = 9

# Smallest number of halvings for trees of rank 3
_TURNED = 7


@dataclass(frozen=True, eq=False)
class ExitCells:
    """Exit cells of the BSDF of a window.

    Attributes
    ----------
    key : partition, or the number of halvings of a tensor tree
    number : cell of each cell of a code; see `scene.window_zones`
    directions : representative directions, in the window's frame
    corners : low corners of cells of a square grid; None for other cells
    """

    key: object
    number: UInt32[np.ndarray, " code"]
    directions: Float[np.ndarray, "cell 3"]
    corners: Float[np.ndarray, "cell 2"] | None = None

    @classmethod
    def of(cls, bsdf: Bsdf) -> "ExitCells":
        """Return the exit cells of the transmission towards the room."""
        part = bsdf.scattering("transmission_front")
        tree = _tree(part)
        if tree is None:
            first = bsdf.function("transmission_front").exits
            return _patches_of(first)
        # Rank 3 trees turn with the azimuth of the sun: smaller cells follow them
        turns = tree.rank == 3
        return _halved(
            min(max(tree.depth + 1, _TURNED) if turns else tree.depth, _FINEST)
        )


def _tree(part: ScatteringFunction) -> ScatteringTree | None:
    if isinstance(part, ScatteringTree):
        return part
    if isinstance(part, ScatteringMatrix):
        return None
    return _tree(part.reciprocal())


@lru_cache(maxsize=4)
def _patches_of(partition: RingPartition) -> ExitCells:
    number = partition.find(cell_directions()).astype(np.uint32)
    return ExitCells(partition, number, partition.centres())


@lru_cache(maxsize=4)
def _halved(halvings: int) -> ExitCells:
    row, column = np.divmod(np.arange(CELLS, dtype=np.uint32), np.uint32(EDGE))
    shift = np.uint32(EDGE.bit_length() - 1 - halvings)
    number = ((row >> shift) << np.uint32(halvings)) + (column >> shift)
    centres = cell_centres(halvings)
    corners = np.stack(centres, axis=-1) - 0.5 / (1 << halvings)
    return ExitCells(halvings, number, directions_from_square(*centres), corners)
