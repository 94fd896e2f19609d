"""Scattered distributions as sums of Gaussian lobes (radial basis functions).

A lobe has a centre, a radius r and a flux. The BSDF of a lobe is proportional to
exp((cos α − 1) / r²) at the angle α from the centre, as in Ward, Kurt and Bonneel. The
BSDF is normalized above the horizon, so that total flux is conserved when lobes move.

Reference: G. Ward, M. Kurt, N. Bonneel, "Reducing anisotropic BSDF measurement to
common practice", Workshop on Material Appearance Modeling, 2014.
"""

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from jaxtyping import Float
from scipy import special
from scipy.interpolate import RectBivariateSpline

from clerestory.array_types import Directions, Values, Vector
from clerestory.checks import finite, not_negative, positive, same_length
from clerestory.gonio.angles import angle_table

# Largest number of direction–lobe pairs that are evaluated together.
_TOGETHER = 1 << 20

# Range of radii [rad]: 0.02° to 115°.
LEAST_RADIUS, MOST_RADIUS = 3e-4, 2.0

# Total flux of dark distributions; positive, so that normalization is possible.
NO_LIGHT = 1e-9

# Search for the largest BSDF: number of candidate lobes, and largest number of steps
# and tolerance of the mean-shift iteration.
_CANDIDATES, _MOST_STEPS, _STEP_ENDS = 64, 200, 1e-5

# Table of the curvature correction: numbers of elevations, of radii and of quadrature
# nodes, and smallest radius [rad].
_ELEVATIONS, _RADII, _QUADRATURE = 65, 33, 200
_FLAT_RADIUS = 0.02

_KEPT = 32  # number of cached tables of angles between lobes


_Arrays = TypeVar("_Arrays")


@dataclass(frozen=True, eq=False)
class Lobes:
    """A scattered distribution as a sum of Gaussian lobes."""

    centre: Float[np.ndarray, "lobes 3"]  # unit vectors, z ≥ 0
    radius: Float[np.ndarray, " lobes"]  # radius of each lobe [rad]
    # Scattered flux of each lobe, relative to the incident flux
    flux: Float[np.ndarray, " lobes"]

    def __post_init__(self) -> None:
        same_length(self.centre, self.flux, "centres", "fluxes of lobes")
        same_length(self.radius, self.flux, "radii", "fluxes of lobes")
        finite(self.centre, "coordinate of a lobe centre")
        positive(self.radius, "radius of a lobe", unit="rad")
        not_negative(self.flux, "flux of a lobe")

    def __len__(self) -> int:
        return len(self.flux)

    @property
    def total(self) -> float:
        """Directional-hemispherical transmittance or reflectance."""
        return float(self.flux.sum())

    @property
    def half_maximum(self) -> Values:
        """Angle from the lobe centre at which the BSDF is half of the peak [rad]."""
        return np.asarray(np.arccos(np.maximum(1 - self.radius**2 * np.log(2), -1)))

    @property
    def peak(self) -> Values:
        """BSDF of each lobe at its centre [1/sr]."""
        return np.asarray(self.flux / norm(self.centre[:, 2], self.radius))

    def evaluate(self, leaving: Directions) -> Values:
        """BSDF for exit directions [1/sr]."""
        peak, value = self.peak, np.zeros(len(leaving))
        step = max(1, _TOGETHER // max(len(self), 1))
        for start in range(0, len(leaving), step):
            part = slice(start, start + step)
            value[part] = self._shape(leaving[part]) @ peak
        return value

    def basis(
        self, leaving: Float[np.ndarray, "directions 3"]
    ) -> Float[np.ndarray, "directions lobes"]:
        """BSDF of each lobe, divided by the flux of the lobe [1/sr]."""
        return np.asarray(self._shape(leaving) / norm(self.centre[:, 2], self.radius))

    def transformed(self, turn: Float[np.ndarray, "3 3"]) -> "Lobes":
        """Lobes rotated or reflected by a matrix."""
        return replace(self, centre=self.centre @ turn.T)

    def strongest(self) -> Vector:
        """Direction of the largest BSDF."""
        best = np.argsort(self.peak)[-_CANDIDATES:]
        return self.climb(
            self.centre[best[np.argmax(self.evaluate(self.centre[best]))]]
        )

    def climb(self, direction: Vector) -> Vector:
        """Direction of the local BSDF maximum reached from a direction by mean shift.

        Reference: D. Comaniciu, P. Meer, "Mean shift", IEEE Transactions on Pattern
        Analysis and Machine Intelligence 24 (5), 2002.
        """
        pull = (self.peak / self.radius**2)[:, None] * self.centre
        for _ in range(_MOST_STEPS):
            ahead = self._shape(direction[None])[0] @ pull
            ahead /= max(float(np.linalg.norm(ahead)), 1e-300)
            step = float(np.linalg.norm(ahead - direction))
            direction = ahead
            if step < _STEP_ENDS:
                break
        return direction

    def _shape(
        self, leaving: Float[np.ndarray, "directions 3"]
    ) -> Float[np.ndarray, "directions lobes"]:
        return np.asarray(np.exp((leaving @ self.centre.T - 1) / self.radius**2))


def joined(parts: Sequence[_Arrays]) -> _Arrays:
    """Concatenate the array attributes of objects of one type, such as `Lobes`."""
    columns = zip(*(vars(part).values() for part in parts), strict=True)
    return type(parts[0])(*map(np.concatenate, columns))


@functools.lru_cache(maxsize=_KEPT)
def angles_among(lobes: Lobes) -> Float[np.ndarray, "lobes lobes"]:
    """Angles between the centres of lobes [rad]."""
    table = angle_table(lobes.centre, lobes.centre)
    table.setflags(write=False)
    return table


def norm(height: Values, radius: Values) -> Values:
    """Integral of exp((cos α − 1)/r²) · cos θ over the hemisphere [sr].

    `height`: z coordinate of the lobe centre.
    """
    elevation = np.arcsin(np.clip(height, 0, 1))
    radius = np.clip(radius, LEAST_RADIUS, MOST_RADIUS)
    log_radius = np.log(np.maximum(radius, _FLAT_RADIUS))
    return np.asarray(_flat(elevation, radius) * _curvature().ev(elevation, log_radius))


def _flat(elevation: Values, radius: Values) -> Values:
    # 2π r² · E[max(sin(e + r·x), 0)] for standard normal x, to first order in r
    reach = elevation / radius
    above = special.ndtr(reach)
    edge = np.exp(-(reach**2) / 2) / np.sqrt(2 * np.pi)
    mean = np.sin(elevation) * above + radius * np.cos(elevation) * edge
    return np.asarray(2 * np.pi * radius**2 * mean)


def _integral(elevation: Values, radius: Values) -> Values:
    # Integrate over θ numerically; the integral over azimuth is a Bessel function
    centre = np.pi / 2 - elevation[..., None]
    wide = 8 * radius[..., None]
    low, high = np.maximum(centre - wide, 0), np.minimum(centre + wide, np.pi / 2)
    node, weight = np.polynomial.legendre.leggauss(_QUADRATURE)
    theta = (low + high) / 2 + (high - low) / 2 * node
    sharp = 1 / radius[..., None] ** 2
    ring = np.exp(sharp * (np.cos(theta - centre) - 1)) * special.i0e(
        sharp * np.sin(theta) * np.sin(centre)
    )
    inner = ring * np.cos(theta) * np.sin(theta) * (high - low) / 2
    return np.asarray(2 * np.pi * (inner @ weight))


@functools.cache
def _curvature() -> RectBivariateSpline:
    elevation = np.linspace(0, np.pi / 2, _ELEVATIONS)
    log_radius = np.linspace(np.log(_FLAT_RADIUS), np.log(MOST_RADIUS), _RADII)
    e, r = np.meshgrid(elevation, np.exp(log_radius), indexing="ij")
    return RectBivariateSpline(elevation, log_radius, _integral(e, r) / _flat(e, r))
