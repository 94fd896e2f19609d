"""Tensor trees from interpolated measurements.

The lobes of each incident cell are rasterized on the grid of exit cells; flux is
conserved. Incident cells are processed in blocks, and similar cells are merged after
each block, because the 268 million values of 2^7 cells along each axis need too much
memory.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from jaxtyping import Float, Int32

from clerestory.array_types import Directions, Slots
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import float_bits
from clerestory.bsdf.tree_parser import morton_order
from clerestory.errors import InputError
from clerestory.gonio.angles import undeviated
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.parallel import map_in_order, silent
from clerestory.gonio.raster import Raster
from clerestory.gonio.symmetry import Symmetry, images
from clerestory.hemisphere.shirley_chiu import directions_from_square
from clerestory.progress import Progress

# Number of tree levels in a block, counted from the smallest cells.
_BLOCK = 3

# Largest number of tree levels by rank, limited by time and memory.
_DEEPEST: dict[int, int] = {4: 7, 3: 8}

# Constant added to the mean BSDF that divides differences [1/sr].
_FLOOR = 0.01


class Source(Protocol):
    """Scattering function given by lobes for every incident direction."""

    @property
    def symmetry(self) -> Symmetry:
        """Symmetry of the layer."""

    def lobes_of(self, incident: Directions) -> Iterator[Lobes]:
        """Lobes of the scattered light for each incident direction."""


@dataclass(frozen=True, eq=False)
class _Forest:
    # Subtrees of one block: slots of the roots, and slots of all levels below the roots
    roots: Int32[np.ndarray, " subtrees"]
    slots: Slots


def to_tree(
    interpolant: Source,
    *,
    halvings: int,
    tolerance: float = 0.05,
    processes: int = 1,
    report: Progress = silent,
) -> ScatteringTree:
    """Return the tensor tree of an interpolant: rank 3 if isotropic, else rank 4.

    Parameters
    ----------
    halvings : number of tree levels; the smallest cells have edge 2^-halvings
    tolerance : largest relative BSDF difference between cells that are merged
    """
    rank: Literal[3, 4] = 3 if interpolant.symmetry == "isotropic" else 4
    if not 1 <= halvings <= _DEEPEST[rank]:
        raise InputError(
            f"tensor tree of rank {rank} with {halvings} halvings; 1 to"
            f" {_DEEPEST[rank]} halvings expected"
        )
    if rank == 3:
        return _rank_3(interpolant, halvings, tolerance)
    within = min(_BLOCK, halvings)
    wide = 1 << halvings - within
    blocks = [(p, q) for p in range(wide) for q in range(wide)]
    chosen = [block for block in blocks if _first_image(interpolant, block, wide)]
    work = [(interpolant, block, halvings, within, tolerance) for block in chosen]
    drawn = map_in_order(_drawn_block, work, processes=processes, report=report)
    forests: dict[tuple[int, int], _Forest] = {}
    for part in drawn:
        forests.update(part)
    return _assembled([forests[block] for block in blocks], halvings, within)


def _rank_3(interpolant: Source, halvings: int, tolerance: float) -> ScatteringTree:
    # The first coordinate is half the distance from the rim of the disc: at most 1/2
    wide, raster = 1 << halvings, Raster.of(halvings)
    radius = 1 - 2 * (np.arange(wide // 2) + 0.5) / wide
    height = np.sqrt(1 - radius**2)
    source = np.stack([-radius, 0 * radius, height], axis=-1)
    cells = [raster.cells(lobes) for lobes in interpolant.lobes_of(source)]
    values = np.zeros((wide, wide * wide))
    values[: len(cells)] = cells
    leaves = values.ravel()[morton_order(3, halvings)][None]
    forest = _grown(leaves, 3, halvings, tolerance)
    slots = np.concatenate([forest.roots, _moved(forest.slots, 1)])
    if forest.roots[0] < 0:
        slots[0] = ~1
    return ScatteringTree(slots, 3, halvings)


def _images(
    interpolant: Source, block: tuple[int, int], wide: int
) -> dict[tuple[int, int], tuple[bool, bool]]:
    # Mirror images of a block; for each image, flags of the reversed axes
    found: dict[tuple[int, int], tuple[bool, bool]] = {}
    for x, y, _ in images(interpolant.symmetry) < 0:
        flip = bool(x), bool(y)
        place = tuple(
            wide - 1 - n if backwards else n
            for n, backwards in zip(block, flip, strict=True)
        )
        found.setdefault((place[0], place[1]), flip)
    return found


def _first_image(interpolant: Source, block: tuple[int, int], wide: int) -> bool:
    return block == min(_images(interpolant, block, wide))


def _drawn_block(
    work: tuple[Source, tuple[int, int], int, int, float],
) -> dict[tuple[int, int], _Forest]:
    # Rasterize the incident cells of a block; build subtrees of all mirror images
    interpolant, block, halvings, within, tolerance = work
    wide, part = 1 << halvings, 1 << within
    raster = Raster.of(halvings)
    a, b = ((block[i] * part + np.arange(part) + 0.5) / wide for i in (0, 1))
    a, b = np.meshgrid(a, b, indexing="ij")
    source = undeviated(directions_from_square(a.ravel(), b.ravel()))
    cells = [raster.cells(lobes) for lobes in interpolant.lobes_of(source)]
    values = np.array(cells, dtype=np.float32).reshape(part, part, wide, wide)
    forests: dict[tuple[int, int], _Forest] = {}
    for place, flip in _images(interpolant, block, wide // part).items():
        axes = [axis for i, axis in ((0, 0), (1, 1), (0, 2), (1, 3)) if flip[i]]
        turned = np.flip(values, tuple(axes)) if axes else values
        split = turned.reshape(part * part, wide // part, part, wide // part, part)
        leaving = split.transpose(1, 3, 0, 2, 4).reshape((wide // part) ** 2, -1)
        forests[place] = _grown(
            leaving[:, morton_order(4, within)], 4, within, tolerance
        )
    return forests


def _grown(
    leaves: Float[np.ndarray, "subtrees leaves"],
    rank: int,
    halvings: int,
    tolerance: float,
) -> _Forest:
    """Build one subtree per row of `leaves`; similar cells are merged."""
    width = 1 << rank
    mean, least, most = [leaves], [leaves], [leaves]
    for _ in range(halvings):
        shape = len(leaves), -1, width
        mean.insert(0, mean[0].reshape(shape).mean(axis=2))
        least.insert(0, least[0].reshape(shape).min(axis=2))
        most.insert(0, most[0].reshape(shape).max(axis=2))
    alive = np.arange(len(leaves))
    regions: list[Slots] = []
    size = 0
    for level in range(halvings + 1):
        value = mean[level].ravel()[alive]
        region = float_bits(value)
        if level < halvings:
            spread = most[level].ravel()[alive] - least[level].ravel()[alive]
            keep = np.flatnonzero(spread > tolerance * (value + _FLOOR))
            region[keep] = ~(size + (np.arange(len(keep)) << rank)).astype(np.int32)
            size += len(keep) << rank
            below = (alive[keep] << rank)[:, None] + np.arange(width)
            alive = below.ravel()
        regions.append(region)
        if level < halvings and not len(alive):
            break
    return _Forest(regions[0], np.concatenate([np.zeros(0, np.int32), *regions[1:]]))


def _moved(slots: Slots, by: int) -> Slots:
    return np.where(slots < 0, slots - by, slots).astype(np.int32)


def _assembled(forests: list[_Forest], halvings: int, within: int) -> ScatteringTree:
    # Build the upper levels, at the leaves of which the subtrees are attached
    top = halvings - within
    size = sum(16**level for level in range(top + 1))
    roots: list[Int32[np.ndarray, " subtrees"]] = []
    slots: list[Slots] = []
    for forest in forests:
        roots.append(_moved(forest.roots, size))
        slots.append(_moved(forest.slots, size))
        size += len(forest.slots)
    starts = np.cumsum([16**level for level in range(top + 1)])
    inner = [
        ~(start + (np.arange(16**level) << 4)).astype(np.int32)
        for level, start in enumerate(starts[:-1])
    ]
    leaves = np.concatenate(roots)[morton_order(4, top)]
    return ScatteringTree(np.concatenate([*inner, leaves, *slots]), 4, halvings)
