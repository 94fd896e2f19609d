"""Adaptive sampling of one block of a tensor tree.

A pilot run traces the same number of paths from each incident cell. From its results,
tree cells are selected and the variances of their BSDFs estimated. Further runs trace
more paths from the incident cells with the largest errors, mostly where small exit
cells resolve BSDF peaks.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int64

from clerestory.array_types import Indices, Values
from clerestory.bsdfgen.flux_preserving_merge import HemisphericalFlux
from clerestory.bsdfgen.morton_codes import incident_code
from clerestory.bsdfgen.tree_pruning import (
    Cells,
    NodeValues,
    pruned_levels,
    selected_cells,
)
from clerestory.engine.effort import Effort

# Fraction of all paths that the pilot run traces; if a target error is given, number of
# ray paths per incident cell in the pilot run.
_FIRST_SHARE = 0.25
_PILOT = 256

# Ratio of variance to mean of path weights (Russian roulette), for a lossless film.
_ROULETTE = 0.25

# Largest number of ray paths per incident cell.
_MOST = 1 << 20


@dataclass(frozen=True, eq=False)
class FunctionEstimate:
    """Estimates of one scattering function in one block.

    `finest`: BSDF of the smallest cells. `incident`: directional-hemispherical
    transmittance or reflectance per incident cell. `leaving` (rank 4 only): the same
    per exit cell for reversed light, summed over the incident cells of the block.
    """

    finest: NodeValues
    incident: HemisphericalFlux
    leaving: HemisphericalFlux


@dataclass(frozen=True, eq=False)
class BlockEstimate:
    """Estimates of transmission and reflection of one block."""

    parts: list[FunctionEstimate]
    paths: int
    reached: bool


@dataclass(eq=False)
class BlockEstimator:
    """Monte Carlo estimator of one block, with accumulated sums of path weights.

    Attributes
    ----------
    engine : module of the ray-tracing kernel
    slab : geometry in the sample area, prepared for the kernel
    grid : angular grid of the tree, divided into blocks
    weights : weight of each traced channel in the luminance
    """

    engine: Any
    slab: Any
    grid: Any
    block: int
    back: bool
    weights: Float[np.ndarray, " channel"]

    def __post_init__(self) -> None:
        # Only the lower half of the first dimension of rank 3 trees is used
        half = self.grid.rank == 3 and self.grid.depth > 0
        self._rows = np.arange(self.grid.incidents >> int(half))
        self._paths = np.zeros(self.grid.incidents, dtype=np.int64)
        nothing = np.zeros(0, dtype=np.int64), np.zeros((0, len(self.weights) + 1))
        self._scores = [nothing, nothing]

    def count(self, effort: Effort) -> BlockEstimate:
        """Trace the given number of ray paths, or until the target error is reached."""
        goal = effort.samples
        first = _PILOT if goal is None else max(1, round(goal * _FIRST_SHARE))
        self._trace(np.full(len(self._rows), first), effort)
        while True:
            parts = [self._part(number) for number in range(2)]
            risks = [self._risk(self._cells(part)) for part in parts]
            risk = risks[0] + risks[1]
            spent = self._paths[self._rows]
            if goal is not None:
                more = goal * len(self._rows) - int(spent.sum())
                done = more < len(self._rows) / 4
            else:
                ratio = self._ratio(parts, risk, float(effort.relative_error or 1))
                more = int(spent.sum() * np.clip(ratio**2 - 1, 0.25, 8))
                done = ratio <= 1
            extra = _shared(risk * spent, more)
            short = not done and spent.max() >= _MOST
            if done or short or not extra.any():
                return BlockEstimate(parts, int(spent.sum()), not short)
            self._trace(extra, effort)

    def _trace(self, extra: Indices, effort: Effort) -> None:
        # Group incident cells with equal numbers of previous and of new ray paths
        have = self._paths[self._rows]
        groups = [
            (self._rows[(have == first) & (extra == number)], int(first), int(number))
            for first, number in np.unique(np.stack([have, extra], axis=1), axis=0)
            if number > 0
        ]
        found = self.engine.trace_block(
            self.slab,
            self.grid,
            self.block,
            groups,
            back=self.back,
            segments=(1 << 30) if effort.bounces is None else effort.bounces + 1,
            seed=effort.seed,
        )
        self._scores = [
            _merged(*old, new.cell, new.sums, cells=self.grid.cells)
            for old, new in zip(self._scores, found, strict=True)
        ]
        self._paths[self._rows] += extra

    def _part(self, number: int) -> FunctionEstimate:
        # Estimate a scattering function from sums of path weights
        grid = self.grid
        place, sums = self._scores[number]
        incident = incident_code(place, rank=grid.rank, levels=grid.block)
        exit_size = np.pi / 4**grid.depth
        every = np.maximum(self._paths, 1)
        paths = every[incident]
        mean = sums[:, :-1] / (paths * exit_size)[:, None]
        luminous = sums[:, :-1] @ self.weights
        noise = np.maximum(sums[:, -1] - luminous**2 / paths, 0)
        noise /= (paths * exit_size) ** 2

        # Path weights are close to 0 or 1: for a mean s, the variance is about
        # s (1 − s), and at least s × _ROULETTE
        share = np.bincount(incident, luminous, minlength=grid.incidents) / every
        variance = share * np.maximum(1 - share, _ROULETTE) / every
        single = mean.astype(np.float32), noise.astype(np.float32)
        finest = NodeValues(place.astype(np.int32), *single)
        return FunctionEstimate(
            finest, HemisphericalFlux(share, variance), self._leaving(finest)
        )

    def _leaving(self, finest: NodeValues) -> HemisphericalFlux:
        # Sum the flux in each exit cell over the incident cells of this block
        grid = self.grid
        if grid.rank == 3:
            return HemisphericalFlux(np.zeros(0), np.zeros(0))
        coarse, inner = np.divmod(finest.place, 1 << grid.rank * grid.block)
        cell = incident_code(inner >> 2, rank=grid.rank, levels=grid.block)
        cell |= coarse << 2 * grid.block
        number, size = 4**grid.depth, np.pi / 4**grid.depth
        return HemisphericalFlux(
            np.bincount(cell, finest.mean @ self.weights, number) * size,
            np.bincount(cell, finest.noise, number) * size**2,
        )

    def _cells(self, part: FunctionEstimate) -> Cells:
        # Select the tree cells of the block, separately below each root node
        grid = self.grid
        levels = pruned_levels(
            part.finest, self.weights, rank=grid.rank, levels=grid.block
        )
        roots = 1 << 2 * (grid.depth - grid.block)
        return selected_cells(levels, rank=grid.rank, roots=roots)

    def _risk(self, cells: Cells) -> Values:
        # Expected squared BSDF error per incident cell, summed over smallest exit cells
        grid, bits = self.grid, self.grid.rank - 2
        risk = np.zeros(grid.incidents)
        for height in np.unique(cells.height):
            of = cells.height == height
            square = cells.noise[of] * 4.0 ** (2 * height)
            which = incident_code(
                cells.place[of], rank=grid.rank, levels=grid.block - height
            )
            wide = 1 << bits * height
            sums = np.bincount(which, square, minlength=grid.incidents // wide)
            risk += np.repeat(sums, wide)
        return risk[self._rows]

    def _ratio(self, parts: list[FunctionEstimate], risk: Values, aim: float) -> float:
        # Ratio of the current to the target error
        finest = len(self._rows) << 2 * self.grid.depth
        error = np.sqrt(risk.sum() / (2 * finest))
        total = sum(float((p.finest.mean @ self.weights).sum()) for p in parts)
        mean = total / (2 * finest)
        return float(error / (aim * mean)) if mean > 0 else 0.0


def _shared(cost: Values, more: int) -> Indices:
    # Number of paths per incident cell, in proportion to the square root of `cost`,
    # rounded to powers of two to reduce the number of kernel launches
    root = np.sqrt(cost)
    if more <= 0 or not root.any():
        return np.zeros(len(cost), dtype=int)
    wanted = more * root / root.sum()
    least = max(1.0, more / len(cost) / 8)
    power = np.round(np.log2(np.maximum(wanted, least / 4)))
    return np.where(wanted < least, 0, np.exp2(power)).astype(int)


def _merged(
    place: Int64[np.ndarray, " old"],
    sums: Float[np.ndarray, "old channel"],
    more: Int64[np.ndarray, " new"],
    added: Float[np.ndarray, "new channel"],
    *,
    cells: int,
) -> tuple[Int64[np.ndarray, " cell"], Float[np.ndarray, "cell channel"]]:
    # Add new sums to previous sums; both are sorted by cell
    if not len(place):
        return more, added
    lit = np.zeros(cells, dtype=bool)
    lit[place] = lit[more] = True
    every = np.flatnonzero(lit)
    at = np.empty(cells, dtype=np.int32)
    at[every] = np.arange(len(every), dtype=np.int32)
    total = np.zeros((len(every), sums.shape[1]))
    total[at[place]] = sums
    total[at[more]] += added
    return every, total
