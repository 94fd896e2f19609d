"""Lobes for one scan: an adaptive grid, a lobe a cell, fluxes that explain the values.

Centres and radii follow the cells of a quadtree; fluxes are those that are nowhere
negative and come nearest to the measured values, each weighted like a count of
photons. Where there are no data, as in the shadow of the detector, fluxes keep to what
the mean of their cell says. At the end all fluxes are scaled to the measured total.
"""

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Values
from clerestory.errors import InputError
from clerestory.gonio.hemispherical_integration import integration_weights
from clerestory.gonio.lobes import LEAST_RADIUS, MOST_RADIUS, NO_LIGHT, Lobes
from clerestory.gonio.nonnegative_least_squares import non_negative
from clerestory.gonio.parallel import Report, map_in_order, silent
from clerestory.gonio.quadtree import Quadtree
from clerestory.gonio.scattering_measurement import Scan

# Means of neighbouring points that stand for the points themselves in a fit.
_MOST_BINS = 2000

# Least share of the mean weight that a point keeps, so that every bin has a mean.
_LEAST_WEIGHT = 1e-6

# Halvings of the coarsest cells: of bins, a lobe's own cell and those about it.
_COARSEST_BIN, _COARSEST_LOBE = 5, 2

# Radius of a lobe over the width of its cell, if smoothing is 1. Lobes at this
# distance sum to an even plain.
_RADIUS_OVER_WIDTH = 0.6

# Fits that misplace more of the light than this get twice as many lobes.
_MISPLACED = 0.05

# Scans that scatter less than this share of the brightest are dark.
_DARK = 1e-3

# Weight of the mean of a cell against the values themselves.
_PRIOR = 1e-2

# Share of the values that may lie below what is taken to be everywhere.
_EVEN = 0.05

# Share of the mean value below which differences count less.
_FLOOR = 1e-2


@dataclass(frozen=True)
class FitOptions:
    """How scans become lobes.

    Attributes
    ----------
    lobes : most lobes a scan; twice as many where these misplace more than a
        twentieth of the light, as on plateaus with steep edges
    smoothing : width of lobes against the distance between them; 1 is an even sum,
        less is sharper and follows noise, more is softer

    Raises
    ------
    InputError : fewer than 4 lobes or a smoothing outside 0.2…5
    """

    lobes: int = 200
    smoothing: float = 1.0

    def __post_init__(self) -> None:
        if self.lobes < 4 or not 0.2 <= self.smoothing <= 5:
            raise InputError(
                f"{self.lobes} lobes of smoothing {self.smoothing}; 4 or more lobes"
                " and a smoothing from 0.2 to 5 expected"
            )


DEFAULT = FitOptions()


@dataclass(frozen=True, eq=False)
class Points:
    """Values at directions, and the projected solid angle each stands for.

    Attributes
    ----------
    direction : unit vectors
    value : BSDF [1/sr]
    weight : projected solid angles [sr], π in all
    """

    direction: Float[np.ndarray, "points 3"]
    value: Float[np.ndarray, " points"]
    weight: Float[np.ndarray, " points"]

    @property
    def flux(self) -> float:
        """Share of the incident light that is scattered in all."""
        return float(self.value @ self.weight)


def condense(scan: Scan, *, most: int = _MOST_BINS) -> Points:
    """Return a scan as at most `most` points, each the mean of its neighbours.

    Every value counts by the projected solid angle it stands for, so that a bin half
    of which was scanned finely has the mean of its area, and no flux is lost.
    """
    share = integration_weights(scan.leaving)
    if len(share) <= most:
        return Points(scan.leaving, scan.values, share)
    cells = Quadtree(scan.leaving, scan.values).cut(most, coarsest=_COARSEST_BIN)
    share = np.maximum(share, _LEAST_WEIGHT * share.mean())
    weight = cells.sum(share)
    return Points(
        cells.mean_direction(scan.leaving, share),
        cells.sum(scan.values * share) / weight,
        weight * (np.pi / weight.sum()),
    )


def total_flux(scan: Scan) -> float:
    """Share of the incident light that a scan finds scattered in all."""
    return float(scan.values @ integration_weights(scan.leaving))


def fit_scans(
    scans: Sequence[Scan],
    *,
    options: FitOptions = DEFAULT,
    processes: int = 1,
    report: Report = silent,
) -> list[Lobes]:
    """Return the lobes of every scan.

    A scan that finds next to none of the light of the brightest is dark, as behind a
    film that turns all light back.

    Raises
    ------
    InputError : a scan, or all, scatter no light in all
    """
    most = max(total_flux(scan) for scan in scans)
    return map_in_order(
        functools.partial(_fitted_or_dark, options=options, least=_DARK * most),
        scans,
        processes=processes,
        report=report,
    )


def _fitted_or_dark(scan: Scan, *, options: FitOptions, least: float) -> Lobes:
    if abs(total_flux(scan)) < least:
        up = np.array([[0.0, 0.0, 1.0]])
        return Lobes(up, np.full(1, MOST_RADIUS), np.full(1, NO_LIGHT))
    return fit_lobes(scan, options)


def fit_lobes(scan: Scan, options: FitOptions = DEFAULT) -> Lobes:
    """Return the lobes of a scan; their flux is that of the scan.

    Raises
    ------
    InputError : the scan scatters no light in all
    """
    points = condense(scan)
    if points.flux <= 0:
        raise InputError(
            f"{points.flux:.3g} of the light from {scan.words} is scattered; more than"
            " zero expected: is the blank reading too large?",
            file=scan.source,
        )
    lobes = _fitted(points, options, options.lobes)
    if misplaced_light(points, lobes.evaluate(points.direction)) > _MISPLACED:
        lobes = _fitted(points, options, 2 * options.lobes)
    return lobes


def misplaced_light(points: Points, predicted: Values) -> float:
    """Share of measured light that a prediction puts elsewhere; 1 where it is dark.

    Parameters
    ----------
    points : of a scan, condensed
    predicted : BSDF at the points [1/sr]
    """
    if points.flux <= 0:
        return 1.0
    moved = points.weight @ np.abs(predicted - points.value) / 2
    return float(moved / points.flux)


def _fitted(points: Points, options: FitOptions, most: int) -> Lobes:
    # At most so many lobes, scaled to the flux of the points
    centre, radius, prior = _placed(points, options, most)
    basis = Lobes(centre, radius, prior).basis(points.direction)
    flux = _solve(basis, points, prior)
    keep = flux > 1e-9 * flux.sum()
    scale = points.flux / flux.sum()
    return Lobes(centre[keep], radius[keep], flux[keep] * scale)


def _placed(
    points: Points, options: FitOptions, most: int
) -> tuple[
    Directions,
    Values,
    Values,
]:
    # A lobe a cell: at the centroid of its light, as wide as the cell, with its flux
    cells = Quadtree(points.direction, points.value).cut(
        most - 1, coarsest=_COARSEST_LOBE
    )
    bright = np.maximum(points.value, 0) + _FLOOR * np.abs(points.value).mean()
    centre = cells.mean_direction(points.direction, bright * points.weight)
    width = np.sqrt(cells.solid_angle)
    radius = _RADIUS_OVER_WIDTH * options.smoothing * width
    radius = np.clip(radius, LEAST_RADIUS, MOST_RADIUS)

    # What is everywhere is one lobe as wide as the hemisphere
    even = max(float(np.quantile(points.value, _EVEN)), 0.0)
    rest = np.maximum(cells.sum((points.value - even) * points.weight), 0)
    return (
        np.concatenate([centre, [[0.0, 0.0, 1.0]]]),
        np.append(radius, MOST_RADIUS),
        np.append(rest, even * np.pi),
    )


def _solve(
    basis: Float[np.ndarray, "points lobes"],
    points: Points,
    prior: Float[np.ndarray, " lobes"],
) -> Float[np.ndarray, " lobes"]:
    # Least squares with each value weighted by its variance, were it a count
    floor = _FLOOR * points.flux / np.pi
    weight = points.weight / (np.maximum(basis @ prior, 0) + floor)
    gram = basis.T @ (basis * weight[:, None])
    target = basis.T @ (points.value * weight)

    # Hold each flux to its prior by a small share of its own weight
    hold = _PRIOR * np.diag(gram)
    gram[np.diag_indices_from(gram)] += hold
    target += hold * prior
    return non_negative(gram, target)
