"""Cells of a tensor tree that are as small as the light that was counted can tell.

Small cells resolve peaks, large ones are calm. Whether a block of cells stays apart
is decided by the risk: the expected square of what its values are off. One cell in
place of many is off by their differences, as far as these are more than noise;
many cells are off by their own noise. The noise is known from the sum of the squared
weights of the light in the finest cells.

Of all ways to cut a block, the one of least cost is taken: the sum over its cells of
2λ times the noise of their mean less the square of the mean, both times the number of
finest cells. With λ = 1 this is the risk, without bias, but for a constant (Mallows'
Cp); a larger λ guards against cells that only chance has made bright.

References: C. L. Mallows, "Some comments on Cp", Technometrics 15 (4), 1973;
D. L. Donoho, "CART and best-ortho-basis: a connection", Annals of Statistics 25 (5),
1997.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, Int32, Int64

# The λ above. For a blind at 2,000 paths a cell, errors were least from 1 to 2, with a
# third of the cells at 2.
_CAUTION = 1.5


@dataclass(frozen=True, eq=False)
class Light:
    """Values of the nodes of one level that some light reached; all others are dark.

    Attributes
    ----------
    place : number of each node among all of its level, in the order of the branches,
        ascending
    mean : of each channel over the finest cells below [1/sr]
    noise : sum of the variances of the finest cells' luminous values
    cost : of the best cells below
    split : whether the branches stay apart
    """

    place: Int64[np.ndarray, " node"]
    mean: Float[np.ndarray, "node channel"]
    noise: Float[np.ndarray, " node"]
    cost: Float[np.ndarray, " node"]
    split: Bool[np.ndarray, " node"]


def finest_light(
    place: Int64[np.ndarray, " cell"],
    mean: Float[np.ndarray, "cell channel"],
    noise: Float[np.ndarray, " cell"],
    weights: Float[np.ndarray, " channel"],
) -> Light:
    """Return the level of the finest cells, which do not split.

    Parameters
    ----------
    place : ascending
    noise : variance of the luminous value of each cell
    weights : share of each channel in the luminous value
    """
    nothing = np.zeros(len(mean), dtype=bool)
    return Light(place, mean, noise, _cost(mean @ weights, noise, 1), nothing)


def climbed(
    finest: Light, weights: Float[np.ndarray, " channel"], *, rank: int, levels: int
) -> list[Light]:
    """Return the levels from the roots to the finest cells, with decisions to split."""
    found = [finest]
    for height in range(1, levels + 1):
        found.append(_coarser(found[-1], weights, rank=rank, height=height))
    if rank == 3 and levels > 0:
        # The upper half of the root is never looked up: its mean says nothing
        found[-1].split[:] = True
    return found[::-1]


def _coarser(
    below: Light, weights: Float[np.ndarray, " channel"], *, rank: int, height: int
) -> Light:
    # The level above a level
    above = below.place >> rank
    first = np.flatnonzero(np.diff(above, prepend=-1))
    mean, noise, apart = (
        np.add.reduceat(part, first) if len(first) else part
        for part in (below.mean, below.noise, below.cost)
    )
    mean = mean / (1 << rank)
    together = _cost(mean @ weights, noise, 1 << rank * height)
    split = apart < together
    return Light(above[first], mean, noise, np.where(split, apart, together), split)


def _cost(
    luminous: Float[np.ndarray, " node"], noise: Float[np.ndarray, " node"], cells: int
) -> Float[np.ndarray, " node"]:
    cost: Float[np.ndarray, " node"] = 2 * _CAUTION * noise / cells - cells * np.square(
        luminous
    )
    return cost


@dataclass(frozen=True, eq=False)
class Cells:
    """The cells below some roots.

    Attributes
    ----------
    slots : of the roots, then of all branches, as in a `ScatteringTree`; where one of
        that holds a value, these hold the number of a cell
    value : of each cell and channel [1/sr]
    noise : variance of each cell's luminous value
    place : number of each cell among the nodes of its level
    height : of each cell above the finest cells
    """

    slots: Int32[np.ndarray, " slot"]
    value: Float[np.ndarray, "cell channel"]
    noise: Float[np.ndarray, " cell"]
    place: Int[np.ndarray, " cell"]
    height: Int[np.ndarray, " cell"]


def chosen_cells(levels: list[Light], *, rank: int, roots: int = 1) -> Cells:
    """Return the cells of levels from the roots to the finest cells."""
    branches = np.arange(1 << rank)
    at = np.arange(roots)
    size, count = roots, 0
    slots: list[Int32[np.ndarray, " slot"]] = []
    found: list[tuple[np.ndarray, ...]] = []
    for depth, level in enumerate(levels):
        height = len(levels) - 1 - depth
        node, lit = _nodes(level, at)
        keep = lit & level.split[node] if len(level.place) else lit
        lit, node = lit[~keep], node[~keep]
        mean, noise = np.zeros((len(lit), level.mean.shape[1])), np.zeros(len(lit))
        mean[lit] = level.mean[node[lit]]
        noise[lit] = level.noise[node[lit]] / 4.0 ** (rank * height)
        region = np.empty(len(at), dtype=np.int32)
        region[~keep] = count + np.arange(len(lit))
        region[keep] = ~(size + (np.arange(int(keep.sum())) << rank))
        slots.append(region)
        count += len(lit)
        size += int(keep.sum()) << rank
        found.append((mean, noise, at[~keep], np.full(len(lit), height)))
        at = ((at[keep] << rank)[:, None] + branches).ravel()
    value, noise, place, heights = (
        np.concatenate(part) for part in zip(*found, strict=True)
    )
    return Cells(np.concatenate(slots), value, noise, place, heights)


def _nodes(
    level: Light, place: Int64[np.ndarray, " node"]
) -> tuple[Int64[np.ndarray, " node"], Bool[np.ndarray, " node"]]:
    # Where nodes stand in a level, and whether they do
    if not len(level.place):
        return np.zeros_like(place), np.zeros(len(place), dtype=bool)
    at = np.searchsorted(level.place, place)
    at = np.minimum(at, len(level.place) - 1)
    return at, level.place[at] == place
