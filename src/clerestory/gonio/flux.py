"""Total flux between measured directions: a smooth surface through those measured.

Displacement alone would leave it straight between the corners of a triangle, which
lies beneath Fresnel's curves by 5 % at 10° steps. A surface without kinks follows
them; it is kept between the values at the corners, so it makes no light of its own.

Reference: P. Alfeld, "A trivariate Clough–Tocher scheme for tetrahedral data",
Computer Aided Geometric Design 1 (2), 1984; F. N. Fritsch, R. E. Carlson, "Monotone
piecewise cubic interpolation", SIAM Journal on Numerical Analysis 17 (2), 1980.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CloughTocher2DInterpolator, PchipInterpolator

from clerestory.gonio.mesh import Mesh


@dataclass(frozen=True, eq=False)
class FluxSurface:
    """From incident direction to the share of light that is scattered in all.

    Examples
    --------
    >>> from clerestory.gonio.mesh import string
    >>> surface = flux_surface(string(np.array([0.0, 0.5, 1.0])), np.full(3, 0.25))
    >>> float(surface.at(np.array([[0.6, 0, 0.8]]))[0])
    0.25
    """

    curve: PchipInterpolator | CloughTocher2DInterpolator

    def at(
        self, direction: Float[np.ndarray, "directions 3"]
    ) -> Float[np.ndarray, " directions"]:
        """Share at each direction; not a number beyond the outermost ones."""
        if isinstance(self.curve, PchipInterpolator):
            return np.asarray(self.curve(_angle(direction)))
        return np.asarray(self.curve(_plane(direction)))


def flux_surface(mesh: Mesh, totals: Float[np.ndarray, " vertices"]) -> FluxSurface:
    """Return the surface through the shares at the vertices of a mesh."""
    if mesh.arc:
        angle = _angle(mesh.vertices)
        return FluxSurface(PchipInterpolator(angle, totals, extrapolate=False))
    return FluxSurface(CloughTocher2DInterpolator(_plane(mesh.vertices), totals))


def _angle(direction: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, " points"]:
    return np.asarray(np.arctan2(direction[:, 0], direction[:, 2]))


def _plane(direction: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
    # Distance from the middle is the angle to the normal
    flat = np.hypot(direction[:, 0], direction[:, 1])
    theta = np.arctan2(flat, direction[:, 2])
    scale = np.where(flat > 1e-12, theta / np.maximum(flat, 1e-12), 1.0)
    return np.asarray(direction[:, :2] * scale[:, None])
