"""Cells of a tree that keep the light of each incident cell.

Cells are joined where their differences are no more than noise, each block for itself.
But what a block loses from one incident cell to its neighbour, all others lose alike
where the light in all changes from cell to cell: single values stay as good as they
can be, sums over all leaving cells do not. The light in all is known far better than
any single value, so it is brought back: where it changes, joined cells are cut, and
share their value in proportion to it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.bsdfgen.branches import incident_part
from clerestory.bsdfgen.refine import Cells

# Joined cells are cut where the light from one of their incident cells would else be
# off by more than this share of all that comes, if they are a sixteenth of the square
# of directions wide; twice as much at half the width, for what is moved within them
# stays there. It must be more than so many standard errors, of which an
# upper bound is known.
_TOLERANCE = 0.01
_SPAN = 4
_SURE = 0.5


@dataclass(frozen=True, eq=False)
class IncidentLight:
    """Light that leaves each incident cell of a block.

    Attributes
    ----------
    share : of the light that comes, luminous, 0…1
    variance : of the share
    """

    share: Float[np.ndarray, " incident"]
    variance: Float[np.ndarray, " incident"]


def keep_light(
    cells: Cells,
    light: IncidentLight,
    weights: Float[np.ndarray, " channel"],
    *,
    rank: int,
    depth: int,
) -> Cells:
    """Return cells whose joined values are cut and scaled to keep the incident light.

    Parameters
    ----------
    light : as it was counted
    weights : share of each channel in the luminous value
    depth : halvings of each coordinate down to the finest cells

    Examples
    --------
    A block of 2 × 2 incident and 2 × 2 leaving cells, all in one:

    >>> one = Cells(np.array([0], dtype=np.int32), np.array([[0.2]]), np.zeros(1),
    ...             np.array([0]), np.array([1]))
    >>> share = np.pi * np.array([0.1, 0.3, 0.1, 0.3])
    >>> light = IncidentLight(share, np.zeros(4))
    >>> kept = keep_light(one, light, np.ones(1), rank=4, depth=1)
    >>> kept.value[:4, 0].round(3).tolist()
    [0.1, 0.3, 0.1, 0.3]
    """
    luminous = cells.value @ weights * np.pi / 4.0**depth
    scale, together = _scales(cells, luminous, light, rank=rank)
    unsure = _SURE * np.sqrt(light.variance)
    cut, joined = cells, cells.height > 0
    for height in range(int(cells.height.max(initial=0)), 0, -1):
        wide = 1 << (rank - 2) * height
        limit = np.maximum(_TOLERANCE * 2.0 ** (depth - height - _SPAN), unsure)
        mean = np.repeat(scale.reshape(-1, wide).mean(axis=1), wide)
        off = np.abs(scale - mean) * together > limit
        apart = off.reshape(-1, wide).any(axis=1)
        incident = _incident(cut, rank=rank, count=len(scale))
        split = (cut.height == height) & joined & apart[incident // wide]
        cut, joined = _cut(cut, joined, split, rank=rank)
    return _scaled(cut, joined, scale, rank=rank)


def _incident(cells: Cells, *, rank: int, count: int) -> Int[np.ndarray, " cell"]:
    # Number of the first finest incident cell of each cell
    bits = rank - 2
    levels = (count.bit_length() - 1) // bits
    found = np.zeros(len(cells.place), dtype=int)
    for height in np.unique(cells.height):
        of = cells.height == height
        number = incident_part(cells.place[of], rank=rank, levels=levels - height)
        found[of] = number << bits * height
    return found


def _scales(
    cells: Cells,
    luminous: Float[np.ndarray, " cell"],
    light: IncidentLight,
    *,
    rank: int,
) -> tuple[Float[np.ndarray, " incident"], Float[np.ndarray, " incident"]]:
    # What joined cells are to be multiplied by, and the light that they have
    count, bits = len(light.share), rank - 2
    first = _incident(cells, rank=rank, count=count)
    alone, together = np.zeros((2, count))
    for height in np.unique(cells.height):
        of = cells.height == height
        sums = np.bincount(first[of], luminous[of] * 4.0**height, minlength=count)
        target = alone if height == 0 else together
        wide = 1 << bits * int(height)
        target += np.repeat(sums.reshape(-1, wide).sum(axis=1), wide)
    known = together > 0
    left = np.maximum(light.share - alone, 0)
    return np.where(known, left / np.where(known, together, 1), 1), together


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


def _scaled(
    cells: Cells,
    joined: Bool[np.ndarray, " cell"],
    scale: Float[np.ndarray, " incident"],
    *,
    rank: int,
) -> Cells:
    # Multiply each joined cell by the mean over its incident cells
    first = _incident(cells, rank=rank, count=len(scale))
    wide = 1 << (rank - 2) * cells.height
    before = np.concatenate([[0.0], np.cumsum(scale)])
    mean = np.where(joined, (before[first + wide] - before[first]) / wide, 1)
    return Cells(
        cells.slots,
        cells.value * mean[:, None],
        cells.noise * mean**2,
        cells.place,
        cells.height,
    )
