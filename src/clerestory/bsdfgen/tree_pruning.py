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
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Indices, Mask, Values

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
    """

    place: Int[np.ndarray, " node"]
    mean: Float[np.ndarray, "node channel"]
    noise: Float[np.ndarray, " node"]


@dataclass(frozen=True, eq=False)
class Level:
    """Nodes of one level, and whether their branches stay apart.

    Attributes
    ----------
    light : of the nodes
    split : whether the branches of each stay apart
    """

    light: Light
    split: Bool[np.ndarray, " node"]


def climbed(finest: Light, weights: Values, *, rank: int, levels: int) -> list[Level]:
    """Return the levels from the roots to the finest cells, with decisions to split.

    Parameters
    ----------
    finest : of the finest cells, which do not split
    weights : share of each channel in the luminous value
    """
    cost = _cost(finest.mean @ weights, finest.noise, 1)
    found = [Level(finest, np.zeros(len(cost), dtype=bool))]
    for height in range(1, levels + 1):
        light, apart = _coarser(found[-1].light, cost, rank=rank)
        together = _cost(light.mean @ weights, light.noise, 1 << rank * height)
        found.append(Level(light, apart < together))
        cost = np.minimum(apart, together)
    if rank == 3 and levels > 0:
        # The upper half of the root is never looked up: its mean says nothing
        found[-1].split[:] = True
    return found[::-1]


def _coarser(
    below: Light, cost: Float[np.ndarray, " node"], *, rank: int
) -> tuple[Light, Float[np.ndarray, " above"]]:
    # The level above a level, and what the cells below cost
    above = below.place >> rank
    first = np.flatnonzero(np.diff(above, prepend=-1))
    mean, noise, apart = (
        np.add.reduceat(part, first, dtype=float) if len(first) else part
        for part in (below.mean, below.noise, cost)
    )
    return Light(above[first], mean / (1 << rank), noise), apart


def _cost(luminous: Values, noise: Values, cells: int) -> Values:
    cost: Float[np.ndarray, " node"] = 2 * _CAUTION * noise / cells - cells * np.square(
        luminous
    )
    return cost


@dataclass(frozen=True, eq=False)
class Cells:
    """The cells below some roots.

    Attributes
    ----------
    value : of each cell and channel [1/sr]
    noise : variance of each cell's luminous value
    place : number of each cell among the nodes of its level
    height : of each cell above the finest cells
    """

    value: Float[np.ndarray, "cell channel"]
    noise: Float[np.ndarray, " cell"]
    place: Int[np.ndarray, " cell"]
    height: Int[np.ndarray, " cell"]


def chosen_cells(levels: list[Level], *, rank: int, roots: int = 1) -> Cells:
    """Return the cells of levels from the roots to the finest cells."""
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


def _nodes(light: Light, place: Indices) -> tuple[Indices, Mask]:
    # Where nodes stand in a level, and whether they do
    if not len(light.place):
        return np.zeros_like(place), np.zeros(len(place), dtype=bool)
    at = np.searchsorted(light.place, place)
    at = np.minimum(at, len(light.place) - 1)
    return at, light.place[at] == place
