"""Correction of merged tree cells that preserves hemispherical flux.

Cells are merged if their BSDFs do not differ by more than the noise. If the
directional-hemispherical transmittance (or reflectance) differs between the incident
cells that are merged, each BSDF value stays accurate within its noise, but the sum over
exit cells does not. Hemispherical transmittances have less noise than single BSDF
values: where they differ, merged cells are subdivided and scaled to match them.

Differences are tested at all scales, as means over many cells have less noise. Enough
of the brightest merged cells are subdivided to keep the correction of each cell small.
Rank 4 trees are also used with incident and exit directions exchanged: the fluxes of
incident, exit and again incident cells are corrected (iterative proportional fitting).

Reference: W. E. Deming, F. F. Stephan, "On a least squares adjustment of a sampled
frequency table when the expected marginal totals are known", Annals of Mathematical
Statistics 11 (4), 1940.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float64, Int32

from clerestory.array_types import Values
from clerestory.bsdfgen.morton_codes import incident_code
from clerestory.bsdfgen.subcells import Subcells

# Largest tolerated flux error, as a fraction of the incident flux, for incident cells
# of width 2^-_SPAN or more of the unit square; doubled each time the width is halved.
# A flux error is corrected only if it also exceeds _SURE standard errors.
_TOLERANCE = 0.004
_SPAN = 5
_SURE = 0.3

# Same as _SURE for exit cells, whose flux estimates have more noise.
_SURE_LEAVING = 2.0

# Ratio of the flux in subdivided cells to the required flux change.
_STRETCH = 3.0

# Largest relative change, once larger subcells have used more than half of the flux.
_CHANGE = 0.5

# Largest number of subcells that are summed together.
_TOGETHER = 1 << 20


@dataclass(frozen=True, eq=False)
class HemisphericalFlux:
    """Luminous transmittance or reflectance per cell, 0…1, and its variance.

    The cells are incident cells or, for reversed light paths, exit cells.
    """

    share: Float[np.ndarray, " incident"]
    variance: Float[np.ndarray, " incident"]


def preserve_flux(
    pieces: list[Subcells],
    luminous: Values,
    light: HemisphericalFlux,
    *,
    rank: int,
    by_leaving: bool = False,
) -> list[Subcells]:
    """Subdivide and scale merged cells so that hemispherical transmittance or
    reflectance is preserved.

    Parameters
    ----------
    pieces : subcells of each size, from the smallest cells to the root
    luminous : luminance-weighted BSDF of each cell [1/sr]
    by_leaving : whether `light`, the flux to preserve, is per exit cell (rank 4 only)
    """
    depth = len(pieces) - 1
    tally = _Tally(luminous, len(light.share), rank, depth, 2 if by_leaving else 0)
    alone, joined = pieces[0], [pieces[0].only(slice(0)), *pieces[1:]]
    doubt = (_SURE_LEAVING if by_leaving else _SURE) ** 2 * light.variance
    left = np.maximum(light.share - tally.light(alone, 0), 0)
    together = tally.lights(joined)
    scale = np.where(together > 0, left / np.where(together > 0, together, 1), 1)
    for height in range(depth, 0, -1):
        wide = 1 << (rank - 2) * height
        moved = _moved(scale, together, doubt, height, bits=rank - 2, depth=depth)
        finer = _means(tally.lights(joined[:height]), wide)
        need = np.minimum(_STRETCH * moved, _means(together, wide)) - finer
        split = tally.brightest(joined[height], need * wide, height)
        joined[height], branches = joined[height].cut(split, rank=rank)
        joined[height - 1] = joined[height - 1].beside(branches)
    scaled = tally.scaled(joined, left)
    return [alone.beside(scaled[0]), *scaled[1:]]


def preserve_flux_on_both_sides(
    pieces: list[Subcells],
    luminous: Values,
    incident: HemisphericalFlux,
    leaving: HemisphericalFlux,
) -> list[Subcells]:
    """Preserve the flux of incident and of exit cells; see `preserve_flux`."""
    for light, by_leaving in ((incident, False), (leaving, True), (incident, False)):
        pieces = preserve_flux(pieces, luminous, light, rank=4, by_leaving=by_leaving)
    return pieces


def _moved(
    scale: Float[np.ndarray, " incident"],
    together: Float[np.ndarray, " incident"],
    doubt: Float[np.ndarray, " incident"],
    height: int,
    *,
    bits: int,
    depth: int,
) -> Float[np.ndarray, " block"]:
    # Largest flux error within each merged cell of one size; errors below the
    # tolerance or the standard error count as zero
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
    # Flux from each incident cell into subcells
    luminous: Float[np.ndarray, " cell"]
    incidents: int
    rank: int
    depth: int
    skip: int  # number of low code bits to drop: 0 for incident, 2 for exit cells

    def lights(self, pieces: Sequence[Subcells]) -> Float64[np.ndarray, " incident"]:
        """Flux from each incident cell into subcells of all sizes, smallest first."""
        total = np.zeros(self.incidents)
        for height, part in enumerate(pieces):
            total += self.light(part, height)
        return total

    def light(self, pieces: Subcells, height: int) -> Float64[np.ndarray, " incident"]:
        """Flux from each incident cell into the subcells of one size."""
        wide = 1 << (self.rank - 2) * height
        sums = np.zeros(self.incidents // wide)
        for start in range(0, len(pieces), _TOGETHER):
            some = pieces.only(slice(start, start + _TOGETHER))
            block = self.block(some, height)
            sums += np.bincount(block, self.share(some, height), len(sums))
        return np.repeat(sums, wide)

    def share(self, pieces: Subcells, height: int) -> Float64[np.ndarray, " piece"]:
        """Flux into each subcell from one incident cell of the smallest size."""
        size = np.pi * 4.0 ** (height - self.depth)
        return np.asarray(self.luminous[pieces.cell] * pieces.factor * size)

    def block(self, pieces: Subcells, height: int) -> Int32[np.ndarray, " piece"]:
        """Index of the incident cell of each subcell, among cells of equal size."""
        levels = self.depth - height
        return incident_code(pieces.place >> self.skip, rank=self.rank, levels=levels)

    def brightest(
        self, pieces: Subcells, need: Float[np.ndarray, " block"], height: int
    ) -> Bool[np.ndarray, " piece"]:
        """Mask of the brightest subcells that together have the flux `need`."""
        found = np.zeros(len(pieces), dtype=bool)
        if not len(pieces):
            return found
        block = self.block(pieces, height)
        light = self.share(pieces, height) * (1 << (self.rank - 2) * height)
        order = np.lexsort((-light, block))
        block, light = block[order], light[order]
        before = np.cumsum(light) - light
        first = np.searchsorted(block, np.arange(len(need)))
        start = before[np.minimum(first, len(before) - 1)]
        found[order] = (light > 0) & (before - start[block] < need[block])
        return found

    def scaled(
        self, pieces: list[Subcells], left: Float64[np.ndarray, " incident"]
    ) -> list[Subcells]:
        """Scale subcells, largest size first, by the ratio of the required flux to the
        flux of all subcells that remain, for each incident cell.
        """
        found = list(pieces)
        own = [self.light(part, height) for height, part in enumerate(pieces)]
        rest = every = np.sum(own, axis=0)
        for height in range(self.depth, -1, -1):
            wide = 1 << (self.rank - 2) * height
            target, have = _means(left, wide), _means(rest, wide)
            ratio = np.where(have > 0, target / np.where(have > 0, have, 1), 1)
            few = have < _means(every, wide) / 2
            ratio[few] = np.clip(ratio[few], 1 - _CHANGE, 1 + _CHANGE)
            part = pieces[height]
            factor = ratio.astype(np.float32)[self.block(part, height)]
            found[height] = Subcells(part.place, part.cell, part.factor * factor)
            left = np.maximum(left - own[height] * np.repeat(ratio, wide), 0)
            rest = rest - own[height]
        return found
