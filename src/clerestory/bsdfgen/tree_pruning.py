"""Selection of tree cells by cost-complexity pruning.

Small cells resolve BSDF peaks; large cells have less noise. A block of cells is merged
if this lowers the expected squared error: merging removes the true BSDF differences
within the block, but also reduces the noise. The noise is estimated from the sums of
squared path weights in the smallest cells.

The tree of least cost is selected. The cost is a sum over cells of (2λ × variance of
the cell's mean − square of the mean) × number of smallest cells in the cell. For λ = 1
it is an unbiased estimate of the squared error up to a constant (Mallows' Cp); a larger
λ suppresses cells that are bright by chance.

References: C. L. Mallows, "Some comments on Cp", Technometrics 15 (4), 1973; D. L.
Donoho, "CART and best-ortho-basis: a connection", Annals of Statistics 25 (5), 1997.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Indices, Mask, Values

# λ in the cost. For a blind with 2,000 paths per cell, errors were smallest for λ from
# 1 to 2; λ = 2 gave one third of the cells of λ = 1.
_CAUTION = 1.5


@dataclass(frozen=True, eq=False)
class NodeValues:
    """BSDF of the nodes of one tree level; nodes with zero BSDF are omitted.

    `place`: Morton codes, ascending; `mean`: mean BSDF [1/sr] of the smallest cells in
    the node; `noise`: sum of the luminous BSDF variances of the smallest cells.
    """

    place: Int[np.ndarray, " node"]
    mean: Float[np.ndarray, "node channel"]
    noise: Float[np.ndarray, " node"]


@dataclass(frozen=True, eq=False)
class Level:
    """Nodes of one tree level, and mask of the nodes that are split."""

    light: NodeValues
    split: Bool[np.ndarray, " node"]


def pruned_levels(
    finest: NodeValues, weights: Values, *, rank: int, levels: int
) -> list[Level]:
    """Select the nodes to split, on each level from the roots to the smallest cells.

    `weights`: weight of each channel in the luminance.
    """
    cost = _cost(finest.mean @ weights, finest.noise, 1)
    found = [Level(finest, np.zeros(len(cost), dtype=bool))]
    for height in range(1, levels + 1):
        light, apart = _coarser(found[-1].light, cost, rank=rank)
        together = _cost(light.mean @ weights, light.noise, 1 << rank * height)
        found.append(Level(light, apart < together))
        cost = np.minimum(apart, together)
    if rank == 3 and levels > 0:
        # Always split the root: half of it is unused, so that its mean is invalid
        found[-1].split[:] = True
    return found[::-1]


def _coarser(
    below: NodeValues, cost: Float[np.ndarray, " node"], *, rank: int
) -> tuple[NodeValues, Float[np.ndarray, " above"]]:
    # BSDF of the parent nodes, and the summed cost of the children of each node
    above = below.place >> rank
    first = np.flatnonzero(np.diff(above, prepend=-1))
    mean, noise, apart = (
        np.add.reduceat(part, first, dtype=float) if len(first) else part
        for part in (below.mean, below.noise, cost)
    )
    return NodeValues(above[first], mean / (1 << rank), noise), apart


def _cost(luminous: Values, noise: Values, cells: int) -> Values:
    return np.asarray(2 * _CAUTION * noise / cells - cells * np.square(luminous))


@dataclass(frozen=True, eq=False)
class Cells:
    """Selected cells of one or more (sub)trees.

    `value` is the BSDF [1/sr], `noise` the variance of the luminous BSDF, `place` the
    Morton code on the tree level, `height` the number of levels above the smallest
    cells.
    """

    value: Float[np.ndarray, "cell channel"]
    noise: Float[np.ndarray, " cell"]
    place: Int[np.ndarray, " cell"]
    height: Int[np.ndarray, " cell"]


def selected_cells(levels: list[Level], *, rank: int, roots: int = 1) -> Cells:
    """Return the cells of the pruned tree below the roots."""
    branches = np.arange(1 << rank)
    at = np.arange(roots)
    found: list[tuple[np.ndarray, ...]] = []
    for depth, level in enumerate(levels):
        height = len(levels) - 1 - depth
        node, lit = _nodes(level.light, at)
        keep = lit & level.split[node] if len(level.split) else lit
        lit, node = lit[~keep], node[~keep]
        mean = np.zeros((len(lit), level.light.mean.shape[1]))
        noise = np.zeros(len(lit))
        mean[lit] = level.light.mean[node[lit]]
        noise[lit] = level.light.noise[node[lit]] / 4.0 ** (rank * height)
        found.append((mean, noise, at[~keep], np.full(len(lit), height)))
        at = ((at[keep] << rank)[:, None] + branches).ravel()
    return Cells(*(np.concatenate(part) for part in zip(*found, strict=True)))


def _nodes(light: NodeValues, place: Indices) -> tuple[Indices, Mask]:
    # Index of each node in a level, and mask of the nodes that the level contains
    if not len(light.place):
        return np.zeros_like(place), np.zeros(len(place), dtype=bool)
    at = np.searchsorted(light.place, place)
    at = np.minimum(at, len(light.place) - 1)
    return at, light.place[at] == place
