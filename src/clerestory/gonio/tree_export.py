"""Tensor trees from interpolated measurements.

The lobes of each incident cell are rasterized on the grid of exit cells; flux is
conserved. Incident cells are processed in blocks, and similar cells are merged after
each block, because the 268 million values of 2^7 cells along each axis need too much
memory.
"""

from collections.abc import Iterator
from typing import Literal, Protocol

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import Nodes, Region, full_levels, level_slots
from clerestory.bsdf.tree_parser import morton_order
from clerestory.checks import within
from clerestory.gonio.angles import undeviated
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.parallel import IN_SERIES, Workers
from clerestory.gonio.raster import Raster
from clerestory.gonio.symmetry import Symmetry, images
from clerestory.hemisphere.shirley_chiu import directions_from_square

# Number of tree levels in a block, counted from the smallest cells.
_BLOCK = 3

# Largest number of tree levels by rank, limited by time and memory.
_DEEPEST: dict[int, int] = {4: 7, 3: 8}

_FLOOR = 0.01  # constant added to the mean BSDF in relative differences [1/sr]


class Source(Protocol):
    """Scattering function given by lobes for every incident direction."""

    @property
    def symmetry(self) -> Symmetry:
        """Symmetry of the layer."""

    def lobes_of(self, incident: Directions) -> Iterator[Lobes]:
        """Lobes of the scattered light for each incident direction."""


def to_tree(
    interpolant: Source,
    *,
    halvings: int,
    tolerance: float = 0.05,
    workers: Workers = IN_SERIES,
    phase: str = "tensor tree",
) -> ScatteringTree:
    """Return the tensor tree of an interpolant: rank 3 if isotropic, else rank 4.

    Parameters
    ----------
    halvings : number of tree levels; the smallest cells have edge 2^-halvings
    tolerance : largest relative BSDF difference between cells that are merged
    phase : name of the computation for progress callbacks
    """
    rank: Literal[3, 4] = 3 if interpolant.symmetry == "isotropic" else 4
    what = f"number of halvings of a rank {rank} tensor tree"
    within(halvings, what, least=1, most=_DEEPEST[rank])
    if rank == 3:
        return _rank_3(interpolant, halvings, tolerance)
    inner = min(_BLOCK, halvings)
    wide = 1 << halvings - inner
    blocks = [(p, q) for p in range(wide) for q in range(wide)]
    work = [
        (interpolant, block, halvings, inner, tolerance)
        for block in blocks
        if block == min(_images(interpolant, block, wide))
    ]
    forests: dict[tuple[int, int], Region] = {}
    for part in workers.map(phase, _drawn_block, work):
        forests.update(part)
    return _assembled([forests[block] for block in blocks], halvings, inner)


def _rank_3(interpolant: Source, halvings: int, tolerance: float) -> ScatteringTree:
    # The first tree coordinate, half the distance from the disc rim, is at most 1/2
    wide, raster = 1 << halvings, Raster.of(halvings)
    radius = 1 - 2 * (np.arange(wide // 2) + 0.5) / wide
    source = np.stack([-radius, 0 * radius, np.sqrt(1 - radius**2)], axis=-1)
    cells = [raster.cells(lobes) for lobes in interpolant.lobes_of(source)]
    values = np.zeros((wide, wide * wide))
    values[: len(cells)] = cells
    leaves = values.ravel()[morton_order(3, halvings)][None]
    return ScatteringTree(_grown(leaves, 3, halvings, tolerance), 3, halvings)


def _images(
    interpolant: Source, block: tuple[int, int], wide: int
) -> dict[tuple[int, int], tuple[bool, bool]]:
    # Mirror images of a block; for each image, flags of the reversed axes
    found: dict[tuple[int, int], tuple[bool, bool]] = {}
    p, q = block
    for x, y, _ in (images(interpolant.symmetry) < 0).tolist():
        place = wide - 1 - p if x else p, wide - 1 - q if y else q
        found.setdefault(place, (x, y))
    return found


def _drawn_block(
    interpolant: Source,
    block: tuple[int, int],
    halvings: int,
    inner: int,
    tolerance: float,
) -> dict[tuple[int, int], Region]:
    # Rasterize the incident cells of a block; build subtrees of all mirror images
    wide, part = 1 << halvings, 1 << inner
    raster = Raster.of(halvings)
    a, b = ((block[i] * part + np.arange(part) + 0.5) / wide for i in (0, 1))
    a, b = np.meshgrid(a, b, indexing="ij")
    source = undeviated(directions_from_square(a.ravel(), b.ravel()))
    cells = [raster.cells(lobes) for lobes in interpolant.lobes_of(source)]
    values = np.array(cells, dtype=np.float32).reshape(part, part, wide, wide)
    forests: dict[tuple[int, int], Region] = {}
    for place, flip in _images(interpolant, block, wide // part).items():
        turned = np.flip(values, tuple(np.flatnonzero([*flip, *flip])))
        split = turned.reshape(part * part, wide // part, part, wide // part, part)
        leaving = split.transpose(1, 3, 0, 2, 4).reshape((wide // part) ** 2, -1)
        forests[place] = _grown(leaving[:, morton_order(4, inner)], 4, inner, tolerance)
    return forests


def _grown(
    leaves: Float[np.ndarray, "subtrees leaves"],
    rank: int,
    halvings: int,
    tolerance: float,
) -> Region:
    # Build slots of one subtree per row of `leaves`, roots first; merge similar cells
    width = 1 << rank
    mean, least, most = [leaves], [leaves], [leaves]
    for _ in range(halvings):
        shape = len(leaves), -1, width
        mean.insert(0, mean[0].reshape(shape).mean(axis=2))
        least.insert(0, least[0].reshape(shape).min(axis=2))
        most.insert(0, most[0].reshape(shape).max(axis=2))

    def nodes() -> Iterator[Nodes]:
        alive = np.arange(len(leaves))
        for values, low, high in zip(mean, least, most, strict=True):
            value = values.ravel()[alive]
            spread = high.ravel()[alive] - low.ravel()[alive]
            branch = spread > tolerance * (value + _FLOOR)
            yield value, branch
            alive = ((alive[branch] << rank)[:, None] + np.arange(width)).ravel()

    return np.concatenate(level_slots(nodes(), rank))


def _assembled(forests: list[Region], halvings: int, inner: int) -> ScatteringTree:
    # Build the upper tree levels and attach the subtrees to the upper leaves
    top = halvings - inner
    upper = level_slots(full_levels(4, top), 4)
    count, size = 4**top, sum(map(len, upper)) + 16**top
    roots: list[Region] = []
    slots: list[Region] = []
    for forest in forests:
        # Offset child indices: children of roots start at `size`, not at `count`
        moved = np.where(forest < 0, forest - (size - count), forest).astype(np.int32)
        roots.append(moved[:count])
        slots.append(moved[count:])
        size += len(forest) - count
    leaves = np.concatenate(roots)[morton_order(4, top)]
    return ScatteringTree(np.concatenate([*upper, leaves, *slots]), 4, halvings)
