"""Counting the light of one block of a tree, with most paths where errors are largest.

A first round starts equally many paths in each incident cell. The cells that they
justify tell where errors remain: at peaks, where cells stay small. Further rounds
start most paths there.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from clerestory.bsdfgen.branches import incident_part
from clerestory.bsdfgen.effort import TraceEffort
from clerestory.bsdfgen.keep_light import IncidentLight, keep_light
from clerestory.bsdfgen.refine import (
    Cells,
    Light,
    chosen_cells,
    coarser_light,
    finest_light,
)

# Share of the paths in the first round, and paths from each cell in it if an error is
# aimed at.
_FIRST_SHARE = 0.25
_PILOT = 256

# Variance of what leaves a path of a film that loses nothing, by Russian roulette.
_ROULETTE = 0.25

# Most paths from one incident cell: an aim that needs more is out of reach.
_MOST = 1 << 20


@dataclass(frozen=True, eq=False)
class BlockCells:
    """The cells of one block for one function.

    Attributes
    ----------
    roots : the nodes that the block consists of
    cells : below them
    """

    roots: Light
    cells: Cells


@dataclass(frozen=True, eq=False)
class Counted:
    """What was counted in one block.

    Attributes
    ----------
    transmission, reflection : cells
    paths : traced
    reached : whether the error aimed at was reached
    """

    transmission: BlockCells
    reflection: BlockCells
    paths: int
    reached: bool


@dataclass(eq=False)
class Counter:
    """Sums of the light in one block, growing round by round.

    Attributes
    ----------
    engine, slab, grid : what traces
    block : number of the block
    back : whether light comes from the room
    weights : share of each traced channel in the luminous value
    """

    engine: Any
    slab: Any
    grid: Any
    block: int
    back: bool
    weights: Float[np.ndarray, " channel"]

    def __post_init__(self) -> None:
        # Rank 3 has directions in the lower half of its first dimension only
        half = self.grid.rank == 3 and self.grid.depth > 0
        self._rows = np.arange(self.grid.incidents >> int(half))
        self._paths = np.zeros(self.grid.incidents, dtype=np.int64)
        shape = 2, self.grid.cells, len(self.weights) + 1
        self._sums = np.zeros(shape)
        levels = np.arange(self.grid.cells)
        self._incident = incident_part(
            levels, rank=self.grid.rank, levels=self.grid.block
        )

    def count(self, effort: TraceEffort) -> Counted:
        """Trace until the samples are spent or the error is reached."""
        goal = effort.samples
        first = _PILOT if goal is None else max(1, round(goal * _FIRST_SHARE))
        self._trace(np.full(len(self._rows), first), effort)
        while True:
            found = self._cells(self._sums[0]), self._cells(self._sums[1])
            risk = self._risk(found[0].cells) + self._risk(found[1].cells)
            spent = self._paths[self._rows]
            if goal is not None:
                more = goal * len(self._rows) - int(spent.sum())
                done = more < len(self._rows) / 4
            else:
                ratio = self._ratio(found, risk, float(effort.relative_error or 1))
                more = int(spent.sum() * np.clip(ratio**2 - 1, 0.25, 8))
                done = ratio <= 1
            extra = _shared(risk * spent, more)
            short = not done and spent.max() >= _MOST
            if done or short or not extra.any():
                both = zip(found, self._sums, strict=True)
                passed, back = (self._kept(*one) for one in both)
                return Counted(passed, back, int(spent.sum()), not short)
            self._trace(extra, effort)

    def _trace(self, extra: Int[np.ndarray, " row"], effort: TraceEffort) -> None:
        # Cells that go on from the same number by the same number go together
        have = self._paths[self._rows]
        groups = [
            (self._rows[(have == first) & (extra == number)], int(first), int(number))
            for first, number in np.unique(np.stack([have, extra], axis=1), axis=0)
            if number > 0
        ]
        self._sums += self.engine.trace_block(
            self.slab,
            self.grid,
            self.block,
            groups,
            back=self.back,
            segments=(1 << 30) if effort.bounces is None else effort.bounces + 1,
            seed=effort.seed,
        )
        self._paths[self._rows] += extra

    def _cells(self, sums: Float[np.ndarray, "cell more"]) -> BlockCells:
        grid = self.grid
        exit_size = np.pi / 4**grid.depth
        paths = np.maximum(self._paths, 1)[self._incident]
        mean = sums[:, :-1] / (paths * exit_size)[:, None]
        luminous = sums[:, :-1] @ self.weights
        noise = np.maximum(sums[:, -1] - luminous**2 / paths, 0)
        noise /= (paths * exit_size) ** 2
        if grid.rank == 3 and grid.depth > 0:
            _fill_other_half(mean, noise)
        levels = [finest_light(mean, noise, self.weights)]
        width = 1 << grid.rank
        for height in range(1, grid.block + 1):
            cells = width**height
            levels.append(
                coarser_light(levels[-1], self.weights, width=width, cells=cells)
            )
        levels.reverse()
        if grid.rank == 3 and grid.depth > 0:
            _empty_other_half(levels)
        return BlockCells(levels[0], chosen_cells(levels, rank=grid.rank))

    def _kept(
        self, found: BlockCells, sums: Float[np.ndarray, "cell more"]
    ) -> BlockCells:
        # All that leaves a path is about 0 to 1 in all: its variance is s (1 - s), or
        # what roulette adds where nothing is lost
        luminous = sums[:, :-1] @ self.weights
        total = np.bincount(self._incident, luminous, minlength=self.grid.incidents)
        paths = np.maximum(self._paths, 1)
        share = total / paths
        light = IncidentLight(share, share * np.maximum(1 - share, _ROULETTE) / paths)
        cells = keep_light(
            found.cells, light, self.weights, rank=self.grid.rank, depth=self.grid.depth
        )
        return BlockCells(found.roots, cells)

    def _risk(self, cells: Cells) -> Float[np.ndarray, " row"]:
        # Expected square of the errors, summed over the finest cells of each row
        grid, bits = self.grid, self.grid.rank - 2
        risk = np.zeros(grid.incidents)
        for height in np.unique(cells.height):
            of = cells.height == height
            square = cells.noise[of] * 4.0 ** (2 * height)
            which = incident_part(
                cells.place[of], rank=grid.rank, levels=grid.block - height
            )
            wide = 1 << bits * height
            sums = np.bincount(which, square, minlength=grid.incidents // wide)
            risk += np.repeat(sums, wide)
        return risk[self._rows]

    def _ratio(
        self,
        found: tuple[BlockCells, ...],
        risk: Float[np.ndarray, " row"],
        aim: float,
    ) -> float:
        # How many times the error aimed at remains
        finest = len(self._rows) << 2 * self.grid.depth
        error = np.sqrt(risk.sum() / (2 * finest))
        mean = float(np.mean([part.roots.mean @ self.weights for part in found]))
        return float(error / (aim * mean)) if mean > 0 else 0.0


def _shared(cost: Float[np.ndarray, " row"], more: int) -> Int[np.ndarray, " row"]:
    # Paths for each row: the root of its cost, in powers of two for few launches
    root = np.sqrt(cost)
    if more <= 0 or not root.any():
        return np.zeros(len(cost), dtype=int)
    wanted = more * root / root.sum()
    least = max(1.0, more / len(cost) / 8)
    power = np.round(np.log2(np.maximum(wanted, least / 4)))
    return np.where(wanted < least, 0, np.exp2(power)).astype(int)


def _fill_other_half(
    mean: Float[np.ndarray, "cell channel"], noise: Float[np.ndarray, " cell"]
) -> None:
    # The upper half of a rank 3 tree repeats the lower one while cells are chosen
    eighth = len(mean) // 8
    for branch in range(1, 8, 2):
        upper = slice(branch * eighth, (branch + 1) * eighth)
        lower = slice((branch - 1) * eighth, branch * eighth)
        mean[upper], noise[upper] = mean[lower], noise[lower]


def _empty_other_half(levels: list[Light]) -> None:
    # It is never looked up: one cell of nothing for each of its branches
    levels[0].split[:] = True
    levels[1].split[1::2] = False
    levels[1].mean[1::2] = 0
    levels[1].noise[1::2] = 0
