"""Cells of a tree that keep the light of each incident cell, or of each leaving one.

Cells are joined where their differences are no more than noise, each block for itself.
But what a block loses from one incident cell to its neighbour, all others lose alike
where the light in all changes from cell to cell: single values stay as good as they
can be, sums over all leaving cells do not. The light in all is known far better than
any single value, so it is brought back: where it changes, joined cells are cut, and
share their value in proportion to it.

A change is looked for at all scales, from single incident cells to halves of a joined
one: over many cells light is known better than in one. The brightest joined cells are
cut, as many as can take the change without being changed much themselves; wide cells
then take what their incident cells have in common, and smaller ones what is left.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.bsdfgen.branches import incident_part
from clerestory.bsdfgen.refine import Cells

# Joined cells are cut where the light from a part of their incident cells would else be
# off by more than this share of all that comes, for parts of a thirty-second of the
# square of directions and wider; twice as much at half the width, for what is moved
# there stays in the neighbourhood. It must be more than so many standard errors too, of
# which an upper bound is known.
_TOLERANCE = 0.004
_SPAN = 5
_SURE = 0.3

# Light that leaves through a cell is known no better than its standard error: paths
# start evenly, but leave by chance.
_SURE_LEAVING = 2.0

# Cells that take a change hold so many times as much light, at least.
_STRETCH = 3.0

# Cells that have less than half of the light are changed by this share at most: what
# is left for them may be the noise of the others.
_CHANGE = 0.5


@dataclass(frozen=True, eq=False)
class SummedLight:
    """Light in all from each incident cell, or by reciprocity from each leaving one.

    Attributes
    ----------
    share : of the light that comes, luminous, 0…1
    variance : of the share
    """

    share: Float[np.ndarray, " incident"]
    variance: Float[np.ndarray, " incident"]


def keep_light(
    cells: Cells,
    light: SummedLight,
    weights: Float[np.ndarray, " channel"],
    *,
    rank: int,
    depth: int,
    by_leaving: bool = False,
) -> Cells:
    """Return cells whose joined values are cut and scaled to keep the incident light.

    Parameters
    ----------
    light : as it was counted
    weights : share of each channel in the luminous value
    depth : halvings of each coordinate down to the finest cells
    by_leaving : whether light is that of leaving cells, which take the place of the
        incident ones; for rank 4

    Examples
    --------
    A block of 2 × 2 incident and 2 × 2 leaving cells, all in one:

    >>> one = Cells(np.array([0], dtype=np.int32), np.array([[0.2]]), np.zeros(1),
    ...             np.array([0]), np.array([1]))
    >>> share = np.pi * np.array([0.1, 0.3, 0.1, 0.3])
    >>> light = SummedLight(share, np.zeros(4))
    >>> kept = keep_light(one, light, np.ones(1), rank=4, depth=1)
    >>> kept.value[:4, 0].round(3).tolist()
    [0.1, 0.3, 0.1, 0.3]
    """
    tally = _Tally(light.share, weights, rank, depth, 2 if by_leaving else 0)
    joined = cells.height > 0
    doubt = (_SURE_LEAVING if by_leaving else _SURE) ** 2 * light.variance
    scale, together = tally.scales(cells, joined)
    cut = cells
    for height in range(int(cells.height.max(initial=0)), 0, -1):
        wide = 1 << (rank - 2) * height
        moved = _moved(scale, together, doubt, height, bits=rank - 2, depth=depth)
        finer = _means(tally.light(cut, joined & (cut.height < height)), wide)
        need = np.minimum(_STRETCH * moved, _means(together, wide)) - finer
        split = tally.brightest(cut, joined & (cut.height == height), need * wide)
        cut, joined = _cut(cut, joined, split, rank=rank)
    return tally.scaled(cut, joined)


def _moved(
    scale: Float[np.ndarray, " incident"],
    together: Float[np.ndarray, " incident"],
    doubt: Float[np.ndarray, " incident"],
    height: int,
    *,
    bits: int,
    depth: int,
) -> Float[np.ndarray, " block"]:
    # Most light that cells of a height and one scale would move between their parts,
    # where it is more than what is allowed, and known
    wide = 1 << bits * height
    off = (scale - np.repeat(_means(scale, wide), wide)) * together
    most = np.zeros(len(scale) // wide)
    for part in range(height):
        few = 1 << bits * part
        unsure = np.sqrt(_means(doubt, few) / few)
        limit = _TOLERANCE * max(1.0, 2.0 ** (depth - part - _SPAN))
        moved = np.abs(_means(off, few))
        moved[moved <= np.maximum(limit, unsure)] = 0
        most = np.maximum(most, moved.reshape(len(most), -1).max(axis=1))
    return most


def _means(
    values: Float[np.ndarray, " incident"], wide: int
) -> Float[np.ndarray, " part"]:
    return np.asarray(values.reshape(-1, wide).mean(axis=1))


@dataclass(frozen=True, eq=False)
class _Tally:
    # Sums of the light of cells by their incident cells
    share: Float[np.ndarray, " incident"]
    weights: Float[np.ndarray, " channel"]
    rank: int
    depth: int
    skip: int  # bits of a digit before those of the cells whose light is kept

    def light(
        self, cells: Cells, of: Bool[np.ndarray, " cell"]
    ) -> Float[np.ndarray, " incident"]:
        """Share of the light that some cells have from each incident cell."""
        total = np.zeros(len(self.share))
        for height in np.unique(cells.height[of]):
            wide = 1 << (self.rank - 2) * int(height)
            which = np.flatnonzero(of & (cells.height == height))
            block = self.block(cells, which, int(height))
            light = self.luminous(cells, which) * 4.0**height
            total += np.repeat(np.bincount(block, light, len(total) // wide), wide)
        return total

    def luminous(
        self, cells: Cells, which: Int[np.ndarray, " some"]
    ) -> Float[np.ndarray, " some"]:
        """Share of the light in one finest leaving cell of some cells."""
        value = cells.value[which] @ self.weights
        return np.asarray(value * np.pi / 4.0**self.depth)

    def block(
        self, cells: Cells, which: Int[np.ndarray, " some"], height: int
    ) -> Int[np.ndarray, " some"]:
        """Number of the incident cell of some cells of a height."""
        levels = self.depth - height
        place = cells.place[which] >> self.skip
        return incident_part(place, rank=self.rank, levels=levels)

    def scales(
        self, cells: Cells, joined: Bool[np.ndarray, " cell"]
    ) -> tuple[Float[np.ndarray, " incident"], Float[np.ndarray, " incident"]]:
        """What joined cells are to be multiplied by, and the light that they have."""
        together = self.light(cells, joined)
        left = np.maximum(self.share - self.light(cells, ~joined), 0)
        known = together > 0
        return np.where(known, left / np.where(known, together, 1), 1), together

    def brightest(
        self,
        cells: Cells,
        of: Bool[np.ndarray, " cell"],
        need: Float[np.ndarray, " block"],
    ) -> Bool[np.ndarray, " cell"]:
        """Brightest cells of one height that have as much light as each block needs."""
        found = np.zeros(len(of), dtype=bool)
        which = np.flatnonzero(of)
        if not len(which):
            return found
        height = int(cells.height[which[0]])
        block = self.block(cells, which, height)
        light = self.luminous(cells, which) * 4.0**height
        light *= 1 << (self.rank - 2) * height
        order = np.lexsort((-light, block))
        block, light = block[order], light[order]
        before = np.cumsum(light) - light
        first = np.searchsorted(block, np.arange(len(need)))
        start = before[np.minimum(first, len(before) - 1)]
        found[which[order]] = before - start[block] < need[block]
        return found

    def scaled(self, cells: Cells, joined: Bool[np.ndarray, " cell"]) -> Cells:
        """Scale joined cells: wide ones by what is common, smaller ones by the rest."""
        alone = self.light(cells, ~joined)
        left = np.maximum(self.share - alone, 0)
        factor = np.ones(len(joined))
        rest = every = self.light(cells, joined)
        for height in np.unique(cells.height[joined])[::-1]:
            of = joined & (cells.height == height)
            which = np.flatnonzero(of)
            wide = 1 << (self.rank - 2) * int(height)
            target, have = _means(left, wide), _means(rest, wide)
            ratio = np.where(have > 0, target / np.where(have > 0, have, 1), 1)
            few = have < _means(every, wide) / 2
            ratio[few] = np.clip(ratio[few], 1 - _CHANGE, 1 + _CHANGE)
            own = self.light(cells, of)
            factor[which] = ratio[self.block(cells, which, int(height))]
            left = np.maximum(left - own * np.repeat(ratio, wide), 0)
            rest = rest - own
        return Cells(
            cells.slots,
            cells.value * factor[:, None],
            cells.noise * factor**2,
            cells.place,
            cells.height,
        )


def _cut(
    cells: Cells,
    joined: Bool[np.ndarray, " cell"],
    split: Bool[np.ndarray, " cell"],
    *,
    rank: int,
) -> tuple[Cells, Bool[np.ndarray, " made"]]:
    # Put branches of the same value in place of some cells
    if not split.any():
        return cells, joined
    width = 1 << rank
    old = np.flatnonzero(split)
    number = np.cumsum(~split) - 1
    kept = int((~split).sum())
    fresh = kept + np.arange(len(old) * width, dtype=np.int32)
    entry = np.where(split, 0, number)
    entry[old] = ~(len(cells.slots) + np.arange(len(old)) * width)
    slots = cells.slots.copy()
    ends = slots >= 0
    slots[ends] = entry[slots[ends]]

    def grown(part: np.ndarray, branches: np.ndarray) -> np.ndarray:
        return np.concatenate([part[~split], branches])

    repeated = np.repeat(old, width)
    place = (cells.place[old, None] << rank) + np.arange(width)
    made = Cells(
        np.concatenate([slots, fresh]).astype(np.int32),
        grown(cells.value, cells.value[repeated]),
        grown(cells.noise, cells.noise[repeated]),
        grown(cells.place, place.ravel()),
        grown(cells.height, cells.height[repeated] - 1),
    )
    return made, grown(joined, joined[repeated])
