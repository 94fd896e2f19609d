"""Leave-one-out cross-validation of interpolated measurements.

Each scan is predicted from all other scans and compared with the measurement. Errors
are upper estimates, because the distance between scans doubles where one is left out.
Scans at the border of the measured region are extrapolated.

The beam direction is the centroid of directions near the BSDF peak at which the BSDF is
at least half of the peak. A centroid is less sensitive to noise than the peak.
"""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import ot
from jaxtyping import Float

from clerestory.array_types import Values, Vector
from clerestory.brief_repr import brief
from clerestory.checks import one_of, require
from clerestory.gonio.angles import angle_between
from clerestory.gonio.incident_mesh import locate
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_fitting import (
    DEFAULT,
    FitOptions,
    condensed_points,
    fit_scans,
    misplaced_flux,
)
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.network_assembly import join, refine_plans
from clerestory.gonio.optimal_transport import Network
from clerestory.gonio.parallel import IN_SERIES, Workers
from clerestory.gonio.raster import Raster
from clerestory.gonio.scattering_measurement import Measurement, Scan
from clerestory.gonio.symmetry import SYMMETRIES, Symmetry, fold
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square
from clerestory.progress import Progress

# log2 of the number of grid cells along each axis, for the earth mover's distance and
# for the finer grid on which lobes are rasterized.
_HALVINGS, _DRAWN = 4, 6

_LEAST = 1e-6  # cells with less than this fraction of the total flux are ignored


def earth_movers_distance(one: Lobes, other: Lobes) -> float:
    """Earth mover's distance: mean angle of flux moved between distributions [rad].

    Both distributions are normalized and sampled on cells of equal projected solid
    angle, 7° wide at the normal. The result is NaN if either distribution has no flux.
    """
    if not (one.total > 0 and other.total > 0):
        return float("nan")
    give, take = _normalized_flux(one), _normalized_flux(other)
    some, others = give > _LEAST, take > _LEAST
    give, take = give[some] / give[some].sum(), take[others] / take[others].sum()
    cost = _angles()[np.ix_(some, others)]
    return float(ot.emd2(give, take, cost, numItermax=1_000_000))


def _normalized_flux(lobes: Lobes) -> Values:
    wide, part = 1 << _HALVINGS, 1 << _DRAWN - _HALVINGS
    cells = Raster.of(_DRAWN).cells(lobes).reshape(wide, part, wide, part)
    light = cells.sum(axis=(1, 3)).ravel()
    return np.asarray(light / light.sum())


@functools.cache
def _angles() -> Float[np.ndarray, "cells cells"]:
    direction = directions_from_square(*cell_centres(_HALVINGS))
    return angle_between(direction[:, None], direction)


# Largest angle [rad] between the peak direction and directions in the beam.
_REACH = np.radians(20.0)

# Beam centroid: log2 of the number of grid cells along each axis, and smallest number
# of bright cells; with fewer bright cells the peak direction is used.
_BEAM_HALVINGS, _FEWEST_CELLS = 6, 8


def beam_direction(lobes: Lobes, *, near: Vector | None = None) -> Vector:
    """Direction of the strongest beam, or of the beam near a given direction."""
    peak = lobes.strongest() if near is None else lobes.climb(near)
    grid = Raster.of(_BEAM_HALVINGS).directions[-1]
    grid = grid[angle_between(grid, peak) < _REACH]
    values = lobes.evaluate(grid)
    bright = values >= lobes.evaluate(peak[None])[0] / 2
    if bright.sum() < _FEWEST_CELLS:
        return peak
    middle = values[bright] @ grid[bright]
    return np.asarray(middle / np.linalg.norm(middle))


# Smallest number of scans for cross-validation.
_FEWEST = 3


@dataclass(frozen=True)
class LeftOut:
    """Prediction of one scan from all other scans."""

    theta_deg: float  # polar angle of the incident direction [°]
    phi_deg: float  # azimuth of the incident direction [°]
    # Whether the prediction is interpolated (True) or extrapolated (False)
    inside: bool
    measured: float  # measured hemispherical transmittance or reflectance
    predicted: float  # predicted hemispherical transmittance or reflectance
    peak_deg: float  # angle between the measured and the predicted beam direction [°]
    # Earth mover's distance between the predicted and the fitted distribution [°]; NaN
    # if the predicted flux is zero
    earth_mover_deg: float
    # Fraction of the scattered flux predicted in wrong directions; includes noise
    misplaced: float
    fitted: float  # `misplaced` of the lobe fit to this scan itself

    @property
    def flux_error(self) -> float:
        """Predicted minus measured hemispherical transmittance or reflectance."""
        return self.predicted - self.measured


@dataclass(frozen=True)
class CrossValidation:
    """Leave-one-out prediction errors of all goniophotometer scans."""

    scans: tuple[LeftOut, ...]  # prediction errors of all scans
    smoothing: float  # smoothing factor of the lobe fits

    __repr__ = brief

    def median(self, name: str, *, inside: bool = True) -> float:
        """Median absolute error of the scans; `name`: attribute of `LeftOut`."""
        errors = [abs(getattr(s, name)) for s in self.scans if s.inside == inside]
        known = [error for error in errors if np.isfinite(error)]
        return float(np.median(known)) if known else float("nan")


def cross_validate(
    measurement: Measurement,
    *,
    symmetry: Symmetry | None = None,
    options: FitOptions = DEFAULT,
    processes: int = 1,
    progress: Callable[[str], Progress] = IN_SERIES.progress,
) -> CrossValidation:
    """Predict each scan from all other scans and return the errors.

    Parameters
    ----------
    symmetry, options, processes, progress : as in `fit_measurement`
    """
    scans, workers = measurement.scans, Workers(processes, progress)
    message = f"number of scans is {len(scans)}; {_FEWEST} or more expected"
    require(len(scans) >= _FEWEST, f"{message} to leave one out")
    symmetry = symmetry or measurement.symmetry
    one_of(symmetry, "symmetry", choices=SYMMETRIES)
    fits = fit_scans(scans, options=options, workers=workers)
    network = join(measurement.incidents, fits, symmetry, workers=workers)
    work = [(k, scans, fits, symmetry, network) for k in range(len(scans))]
    left = Workers(progress=progress).map("leave one out", _left_out, work)
    return CrossValidation(tuple(left), options.smoothing)


def _left_out(
    k: int,
    scans: Sequence[Scan],
    fits: Sequence[Lobes],
    symmetry: Symmetry,
    network: Network,
) -> LeftOut:
    scan, fit, points = scans[k], fits[k], condensed_points(scans[k])
    others = [n for n in range(len(scans)) if n != k]
    incidents = np.array([scans[n].incident for n in others])
    known = network.known_plans()
    rest = join(incidents, [fits[n] for n in others], symmetry, known=known)
    mesh = rest.mesh
    place = locate(mesh, fold(scan.incident[None], symmetry, rest.quadrant)[0])
    on_edge = bool(place.on_edge[0])
    inside = not on_edge
    if mesh.arc:
        theta = np.arctan2(mesh.vertices[:, 0], mesh.vertices[:, 2])
        inside = bool(np.radians(scan.theta_deg) <= theta.max() + 1e-9)

    # Refine the transport plans of the edges near the incident direction
    corners = (mesh.edges if on_edge else mesh.triangles)[place.simplex[0]]
    about = np.flatnonzero(np.isin(mesh.edges, corners).any(axis=1))
    rest = refine_plans(rest, chosen=about)
    lobes = Interpolant(rest, symmetry).lobes(scan.incident)
    return LeftOut(
        scan.theta_deg,
        scan.phi_deg,
        inside,
        scan.flux,
        lobes.total,
        float(np.degrees(angle_between(beam_direction(lobes), beam_direction(fit)))),
        float(np.degrees(earth_movers_distance(lobes, fit))),
        misplaced_flux(points, lobes.evaluate(points.direction)),
        misplaced_flux(points, fit.evaluate(points.direction)),
    )
