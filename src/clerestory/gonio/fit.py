"""Lobes for one scan: an adaptive grid, a lobe a cell, fluxes that explain the values.

Centres and radii follow the cells of a quadtree; fluxes are those that are nowhere
negative and come nearest to the measured values, each weighted like a count of
photons. Where there are no data, as in the shadow of the detector, fluxes keep to what
the mean of their cell says. At the end all fluxes are scaled to the measured total.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import linalg
from scipy.optimize import nnls

from clerestory.errors import InputError
from clerestory.gonio.integration import integration_weights
from clerestory.gonio.lobes import LEAST_RADIUS, MOST_RADIUS, Lobes
from clerestory.gonio.measurement import Scan
from clerestory.gonio.quadtree import Quadtree

# Means of neighbouring points that stand for the points themselves: where lobes are
# fitted, and where their flux is summed.
_MOST_BINS, _MOST_SUMMED = 2000, 10_000

# Halvings of the coarsest cells: of bins, a lobe's own cell and those about it.
_COARSEST_BIN, _COARSEST_LOBE = 5, 2

# Radius of a lobe over the width of its cell, if smoothing is 1. Lobes at this
# distance sum to an even plain.
_RADIUS_OVER_WIDTH = 0.6

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
    lobes : most lobes a scan
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
    """Return a scan as at most `most` points, each the mean of its neighbours."""
    tree = Quadtree(scan.leaving, scan.values)
    cells = tree.cut(most, coarsest=_COARSEST_BIN)
    direction = cells.mean_direction(scan.leaving, np.ones(len(scan.values)))
    value = cells.sum(scan.values) / cells.count()
    return Points(direction, value, integration_weights(direction))


def total_flux(scan: Scan) -> float:
    """Share of the incident light that a scan finds scattered in all."""
    return condense(scan, most=_MOST_SUMMED).flux


def fit_lobes(scan: Scan, options: FitOptions = DEFAULT) -> Lobes:
    """Return the lobes of a scan; their flux is that of the scan.

    Raises
    ------
    InputError : the scan scatters no light in all
    """
    points = condense(scan)
    total = total_flux(scan) if len(scan.values) > _MOST_BINS else points.flux
    if total <= 0:
        raise InputError(
            f"{total:.3g} of the light from {scan.words} is scattered; more than"
            " zero expected: is the blank reading too large?",
            file=scan.source,
        )
    centre, radius, prior = _placed(points, options)
    basis = Lobes(centre, radius, prior).basis(points.direction)
    flux = _solve(basis, points, prior)
    keep = flux > 1e-9 * flux.sum()
    scale = total / flux.sum()
    return Lobes(centre[keep], radius[keep], flux[keep] * scale)


def _placed(
    points: Points, options: FitOptions
) -> tuple[
    Float[np.ndarray, "lobes 3"],
    Float[np.ndarray, " lobes"],
    Float[np.ndarray, " lobes"],
]:
    # A lobe a cell: at the centroid of its light, as wide as the cell, with its flux
    cells = Quadtree(points.direction, points.value).cut(
        options.lobes - 1, coarsest=_COARSEST_LOBE
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
    factor = linalg.cholesky(gram, lower=False)
    right = linalg.solve_triangular(factor, target, trans="T")
    flux, _ = nnls(factor, right, maxiter=30 * len(prior))
    return np.asarray(flux)
