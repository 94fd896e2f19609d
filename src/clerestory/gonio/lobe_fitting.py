"""Fit of Gaussian lobes to the BSDF values of one scan.

One lobe is placed in each cell of an adaptive quadtree. Lobe fluxes are a non-negative
least-squares solution; the variance of a BSDF value is assumed proportional to the
value, as for photon counts. Lobe fluxes are regularized towards the measured flux in
the cell of the lobe. Finally all fluxes are scaled to the measured total flux.

Least squares are solved by block principal pivoting. All unknowns that violate the
optimality conditions are exchanged together between the free and the zero set. If the
number of violations does not decrease, unknowns are exchanged one at a time, which
guarantees termination. As most lobe fluxes are positive, a few linear solves suffice;
an active-set method that starts from zero would need one solve per lobe.

Reference: L. F. Portugal, J. J. Júdice, L. N. Vicente, "A comparison of block pivoting
and interior-point algorithms for linear least squares problems with nonnegative
variables", Mathematics of Computation 63, 1994.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy import linalg

from clerestory.array_types import Directions, Values
from clerestory.checks import require, within
from clerestory.gonio.lobes import LEAST_RADIUS, MOST_RADIUS, NO_LIGHT, Lobes
from clerestory.gonio.parallel import IN_SERIES, Workers
from clerestory.gonio.quadtree import Quadtree
from clerestory.gonio.scattering_measurement import Scan, integration_weights

_MOST_BINS = 2000  # largest number of averaged measurement points in a fit

# Lower limit of the projected solid angle of a point, relative to the mean.
_LEAST_WEIGHT = 1e-6

# Quadtree level of the largest cells, for averaging points and for placing lobes.
_COARSEST_BIN, _COARSEST_LOBE = 5, 2

# Ratio of lobe radius to cell width at smoothing 1: a grid of equal lobes then sums to
# an almost constant BSDF.
_RADIUS_OVER_WIDTH = 0.6

# Fraction of misplaced flux above which the number of lobes is doubled.
_MISPLACED = 0.05

_DARK = 1e-3  # largest flux of a dark scan, as a fraction of the brightest scan's flux
_PRIOR = 1e-2  # weight of the regularization, relative to the least-squares terms
_EVEN = 0.05  # quantile of the BSDF values that is taken as the uniform background

# Lower limit of the BSDF in statistical weights, as a fraction of the mean BSDF.
_FLOOR = 1e-2

# Unknown lobe fluxes, and the matrix of the normal equations
_Unknowns = Float[np.ndarray, " unknowns"]
_Gram = Float[np.ndarray, "unknowns unknowns"]


@dataclass(frozen=True)
class FitOptions:
    """Parameters of the lobe fits."""

    # Largest number of lobes per scan; doubled if more than 5 % of the flux is
    # misplaced, as for beams with steep edges
    lobes: int = 200
    # Relative width of lobes; values below 1 give sharper fits that are more sensitive
    # to noise
    smoothing: float = 1.0

    def __post_init__(self) -> None:
        require(self.lobes >= 4, f"number of lobes is {self.lobes}; 4 or more expected")
        within(self.smoothing, "smoothing", least=0.2, most=5)


DEFAULT = FitOptions()


@dataclass(frozen=True, eq=False)
class Points:
    """BSDF values at directions, with projected solid angles for integration."""

    direction: Float[np.ndarray, "points 3"]  # unit vectors
    value: Float[np.ndarray, " points"]  # BSDF [1/sr]
    weight: Float[np.ndarray, " points"]  # projected solid angles [sr], π in total

    @property
    def flux(self) -> float:
        """Directional-hemispherical transmittance or reflectance."""
        return float(self.value @ self.weight)


def condensed_points(scan: Scan, *, most: int = _MOST_BINS) -> Points:
    """Average neighbouring measurement points so that at most `most` points remain.

    BSDF values are weighted by projected solid angle, so that flux is conserved.
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


def fit_scans(
    scans: Sequence[Scan],
    *,
    options: FitOptions = DEFAULT,
    workers: Workers = IN_SERIES,
) -> list[Lobes]:
    """Fit lobes to every scan.

    Scans with less than 1/1000 of the flux of the brightest scan are treated as dark.
    """
    least = _DARK * max(scan.flux for scan in scans)
    return workers.map("fit lobes", fit_lobes, [(s, options, least) for s in scans])


def fit_lobes(scan: Scan, options: FitOptions = DEFAULT, least: float = 0.0) -> Lobes:
    """Fit lobes to a scan; the total flux is conserved.

    A scan whose flux is below `least` is treated as dark.
    """
    if abs(scan.flux) < least:
        up = np.array([[0.0, 0.0, 1.0]])
        return Lobes(up, np.full(1, MOST_RADIUS), np.full(1, NO_LIGHT))
    points = condensed_points(scan)
    require(
        points.flux > 0,
        f"total flux of the scan from {scan.words} is {points.flux:.3g}; a positive"
        " flux expected; is the blank reading too large?",
        file=scan.source,
    )
    lobes = _fitted(points, options, options.lobes)
    if misplaced_flux(points, lobes.evaluate(points.direction)) > _MISPLACED:
        lobes = _fitted(points, options, 2 * options.lobes)
    return lobes


def misplaced_flux(points: Points, predicted: Values) -> float:
    """Misplaced flux as a fraction of the measured flux; 1 if the measured flux is 0.

    `predicted`: predicted BSDF at the points [1/sr].
    """
    if points.flux <= 0:
        return 1.0
    moved = points.weight @ np.abs(predicted - points.value) / 2
    return float(moved / points.flux)


def _fitted(points: Points, options: FitOptions, most: int) -> Lobes:
    # Fit lobes and scale the lobe fluxes to the total flux of the points
    centre, radius, prior = _placed(points, options, most)
    basis = Lobes(centre, radius, prior).basis(points.direction)
    flux = _solve(basis, points, prior)
    keep = flux > 1e-9 * flux.sum()
    return Lobes(centre[keep], radius[keep], flux[keep] * (points.flux / flux.sum()))


def _placed(
    points: Points, options: FitOptions, most: int
) -> tuple[Directions, Values, Values]:
    # Place lobes at flux centroids of cells; cells give the lobe radius and prior flux
    cells = Quadtree(points.direction, points.value).cut(
        most - 1, coarsest=_COARSEST_LOBE
    )
    bright = np.maximum(points.value, 0) + _FLOOR * np.abs(points.value).mean()
    centre = cells.mean_direction(points.direction, bright * points.weight)
    width = np.sqrt(cells.solid_angle)
    radius = _RADIUS_OVER_WIDTH * options.smoothing * width
    radius = np.clip(radius, LEAST_RADIUS, MOST_RADIUS)

    # The uniform background is one lobe as wide as the hemisphere
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
    # Least squares with weights inverse to the variance of photon counts
    floor = _FLOOR * points.flux / np.pi
    weight = points.weight / (np.maximum(basis @ prior, 0) + floor)
    gram = basis.T @ (basis * weight[:, None])
    target = basis.T @ (points.value * weight)

    # Regularize the flux of each lobe towards the measured flux in the lobe's cell
    hold = _PRIOR * np.diag(gram)
    gram[np.diag_indices_from(gram)] += hold
    target += hold * prior
    return non_negative(gram, target)


# Number of block exchanges without progress before unknowns are exchanged singly.
_PATIENCE = 3

# Tolerance for negative values, relative to the largest absolute value of `target`.
_NEGATIVE = 1e-12


def non_negative(gram: _Gram, target: _Unknowns) -> _Unknowns:
    """Return x ≥ 0 that minimizes xᵀ·gram·x/2 − targetᵀ·x.

    `gram`: symmetric positive definite matrix; `target`: vector.
    """
    # Scale the unknowns so that the diagonal of the matrix is 1
    scale = 1 / np.sqrt(np.diag(gram))
    gram, target = gram * np.outer(scale, scale), target * scale
    least = _NEGATIVE * float(np.abs(target).max(initial=0))
    free = np.ones(len(target), dtype=bool)
    fewest, patience = len(target) + 1, _PATIENCE
    while True:
        found, pull = _free_solution(gram, target, free)
        wrong = np.where(free, found < -least, pull > least)
        count = int(wrong.sum())
        if not count:
            return np.asarray(np.maximum(found, 0) * scale)
        if count < fewest:
            fewest, patience = count, _PATIENCE
        elif patience:
            patience -= 1
        else:
            wrong[: np.flatnonzero(wrong)[-1]] = False
        free ^= wrong


def _free_solution(
    gram: _Gram, target: _Unknowns, free: Bool[np.ndarray, " unknowns"]
) -> tuple[_Unknowns, _Unknowns]:
    # Solution for the free unknowns, and negative gradient with respect to all unknowns
    found = np.zeros(len(target))
    if np.any(free):
        factor = linalg.cho_factor(gram[np.ix_(free, free)], check_finite=False)
        found[free] = linalg.cho_solve(factor, target[free], check_finite=False)
    return found, target - gram[:, free] @ found[free]
