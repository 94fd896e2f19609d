"""Recommendation of incident directions for additional scans.

Leave-one-out cross-validation shows where interpolation is inaccurate. The priority of
a direction is the misplaced flux at the nearest scan times the angle to that scan. New
directions are therefore dense where the BSDF changes quickly with incidence.
"""

import numpy as np

from clerestory.array_types import Directions
from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.cross_validation import CrossValidation
from clerestory.gonio.symmetry import Symmetry, fold, images, measured_quadrant

# Number of candidate directions over the hemisphere, about 2° apart.
_CANDIDATES = 4000


def recommended_directions(
    validation: CrossValidation, *, symmetry: Symmetry, count: int
) -> Directions:
    """Incident directions for new scans, in order of decreasing priority.

    Directions lie in the measured part of the hemisphere and do not exceed the largest
    measured polar angle.
    """
    scans = validation.scans
    angles = [(scan.theta_deg, scan.phi_deg) for scan in scans]
    theta, phi = np.array(angles, dtype=float).T
    known = from_degrees(theta, phi)
    share = np.array([min(scan.misplaced, 1.0) for scan in scans])
    if symmetry == "isotropic":
        azimuth = float(phi[np.argmax(theta)])
        known = from_degrees(theta, azimuth)
        candidates = from_degrees(np.linspace(0, theta.max(), 200), azimuth)
        factors = np.ones((1, 3))
    else:
        # Fibonacci spiral over the measured part of the hemisphere
        number = np.arange(_CANDIDATES) + 0.5
        turn, height = np.pi * (1 + 5**0.5) * number, 1 - number / _CANDIDATES
        flat = np.sqrt(1 - height**2)
        every = np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=-1)
        candidates, _ = fold(every, symmetry, measured_quadrant(known))
        candidates = candidates[height >= np.cos(np.radians(theta.max()))]
        factors = images(symmetry)
    away = angle_between(candidates[:, None], (known[:, None] * factors).reshape(-1, 3))
    near = away.min(axis=1)
    expected = np.repeat(share, len(factors))[away.argmin(axis=1)]
    chosen: list[int] = []
    for _ in range(count):
        chosen.append(int(np.argmax(expected * near)))
        own = candidates[chosen[-1]] * factors
        near = np.minimum(near, angle_between(candidates[:, None], own).min(axis=1))
    return np.asarray(candidates[chosen])
