"""Leave-one-out cross-validation of interpolated measurements.

Each scan is predicted from all other scans and compared with the measurement. Errors
are upper estimates: leaving out a scan doubles the distance between its neighbours.
Scans at the border of the measured region are extrapolated.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Indices
from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.distribution_metrics import beam_direction, earth_movers_distance
from clerestory.gonio.incident_mesh import locate
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_fitting import (
    DEFAULT,
    FitOptions,
    condensed_points,
    fit_scans,
    misplaced_flux,
    total_flux,
)
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.network_assembly import join
from clerestory.gonio.parallel import silent
from clerestory.gonio.scattering_measurement import Measurement, Scan
from clerestory.gonio.symmetry import Symmetry, fold
from clerestory.gonio.transport_network import Network
from clerestory.gonio.transport_refinement import refine_some_plans
from clerestory.progress import Progress

# Smallest number of scans for cross-validation.
_FEWEST = 3


@dataclass(frozen=True)
class LeftOut:
    """Prediction of one scan from all other scans.

    Attributes
    ----------
    theta_deg, phi_deg : incident direction [°]
    inside : whether the prediction is interpolated (True) or extrapolated (False)
    measured, predicted : directional-hemispherical transmittance or reflectance
    peak_deg : angle between the measured and the predicted beam direction [°]
    earth_mover_deg : earth mover's distance between the predicted and the fitted
        distribution [°]; NaN if the predicted flux is zero
    misplaced : fraction of the flux predicted in wrong directions, including noise
    fitted : `misplaced` for the lobes fitted to the scan itself: a lower limit
    """

    theta_deg: float
    phi_deg: float
    inside: bool
    measured: float
    predicted: float
    peak_deg: float
    earth_mover_deg: float
    misplaced: float
    fitted: float

    @property
    def flux_error(self) -> float:
        """Predicted minus measured hemispherical transmittance or reflectance."""
        return self.predicted - self.measured


@dataclass(frozen=True)
class CrossValidation:
    """Prediction errors of all scans.

    Attributes
    ----------
    scans : prediction errors of all scans
    smoothing : smoothing factor of the lobe fits
    """

    scans: tuple[LeftOut, ...]
    smoothing: float

    def median(self, name: str, *, inside: bool = True) -> float:
        """Median magnitude of a `LeftOut` attribute over inter- or extrapolated scans.

        >>> one = LeftOut(30, 0, True, 0.5, 0.49, 1.0, 2.0, 0.1, 0.02)
        >>> round(CrossValidation((one,), 1.0).median("flux_error"), 3)
        0.01
        """
        errors = [abs(getattr(s, name)) for s in self.scans if s.inside == inside]
        known = [error for error in errors if np.isfinite(error)]
        return float(np.median(known)) if known else float("nan")


def cross_validate(
    measurement: Measurement,
    *,
    symmetry: Symmetry | None = None,
    options: FitOptions = DEFAULT,
    processes: int = 1,
    progress: Callable[[str], Progress] = lambda _name: silent,
) -> CrossValidation:
    """Predict each scan from all other scans and return the errors.

    Parameters
    ----------
    symmetry, options, processes, progress : as in `fit_measurement`

    Raises
    ------
    InputError : fewer than three scans
    """
    scans = measurement.scans
    if len(scans) < _FEWEST:
        raise InputError(
            f"scans: {len(scans)}; {_FEWEST} or more expected to leave one out"
        )
    if symmetry is None:
        symmetry = measurement.symmetry
    fits = fit_scans(
        scans, options=options, processes=processes, report=progress("fit lobes")
    )
    network = join(
        measurement.incidents,
        fits,
        symmetry,
        processes=processes,
        report=progress("plan transport"),
    )
    report = progress("leave one out")
    left = []
    for k in range(len(scans)):
        left.append(_left_out(k, scans, fits, symmetry, network))
        report((k + 1) / len(scans), f"{k + 1} of {len(scans)}")
    return CrossValidation(tuple(left), options.smoothing)


def smoothing_study(
    measurement: Measurement,
    factors: Sequence[float],
    *,
    symmetry: Symmetry | None = None,
    lobes: int = DEFAULT.lobes,
    processes: int = 1,
    progress: Callable[[str], Progress] = lambda _name: silent,
) -> tuple[CrossValidation, ...]:
    """Cross-validate a measurement with several smoothing factors of the lobe fits."""
    return tuple(
        cross_validate(
            measurement,
            symmetry=symmetry,
            options=FitOptions(lobes=lobes, smoothing=factor),
            processes=processes,
            progress=progress,
        )
        for factor in factors
    )


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
    rest = refine_some_plans(rest, _about(rest, symmetry, scan))
    lobes = Interpolant(rest, symmetry).lobes(scan.incident)
    return LeftOut(
        scan.theta_deg,
        scan.phi_deg,
        _inside(rest, symmetry, scan),
        total_flux(scan),
        lobes.total,
        float(np.degrees(angle_between(beam_direction(lobes), beam_direction(fit)))),
        float(np.degrees(earth_movers_distance(lobes, fit))),
        misplaced_flux(points, lobes.evaluate(points.direction)),
        misplaced_flux(points, fit.evaluate(points.direction)),
    )


def _about(network: Network, symmetry: Symmetry, scan: Scan) -> Indices:
    # Mesh edges at the corners of the triangle (or edge) of the incident direction
    mesh = network.mesh
    place = locate(mesh, _folded(network, symmetry, scan))
    simplex = mesh.edges if place.on_edge[0] else mesh.triangles
    corners = simplex[place.simplex[0]]
    return np.flatnonzero(np.isin(mesh.edges, corners).any(axis=1))


def _inside(network: Network, symmetry: Symmetry, scan: Scan) -> bool:
    folded = _folded(network, symmetry, scan)
    if symmetry == "isotropic":
        theta = np.arctan2(network.mesh.vertices[:, 0], network.mesh.vertices[:, 2])
        return bool(np.radians(scan.theta_deg) <= theta.max() + 1e-9)
    return not bool(locate(network.mesh, folded).on_edge[0])


def _folded(
    network: Network, symmetry: Symmetry, scan: Scan
) -> Float[np.ndarray, "1 3"]:
    if symmetry == "isotropic":
        return from_degrees(scan.theta_deg, 0.0)[None]
    return fold(scan.incident[None], symmetry, network.quadrant)[0]
