"""Subdivision of tree cells into subcells with scaled values.

A cell can have hundreds of subcells. A subcell is stored as a Morton code, the index
of the subdivided cell and a scale factor.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int32

from clerestory.array_types import Indices, Mask


@dataclass(frozen=True, eq=False)
class Subcells:
    """Subcells of one size: Morton code, index and BSDF factor of the divided cell."""

    place: Int32[np.ndarray, " piece"]
    cell: Int32[np.ndarray, " piece"]
    factor: Float32[np.ndarray, " piece"]

    def __len__(self) -> int:
        return len(self.place)

    def cut(self, split: Mask, *, rank: int) -> "tuple[Subcells, Subcells]":
        """Return the unsplit subcells, and the children of the split subcells."""
        width = 1 << rank
        place = (self.place[split, None] << rank) + np.arange(width, dtype=np.int32)
        branches = Subcells(
            place.ravel(),
            np.repeat(self.cell[split], width),
            np.repeat(self.factor[split], width),
        )
        return self.only(~split), branches

    def only(self, which: slice | Mask) -> "Subcells":
        """Return the selected subcells."""
        return Subcells(self.place[which], self.cell[which], self.factor[which])

    def beside(self, other: "Subcells") -> "Subcells":
        """Return the concatenation with other subcells of the same size."""
        return Subcells(
            np.concatenate([self.place, other.place]),
            np.concatenate([self.cell, other.cell]),
            np.concatenate([self.factor, other.factor]),
        )


def whole_cells(place: Indices, height: Indices, *, depth: int) -> list[Subcells]:
    """Return one subcell per cell, grouped by levels above the smallest cells."""
    found = []
    for level in range(depth + 1):
        cell = np.flatnonzero(height == level).astype(np.int32)
        factor = np.ones(len(cell), dtype=np.float32)
        found.append(Subcells(place[cell].astype(np.int32), cell, factor))
    return found


def subcell_slots(
    pieces: Sequence[Subcells], *, rank: int
) -> Int32[np.ndarray, " slot"]:
    """Slots of a tree, as in `ScatteringTree`, with subcell indices as values.

    Subcells are numbered in the given order, from the smallest size to the largest.
    """
    # Ascend from the finest level; merge parent nodes with the subcells one level up
    levels = []
    inner, first = np.zeros(0, dtype=np.int32), 0
    for part in pieces:
        place = np.concatenate([part.place, inner])
        order = np.argsort(place, kind="stable").astype(np.int32)
        inside = order >= len(part)
        levels.append((np.where(inside, ~(order - len(part)), order + first), inside))
        first += len(part)
        inner = place[order[:: 1 << rank]] >> rank

    # Descend; the children of each level are stored after that level
    size = 0
    for slots, inside in reversed(levels):
        size += len(slots)
        slots[inside] = ~((~slots[inside] << rank) + size)
    return np.concatenate([slots for slots, _ in reversed(levels)])
