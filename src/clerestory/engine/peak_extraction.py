"""Extraction of unscattered transmission from a BSDF (Radiance's aBSDF).

A clear pane in a BSDF file is one bright cell around the direction of straight
transmission. The peak consists of the cells around that direction that are at least an
eighth as bright as the brightest cell and at most 1.5 times as large as the smallest
cell of the file. The flux of the peak above the surrounding BTDF is transmitted
undeflected, and is removed from the BTDF.

The criteria are documented in Radiance's source (m_bsdf.c).
"""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Int64

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.colorimetry import rgb_from_xyz
from clerestory.engine.square import cell_of_disc
from clerestory.engine.upload import on_device
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square

# Number of cells along an edge of the look-up grid of directions.
_GRID = 128

# Points around the direction of direct transmission, _STEP smallest cells apart on the
# disc. Cells with a point within _CORE can belong to a peak; they end within _REACH.
_STEP, _CORE, _REACH = 0.6, 2.55, 4.3
_EXTENT = int(_REACH / _STEP)
_STEPS = np.array(
    [
        (i, j)
        for i in range(-_EXTENT, _EXTENT + 1)
        for j in range(-_EXTENT, _EXTENT + 1)
        if np.hypot(i, j) * _STEP <= _REACH
    ]
)
_IN_CORE = np.hypot(*_STEPS.T) * _STEP <= _CORE

_CONTRAST = 8.0
_LARGEST = 1.5

# Smallest transmittance of a peak.
_FAINT = 5e-4

_SIDES: tuple[Function, ...] = ("transmission_front", "transmission_back")


class PeakTable:
    """Dr.Jit arrays of the direct transmission (peak) of a layer.

    The arrays are indexed by the direction of the light, as the values of the file are:
    the peak and the remaining BTDF together conserve the flux of each incident
    direction. The first half of each array is for light into the room, the second half
    for light to the outside.
    """

    def __init__(self, bsdf: Bsdf):
        found = zip(*(_peaks(bsdf, side) for side in _SIDES), strict=True)
        self.passed, self.surround, self.limit, self.radius2 = (
            on_device(mi.Float, np.stack(parts)) for parts in found
        )

    def _cell(self, along):
        # Cell of the direction in which light propagates
        outside = dr.select(along.z > 0, mi.UInt32(0), mi.UInt32(_GRID * _GRID))
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


def _peaks(
    bsdf: Bsdf, side: Function
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    # For each grid cell: RGB direct transmittance, surrounding BTDF, least BTDF of the
    # peak; for all cells: squared radius of the peak on the disc
    cells = _GRID * _GRID
    none = np.zeros((cells, 3)), np.zeros(cells), np.full(cells, np.inf), 0.0
    if not bsdf.has(side):
        return none
    luminous = bsdf.scattering(side)
    smallest = _smallest(luminous)
    if smallest is None:
        return none
    edge = float(np.sqrt(smallest))
    incident, leaving, inside = _around(edge)
    parts = bsdf.xyz(side) if bsdf.in_colour(side) else (luminous,)
    values = [np.where(inside, part.evaluate(incident, leaving), 0) for part in parts]
    size = luminous.resolution(incident, leaving)
    bright = values[len(values) // 2]
    number = np.where(inside, luminous.cell(incident, leaving), -1)
    in_peak, limit = _select(bright, size, number, smallest)

    # Transmittance of the peak above the surrounding BTDF; each cell counts once
    first = _first_of_each(number) & inside
    around = first & _IN_CORE & ~in_peak
    weight = np.where(around, size, 0).sum(axis=1)
    surround = np.where(around, bright * size, 0).sum(axis=1)
    surround = np.divide(surround, weight, out=np.zeros(cells), where=weight > 0)
    counted = in_peak & first
    above = [
        np.where(counted, (v - surround[:, None]) * size, 0).sum(axis=1) for v in values
    ]
    rgb = np.stack(above * (3 // len(above)))
    if len(parts) == 3:
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


def _around(edge: float):
    # Incident direction of each grid cell, and exit directions around that of direct
    # transmission
    along = directions_from_square(*cell_centres(_GRID.bit_length() - 1))
    disc = along[:, None, :2] + _STEPS * (_STEP * edge)
    radius2 = np.sum(disc**2, axis=-1)
    inside = radius2 < 1
    height = np.sqrt(np.maximum(1 - radius2, 1e-9))
    leaving = np.concatenate([disc, height[..., None]], axis=-1)
    leaving /= np.linalg.norm(leaving, axis=-1, keepdims=True)
    return np.broadcast_to(-along[:, None], leaving.shape), leaving, inside


def _first_of_each(number: Int64[np.ndarray, "cell step"]):
    # First point of each cell of the file
    order = np.argsort(number, axis=1, kind="stable")
    ranked = np.take_along_axis(number, order, axis=1)
    new = np.ones_like(ranked, dtype=bool)
    new[:, 1:] = ranked[:, 1:] != ranked[:, :-1]
    first = np.zeros_like(new)
    np.put_along_axis(first, order, new, axis=1)
    return first


def _select(values, size, number, smallest: float):
    # Points of the peak: bright cells that are small and have a point in the core, and
    # are brighter than all other cells within reach, which `without` cannot tell apart
    small = (number >= 0) & (size <= _LARGEST * smallest)
    brightest = np.where(_IN_CORE, values, 0).max(axis=1)
    limit = brightest / _CONTRAST
    core = np.where(_IN_CORE & small & (values > limit[:, None]), number, -2)
    in_peak = np.zeros_like(small)
    for column in np.flatnonzero(_IN_CORE):
        in_peak |= number == core[:, column, None]
    limit = np.maximum(limit, np.where(in_peak, 0, values).max(axis=1))
    in_peak &= values > limit[:, None]
    return in_peak, np.where(in_peak.any(axis=1), limit, np.inf)
