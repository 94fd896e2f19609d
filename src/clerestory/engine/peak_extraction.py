"""Extraction of unscattered transmission from a BSDF (Radiance's aBSDF).

A clear pane in a BSDF file is one bright cell around the direction of straight
transmission. The peak consists of the cells around that direction that are at least an
eighth as bright as the brightest cell, at most 1.5 times as large as the smallest cell
of the file, and brighter than all other cells near that direction. The flux of the peak
above the surrounding BTDF is transmitted undeflected, and is removed from the BTDF.

The criteria are those of Radiance (m_bsdf.c), which selects the peak for each direction
of view. Here it is selected for each direction of light, which conserves its flux.
"""

from collections.abc import Collection
from functools import lru_cache

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.colorimetry import rgb_from_xyz
from clerestory.engine.square import cell_of_disc
from clerestory.engine.upload import on_device
from clerestory.hemisphere.shirley_chiu import (
    cell_centres,
    cells_from_disc,
    directions_from_square,
)

# Number of cells along an edge of the look-up grid of directions, and of all cells.
_GRID = 128
_CELLS = _GRID * _GRID

# Points around the direction of direct transmission, _STEP smallest cells apart on the
# disc. Cells with a point within _CORE can belong to a peak; they end within _REACH.
_STEP, _CORE, _REACH = 0.6, 2.55, 4.3
_EXTENT = int(_REACH / _STEP)
_GRID_STEPS = np.indices((2 * _EXTENT + 1,) * 2).reshape(2, -1).T - _EXTENT
_DISTANCE = _STEP * np.hypot(*_GRID_STEPS.T)
_INNER = _GRID_STEPS[_DISTANCE <= _CORE]
_OUTER = _GRID_STEPS[(_DISTANCE > _CORE) & (_DISTANCE <= _REACH)]

_CONTRAST = 8.0
_LARGEST = 1.5

# Smallest transmittance of a peak.
_FAINT = 5e-4

_SIDES: tuple[Function, ...] = ("transmission_front", "transmission_back")

# Transmission into the room, alone
INWARDS: tuple[Function, ...] = ("transmission_front",)

_Peaks = tuple[np.ndarray, np.ndarray, np.ndarray, float]


class PeakTable:
    """Dr.Jit arrays of the direct transmission (peak) of a layer.

    The arrays are indexed by the direction of the light, as the values of the file are:
    the peak and the remaining BTDF together conserve the flux of each incident
    direction. The first half of each array is for light into the room, the second half
    for light to the outside. Functions that are not among `sides` have no peak.
    """

    def __init__(self, bsdf: Bsdf, sides: Collection[Function] = _SIDES):
        parts = [_peaks(bsdf, side) if side in sides else _none() for side in _SIDES]
        found = zip(*parts, strict=True)
        self.passed, self.surround, self.limit, self.radius2 = (
            on_device(mi.Float, np.stack(parts)) for parts in found
        )

    def _cell(self, along):
        # Cell of the direction in which light propagates
        outside = dr.select(along.z > 0, mi.UInt32(0), mi.UInt32(_CELLS))
        return outside + cell_of_disc(along, _GRID)

    def transmittance(self, wi):
        """Return the direct transmittance towards an exiting direction."""
        return dr.gather(mi.Color3f, self.passed, self._cell(wi))

    def without(self, value, wi, wo):
        """Return a BTDF value of the layer with the peak removed [1/sr].

        `wi`: exiting direction, towards the eye; `wo`: towards the source of light
        """
        cell = self._cell(-wo)
        side = dr.select(wi.z > 0, mi.UInt32(0), mi.UInt32(1))
        apart = dr.square(wi.x + wo.x) + dr.square(wi.y + wo.y)
        near = apart <= dr.gather(mi.Float, self.radius2, side)
        peak = near & (dr.sum(value) / 3 > dr.gather(mi.Float, self.limit, cell))
        return dr.select(peak, dr.gather(mi.Float, self.surround, cell), value)


def peak_cells(
    along: Float[np.ndarray, "ray 3"],
) -> list[Int[np.ndarray, " ray"]]:
    """Return row and column of the look-up grid for light that propagates `along`."""
    halvings = _GRID.bit_length() - 1
    return list(cells_from_disc(along[:, 0], along[:, 1], halvings=halvings))


def _none() -> _Peaks:
    return np.zeros((_CELLS, 3)), np.zeros(_CELLS), np.full(_CELLS, np.inf), 0.0


@lru_cache(maxsize=4)
def _peaks(bsdf: Bsdf, side: Function) -> _Peaks:
    # For each grid cell: RGB direct transmittance, surrounding BTDF, least BTDF of the
    # peak; for all cells: squared radius of the peak on the disc
    if not bsdf.has(side):
        return _none()
    luminous = bsdf.scattering(side)
    smallest = _smallest(luminous)
    if smallest is None:
        return _none()
    incident, leaving, inside = _around(_INNER, smallest)
    found, size, number = luminous.cell_values(incident, leaving)
    values = [np.where(inside, found, 0)]
    if bsdf.in_colour(side):
        parts = (part.evaluate(incident, leaving) for part in bsdf.xyz(side))
        values = [np.where(inside, part, 0) for part in parts]
    bright = values[len(values) // 2]

    # Select bright small cells; they must be brighter than all other cells within
    # reach, because `without` selects them by their values
    limit = bright.max(axis=1) / _CONTRAST
    in_peak = inside & (size <= _LARGEST * smallest) & (bright > limit[:, None])
    others = np.where(in_peak, 0, bright).max(axis=1)
    limit = np.maximum(limit, others)
    in_peak &= bright > limit[:, None]
    limit = np.maximum(limit, _outside(luminous, smallest, limit, number, in_peak))
    in_peak &= bright > limit[:, None]

    # Transmittance of the peak above the surrounding BTDF; each cell counts once
    first = _first_of_each(np.where(inside, number, -1)) & inside
    around = first & ~in_peak
    weight = np.where(around, size, 0).sum(axis=1)
    surround = np.where(around, bright * size, 0).sum(axis=1)
    surround = np.divide(surround, weight, out=np.zeros(_CELLS), where=weight > 0)
    counted = in_peak & first
    above = [
        np.where(counted, (v - surround[:, None]) * size, 0).sum(axis=1) for v in values
    ]
    rgb = np.stack(above * (3 // len(above)))
    if len(values) == 3:
        rgb = rgb_from_xyz(np.maximum(rgb, 0)[:, :, None])[:, :, 0]
    clear = (above[len(above) // 2] >= _FAINT) & (weight > 0)
    rgb = np.where(clear, rgb, 0).T
    limit = np.where(clear, limit, np.inf)
    return rgb, surround, limit, smallest * _REACH**2


def _smallest(part: ScatteringFunction) -> float | None:
    if isinstance(part, ScatteringTree):
        return float(np.pi * 0.25**part.depth)
    if isinstance(part, ScatteringMatrix):
        return float(part.exits.projected_solid_angles().min())
    return _smallest(part.reciprocal())


def _around(steps: Int[np.ndarray, "step 2"], smallest: float, cells=slice(None)):
    # Incident direction of grid cells, and exit directions around that of direct
    # transmission
    along = directions_from_square(*cell_centres(_GRID.bit_length() - 1))[cells]
    disc = along[:, None, :2] + steps * (_STEP * np.sqrt(smallest))
    radius2 = np.sum(disc**2, axis=-1)
    inside = radius2 < 1
    height = np.sqrt(np.maximum(1 - radius2, 1e-9))
    leaving = np.concatenate([disc, height[..., None]], axis=-1)
    return np.broadcast_to(-along[:, None], leaving.shape), leaving, inside


def _outside(part: ScatteringFunction, smallest: float, limit, number, in_peak):
    # Largest BTDF above the limit in cells that are within reach, but not in the peak
    most = np.zeros(len(limit))
    row = np.flatnonzero(in_peak.any(axis=1))
    incident, leaving, inside = _around(_OUTER, smallest, row)
    values = np.where(inside, part.evaluate(incident, leaving), 0)
    at, step = np.nonzero(values > limit[row, None])
    row = row[at]
    cell = part.cell_values(incident[at, step], leaving[at, step]).number
    other = np.all((number[row] != cell[:, None]) | ~in_peak[row], axis=1)
    np.maximum.at(most, row[other], values[at, step][other])
    return most


def _first_of_each(number: Int[np.ndarray, "cell step"]):
    # First point of each cell of the file
    order = np.argsort(number, axis=1, kind="stable")
    ranked = np.take_along_axis(number, order, axis=1)
    new = np.ones_like(ranked, dtype=bool)
    new[:, 1:] = ranked[:, 1:] != ranked[:, :-1]
    first = np.zeros_like(new)
    np.put_along_axis(first, order, new, axis=1)
    return first
