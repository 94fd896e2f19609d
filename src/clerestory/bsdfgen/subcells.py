"""Subdivision of tree cells into scaled subcells.

A cell can have hundreds of subcells; a subcell holds only its place, the number of its
cell and a factor.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int32

from clerestory.array_types import Indices, Mask


@dataclass(frozen=True, eq=False)
class Subcells:
    """Subcells of one size.

    Attributes
    ----------
    place : Morton code of each subcell among the nodes of its level
    cell : number of the cell that contains each
    factor : ratio of the value of the subcell to that of the cell
    """

    place: Int32[np.ndarray, " piece"]
    cell: Int32[np.ndarray, " piece"]
    factor: Float32[np.ndarray, " piece"]

    def __len__(self) -> int:
        return len(self.place)

    def cut(self, split: Mask, *, rank: int) -> "tuple[Subcells, Subcells]":
        """Return the subcells that stay whole, and the branches of those to split."""
        width = 1 << rank
        place = (self.place[split, None] << rank) + np.arange(width, dtype=np.int32)
        branches = Subcells(
            place.ravel(),
            np.repeat(self.cell[split], width),
            np.repeat(self.factor[split], width),
        )
        return self.only(~split), branches

    def only(self, which: slice | Mask) -> "Subcells":
        """Return some of the subcells."""
        return Subcells(self.place[which], self.cell[which], self.factor[which])

    def beside(self, other: "Subcells") -> "Subcells":
        """Return these subcells and others of the same size."""
        return Subcells(
            np.concatenate([self.place, other.place]),
            np.concatenate([self.cell, other.cell]),
            np.concatenate([self.factor, other.factor]),
        )


def whole_cells(place: Indices, height: Indices, *, depth: int) -> list[Subcells]:
    """Return whole cells as subcells, by their height above the finest cells.

    >>> cells = whole_cells(np.arange(16), np.zeros(16, int), depth=1)
    >>> [len(part) for part in cells]
    [16, 0]
    """
    found = []
    for level in range(depth + 1):
        cell = np.flatnonzero(height == level).astype(np.int32)
        factor = np.ones(len(cell), dtype=np.float32)
        found.append(Subcells(place[cell].astype(np.int32), cell, factor))
    return found


def subcell_slots(
    pieces: Sequence[Subcells], *, rank: int
) -> Int32[np.ndarray, " slot"]:
    """Return the slots of a tree, as in `ScatteringTree`, with numbers as values.

    Subcells are numbered from the finest on, in the given order.

    >>> cells = whole_cells(np.arange(16), np.zeros(16, int), depth=1)
    >>> subcell_slots(cells, rank=4)[:3].tolist()
    [-2, 0, 1]
    """
    # Ascend from the finest level: nodes with branches are inserted between the others
    levels = []
    inner, first = np.zeros(0, dtype=np.int32), 0
    for part in pieces:
        place = np.concatenate([part.place, inner])
        order = np.argsort(place, kind="stable").astype(np.int32)
        inside = order >= len(part)
        levels.append((np.where(inside, ~(order - len(part)), order + first), inside))
        first += len(part)
        inner = place[order[:: 1 << rank]] >> rank

    # Descend: the branches of a level follow that level
    size = 0
    for slots, inside in reversed(levels):
        size += len(slots)
        slots[inside] = ~((~slots[inside] << rank) + size)
    return np.concatenate([slots for slots, _ in reversed(levels)])
