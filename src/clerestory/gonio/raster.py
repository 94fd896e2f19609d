"""Rasterization of lobes on the cells of the unit square, with flux conserved.

Each lobe is evaluated near its centre, on the grid whose cells are about as wide as the
lobe, and normalized to its flux. Each grid is then interpolated to the next finer grid,
so that the cost does not depend on the lobe width. The grids use Lambert's equal-area
map, on which lobes are round; finally the BSDF is resampled to the cells of tensor
trees, which have equal projected solid angles.
"""

import functools
import itertools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse

from clerestory.array_types import Directions, Values
from clerestory.gonio.lobes import Lobes
from clerestory.hemisphere.shirley_chiu import (
    cell_centres,
    directions_from_square,
    disc_from_square,
    square_from_disc,
)

# The coarsest grid has 2^4 × 2^4 cells, 9° wide.
_COARSEST = 4

# Smallest radius of the lobes evaluated on a grid [cell widths], and number of cells
# that are evaluated on each side of the lobe centre (3.3 lobe radii).
_CELLS_PER_RADIUS, _SIDE = 0.75, 5

# z of cells in the margin around the grid, so low that lobes are zero in the margin.
_UNREACHED = -1e4

# Widening of lobes on the finest grid [cell widths], added in quadrature to the radius.
_NARROWEST = 0.5

# Each cell of the projected square has 2^2 × 2^2 sample points.
_GATHER = 2

# BSDF and directions of the cells of a grid, and indices of the lobes drawn on a grid
_Cells = Float[np.ndarray, " cells"]
_Centres = Float[np.ndarray, "cells 3"]
_Drawn = Int[np.ndarray, " drawn"]


@dataclass(frozen=True, eq=False)
class Raster:
    """Grids for rasterizing lobes at one resolution."""

    halvings: int  # 2^halvings cells along each axis of the projected square
    # Unit vectors of the cell centres of each grid, coarsest grid first
    directions: tuple[_Centres, ...]
    # Interpolation matrix from the finest grid to the projected square
    gather: sparse.csr_array

    @staticmethod
    @functools.lru_cache(maxsize=8)
    def of(halvings: int) -> "Raster":
        """Return the grids for 2^halvings cells along each axis."""
        finest = max(halvings, _COARSEST)
        directions = tuple(_centres(k) for k in range(_COARSEST, finest + 1))
        return Raster(halvings, directions, _gathering(halvings, finest))

    @property
    def finest(self) -> int:
        """log2 of the number of cells along each axis of the finest grid."""
        return _COARSEST + len(self.directions) - 1

    def cells(self, lobes: Lobes) -> Values:
        """BSDF of each cell of the projected square [1/sr], in row-major order."""
        values = self.gather @ self._drawn(lobes)
        light = values.sum() * np.pi / len(values)
        return np.asarray(values * (lobes.total / light if light > 0 else 0.0))

    def _drawn(self, lobes: Lobes) -> Values:
        # BSDF on the finest grid
        width = np.sqrt(2 * np.pi) * 0.5 ** np.arange(_COARSEST, self.finest + 1)
        grid = np.searchsorted(-_CELLS_PER_RADIUS * width, -lobes.radius, side="left")
        grid = np.minimum(grid, len(width) - 1)
        values = np.zeros(1)
        for k, direction in enumerate(self.directions):
            values = _refined(values) if k else np.zeros(len(direction))
            of = np.flatnonzero(grid == k)
            if len(of):
                # Draw narrower lobes, because interpolation to finer grids widens lobes
                left = len(width) - 1 - k
                change = -0.25 * (1 - 0.25**left) if left else _NARROWEST**2
                draw = _draw_near if k else _draw_everywhere
                values += draw(lobes, of, direction, change * width[k] ** 2)
        return values


def _draw_everywhere(
    lobes: Lobes, of: _Drawn, direction: _Centres, change: float
) -> _Cells:
    square = lobes.radius[of] ** 2 + change
    shape = direction @ (lobes.centre[of] / square[:, None]).T
    shape -= 1 / square
    np.exp(shape, out=shape)
    light = direction[:, 2] @ shape * (2 * np.pi / len(direction))
    return np.asarray(shape @ (lobes.flux[of] / light))


def _draw_near(lobes: Lobes, of: _Drawn, direction: _Centres, change: float) -> _Cells:
    wide = round(len(direction) ** 0.5)
    full = wide + 2 * _SIDE
    x, y, z = _with_margin(wide)
    centre = lobes.centre[of]
    row, column = (np.minimum(a * wide, wide - 1).astype(int) for a in _square(centre))
    line = np.arange(2 * _SIDE + 1)
    about = (line[:, None] * full + line).ravel()
    cell = (row * full + column)[:, None] + about

    # Lobe shape exp((cos α − 1) / r²); flux is weighted by the cosine
    sharp = 1 / (lobes.radius[of] ** 2 + change)
    along = centre * sharp[:, None]
    height = z.take(cell)
    shape = x.take(cell) * along[:, :1]
    shape += y.take(cell) * along[:, 1:2]
    shape += height * along[:, 2:]
    shape -= sharp[:, None]
    np.exp(shape, out=shape)
    light = np.einsum("lc,lc->l", shape, height) * (2 * np.pi / len(direction))
    peak = np.divide(lobes.flux[of], light, out=np.zeros(len(of)), where=light > 0)
    shape *= peak[:, None]
    table = np.bincount(cell.ravel(), shape.ravel(), minlength=full * full)
    return table.reshape(full, full)[_SIDE:-_SIDE, _SIDE:-_SIDE].ravel()


@functools.lru_cache(maxsize=8)
def _with_margin(wide: int) -> tuple[Values, Values, Values]:
    # Directions of the cells of a grid with an empty margin
    table = np.zeros((3, wide + 2 * _SIDE, wide + 2 * _SIDE))
    table[2] = _UNREACHED
    inner = _centres(wide.bit_length() - 1).T.reshape(3, wide, wide)
    table[:, _SIDE:-_SIDE, _SIDE:-_SIDE] = inner
    x, y, z = table.reshape(3, -1)
    return x, y, z


def _refined(values: _Cells) -> Float[np.ndarray, " finer"]:
    # Interpolate to half the cell width: 3/4 of a cell plus 1/4 of the adjacent cell
    wide = round(len(values) ** 0.5)
    table = values.reshape(wide, wide)
    for _ in range(2):
        padded = np.concatenate([table[:1], table, table[-1:]])
        finer = np.empty((2 * len(table), table.shape[1]))
        finer[0::2] = 0.75 * table + 0.25 * padded[:-2]
        finer[1::2] = 0.75 * table + 0.25 * padded[2:]
        table = finer.T
    return table.ravel()


def _square(direction: Directions) -> tuple[Values, Values]:
    scale = 1 / np.sqrt(1 + direction[:, 2])
    return square_from_disc(direction[:, 0] * scale, direction[:, 1] * scale)


def _centres(halvings: int) -> Directions:
    x, y = disc_from_square(*cell_centres(halvings))
    squared = x * x + y * y
    scale = np.sqrt(2 - squared)
    return np.stack([x * scale, y * scale, 1 - squared], axis=-1)


def _gathering(halvings: int, finest: int) -> sparse.csr_array:
    # Average sample points of each projected cell, interpolated on the finest grid
    wide = 1 << halvings
    a, b = cell_centres(halvings + _GATHER)
    place = np.stack(_square(directions_from_square(a, b))) * (1 << finest) - 0.5
    low = np.clip(np.floor(place).astype(int), 0, (1 << finest) - 2)
    share = np.clip(place - low, 0, 1)
    row = (a * wide).astype(int) * wide + (b * wide).astype(int)
    shape = wide * wide, 1 << 2 * finest
    total = sparse.csr_array(shape)
    for da, db in itertools.product((0, 1), repeat=2):
        weight = np.where(da, share[0], 1 - share[0])
        weight = weight * np.where(db, share[1], 1 - share[1]) / 4**_GATHER
        column = ((low[0] + da) << finest) + low[1] + db
        total = total + sparse.csr_array((weight, (row, column)), shape=shape)
    return total
