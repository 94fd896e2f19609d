"""Adaptive quadtree over the hemisphere.

The hemisphere is mapped to a disc by Lambert's equal-area map and to a square by the
Shirley–Chiu map. A plane is fitted to the BSDF in each cell. Cells with the largest
residuals are split, if all quarters of the cell contain points.
"""

import bisect
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Directions, Indices, Values
from clerestory.bsdf.tree_lookup import morton_codes
from clerestory.hemisphere.shirley_chiu import cells_from_disc, square_from_disc

# Finest level: the square has 2^9 × 2^9 cells, 0.3° wide.
FINEST = 9

# Arrays over the occupied cells of one level
_LevelValues = Float[np.ndarray, " _"]
_LevelMask = Bool[np.ndarray, " _"]

# Lower limit of the BSDF by which residuals are divided, as a fraction of the mean.
_FLOOR = 1e-2


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of the hemisphere, with the points in each cell."""

    # Level of each cell; the square has 2^level cells along each axis
    level: Int[np.ndarray, " cells"]
    # Index in `order` of the first point of each cell, followed by the number of points
    first: Int[np.ndarray, " limits"]
    order: Int[np.ndarray, " points"]  # indices of the points, sorted by cell

    @property
    def solid_angle(self) -> Values:
        """Solid angle of each cell [sr]."""
        return 2 * np.pi * 0.25**self.level

    def sum(self, values: Float[np.ndarray, " points"]) -> Float[np.ndarray, " cells"]:
        """Sum over the points of each cell."""
        return np.asarray(np.add.reduceat(values[self.order], self.first[:-1]))

    def mean_direction(
        self,
        direction: Float[np.ndarray, "points 3"],
        weight: Float[np.ndarray, " points"],
    ) -> Float[np.ndarray, "cells 3"]:
        """Weighted mean direction of the points of each cell."""
        weighted = (direction * weight[:, None])[self.order]
        total = np.add.reduceat(weighted, self.first[:-1], axis=0)
        return np.asarray(total / np.linalg.norm(total, axis=1, keepdims=True))


@dataclass(frozen=True, eq=False)
class _Level:
    # Occupied cells of one level, in Morton order
    first: Int[np.ndarray, " cells"]
    parent: Int[np.ndarray, " cells"]
    loss: Float[np.ndarray, " cells"]
    quarters: Int[np.ndarray, " cells"]


class Quadtree:
    """Occupied cells of all levels, with the residual of a plane fit in each cell."""

    def __init__(self, direction: Directions, values: Values) -> None:
        scale = 1 / np.sqrt(1 + direction[:, 2])
        x, y = direction[:, 0] * scale, direction[:, 1] * scale
        row, column = cells_from_disc(x, y, halvings=FINEST)
        code = morton_codes((column, row), FINEST)
        a, b = square_from_disc(x, y)
        self._order = np.argsort(code, kind="stable")
        self._levels = _levels(code[self._order], a, b, values, self._order)

    def cut(self, most: int, *, coarsest: int = 0) -> Cells:
        """Return at most `most` cells, small where residuals of plane fits are large.

        `coarsest`: level of the largest cells, except cells with an empty quarter.
        """
        levels = self._levels
        # Rate each cell by its largest residual over all finer levels; exclude cells
        # with an empty quarter
        worth = [level.loss.copy() for level in levels]
        for k in range(len(levels) - 2, -1, -1):
            below = np.where(levels[k + 1].quarters == 4, worth[k + 1], 0)
            np.maximum.at(worth[k], levels[k + 1].parent, below)
        for k, level in enumerate(levels):
            worth[k] = np.where(level.quarters == 4, worth[k], -1)
            if k < coarsest:
                worth[k] = np.where(level.quarters == 4, np.inf, -1)

        # Find the smallest residual threshold that gives at most `most` cells
        every = np.unique(np.concatenate([w[(w > 0) & np.isfinite(w)] for w in worth]))
        every = np.append(every, np.inf)
        found = bisect.bisect_left(
            range(len(every) - 1),
            True,
            key=lambda k: self._size(worth, float(every[k])) <= most,
        )
        return self._leaves(worth, every[found])

    def _alive(self, worth: list[_LevelValues], threshold: float) -> list[_LevelMask]:
        # Mask of the cells whose ancestors are all split
        alive = [np.ones(len(self._levels[0].first), dtype=bool)]
        for k, level in enumerate(self._levels[1:]):
            alive.append((alive[k] & (worth[k] >= threshold))[level.parent])
        return alive

    def _size(self, worth: list[_LevelValues], threshold: float) -> int:
        alive = self._alive(worth, threshold)
        halved = [a & (w >= threshold) for a, w in zip(alive, worth, strict=True)]
        return sum(int(a.sum() - h.sum()) for a, h in zip(alive, halved, strict=True))

    def _leaves(self, worth: list[_LevelValues], threshold: float) -> Cells:
        level, first = [], []
        for k, alive in enumerate(self._alive(worth, threshold)):
            leaf = alive & ~(worth[k] >= threshold)
            first.append(self._levels[k].first[leaf])
            level.append(np.full(int(leaf.sum()), k))
        start = np.concatenate(first)
        by_place = np.argsort(start, kind="stable")
        limits = np.append(start[by_place], len(self._order))
        return Cells(np.concatenate(level)[by_place], limits, self._order)


def _levels(
    code: Indices, a: Values, b: Values, values: Values, order: Indices
) -> list[_Level]:
    # Calculate plane fits from the moments of the points about the centre of the square
    x, y, v = a[order] - 0.5, b[order] - 0.5, values[order]
    one = np.ones_like(v)
    moments = np.stack([one, x, y, x * x, x * y, y * y, v, v * x, v * y, v * v], -1)
    floor = _FLOOR * max(float(np.abs(v).mean()), 1e-300)
    levels: list[_Level] = []
    for k in range(FINEST + 1):
        first = np.flatnonzero(np.diff(code >> 2 * (FINEST - k), prepend=-1))
        parent = np.zeros(1, dtype=int)
        if levels:
            parent = np.searchsorted(levels[-1].first, first, side="right") - 1
            np.add.at(levels[-1].quarters, parent, 1)
        sums = np.add.reduceat(moments, first, axis=0)
        loss = _loss(sums, floor) * 2 * np.pi * 0.25**k
        levels.append(_Level(first, parent, loss, np.zeros(len(first), dtype=int)))
    return levels


def _loss(
    sums: Float[np.ndarray, "cells 10"], floor: float
) -> Float[np.ndarray, " cells"]:
    # Root mean square residual of a plane fit, divided by the square root of the mean
    # value, as for photon counts
    n = sums[:, 0]
    x, y, xx, xy, yy, v, vx, vy, vv = (sums[:, 1:] / n[:, None]).T
    xx, xy, yy = xx - x * x, xy - x * y, yy - y * y
    vx, vy, vv = vx - v * x, vy - v * y, np.maximum(vv - v * v, 0)
    determinant = xx * yy - xy * xy
    flat = determinant <= 1e-9 * (xx + yy) ** 2
    safe = np.where(flat, 1, determinant)
    explained = (yy * vx * vx - 2 * xy * vx * vy + xx * vy * vy) / safe
    left = np.maximum(vv - np.where(flat, 0, explained), 0)
    return np.asarray(np.sqrt(left) / np.sqrt(np.maximum(v, 0) + floor))
