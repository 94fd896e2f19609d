"""Interpolation of transmittance or reflectance between incident directions.

Displacement interpolation of lobes is linear in flux. At steps of 10°, linear
interpolation is up to 5 % below Fresnel's equations and does not resolve cut-offs
between measured directions.

For isotropic layers the flux is a monotone cubic function of 1 − cos θ, the variable of
Schlick's approximation. For anisotropic layers a Gaussian process is used. With
horizontal slats or prisms the flux depends mainly on the profile angle; with the
profile angle as a coordinate the process resolves cut-offs between measured directions.
Coordinates and length scales are chosen for the largest marginal likelihood of the
measured flux.

References: C. Schlick, "An inexpensive BRDF model for physically-based rendering",
Computer Graphics Forum 13 (3), 1994; F. N. Fritsch, R. E. Carlson, "Monotone piecewise
cubic interpolation", SIAM Journal on Numerical Analysis 17 (2), 1980; C. E. Rasmussen,
C. K. I. Williams, "Gaussian Processes for Machine Learning", MIT Press 2006, equations
2.30 and 4.17.
"""

from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from jaxtyping import Float
from scipy import linalg
from scipy.interpolate import PchipInterpolator

from clerestory.array_types import Directions, Values, Vector, Vector2
from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.lobes import NO_LIGHT
from clerestory.gonio.symmetry import Symmetry, fold, images

# Coordinates besides the polar angle: for "profile" (horizontal slats) and "sideways"
# (vertical slats), the profile angle and x or y along the slats; for "disc", x and y.
Coordinates = Literal["profile", "sideways", "disc"]
_COORDINATES: tuple[Coordinates, ...] = ("profile", "sideways", "disc")

# Candidate kernel length scales [rad; unitless for x and y], and index of the
# initial scale.
_REACHES = (0.12, 0.25, 0.5, 1.0, 2.0, 8.0)
_FIRST = 3

_NOISES = (1e-6, 1e-4, 1e-3)  # candidate ratios of noise variance to process variance
_LEAST_HEIGHT = 0.02  # smallest z from which a profile angle is calculated

# Largest number of search sweeps over the length scales and the noise ratio.
_SWEEPS = 4

_AT_NORMAL = 1e-9  # directions with a smaller 1 − cos θ count as normal incidence

# Number of decimal places to which equal directions agree.
_DIGITS = 7

# Values at known directions, and kernel values of pairs of known directions
_Totals = Float[np.ndarray, " known"]
_Table = Float[np.ndarray, "known known"]


class Flux(Protocol):
    """Hemispherical transmittance or reflectance by incident direction."""

    def at(self, direction: Directions) -> Values:
        """Transmittance or reflectance at each direction; NaN where it is unknown."""


@dataclass(frozen=True, eq=False)
class FluxCurve:
    """Hemispherical transmittance or reflectance of an isotropic layer."""

    curve: PchipInterpolator  # transmittance or reflectance as function of 1 − cos θ

    def at(self, direction: Directions) -> Values:
        """Transmittance or reflectance; NaN beyond the largest measured polar angle."""
        return np.asarray(self.curve(_fall(direction)))


@dataclass(frozen=True, eq=False)
class _Kernel:
    # Matérn kernel of order 3/2 about known directions, summed over mirror images
    known: Float[np.ndarray, "known 3"]
    # Factors of x, y and z that give the mirror images of a direction
    images: Float[np.ndarray, "images 3"]
    coordinates: Coordinates
    reach: Vector  # kernel length scales [rad; unitless for x, y]

    def __call__(
        self, direction: Float[np.ndarray, "one 3"]
    ) -> Float[np.ndarray, "one known"]:
        total = np.zeros((len(direction), len(self.known)))
        place = _coordinates(direction, self.coordinates) / self.reach
        for factor in self.images:
            image = _coordinates(self.known * factor, self.coordinates) / self.reach
            apart = np.sqrt(3) * np.linalg.norm(place[:, None] - image, axis=-1)
            total += (1 + apart) * np.exp(-apart)
        return total


@dataclass(frozen=True, eq=False)
class FluxProcess:
    """Hemispherical transmittance or reflectance as a Gaussian process."""

    kernel: _Kernel
    weight: _Totals  # weight of the kernel about each known direction
    mean: float
    most: float  # upper limit of transmittance or reflectance

    def at(self, direction: Directions) -> Values:
        """Transmittance or reflectance at each direction."""
        value = self.mean + self.kernel(direction) @ self.weight
        return np.asarray(np.clip(value, NO_LIGHT, self.most))


def flux_surface(
    mesh: Mesh, totals: Values, *, symmetry: Symmetry, quadrant: Vector2
) -> Flux:
    """Interpolate transmittance or reflectance given at the vertices of a mesh.

    `quadrant`: signs of x and y in the measured part of the hemisphere.
    """
    if mesh.arc:
        # Use only directions with x ≥ 0: a direction with x < 0 is a mirror image
        own = mesh.vertices[:, 0] >= 0
        fall, total = _fall(mesh.vertices[own]), totals[own]
        if fall[0] > _AT_NORMAL:
            fall, total = np.append(0.0, fall), np.append(total[0], total)
        return FluxCurve(PchipInterpolator(fall, total, extrapolate=False))
    folded, _ = fold(mesh.vertices, symmetry, quadrant)
    _, first = np.unique(np.round(folded, _DIGITS), axis=0, return_index=True)
    known, totals, factors = folded[first], totals[first], images(symmetry)

    # Select the coordinates with the largest marginal likelihood
    most = max(1.0, float(totals.max()))
    if float(np.ptp(totals)) < 1e-9:
        kernel, weight = _Kernel(known, factors, "disc", np.ones(3)), 0 * totals
        return FluxProcess(kernel, weight, float(totals[0]), most)
    found = [
        _likeliest(_Kernel(known, factors, name, np.ones(3)), totals)
        for name in _COORDINATES
    ]
    _, kernel, noise = min(found, key=lambda entry: entry[0])
    table = kernel(known)
    _, inverse = _inverse(table, noise * float(np.trace(table)) / len(totals))
    mean = float((inverse @ totals).sum() / inverse.sum())
    return FluxProcess(kernel, np.asarray(inverse @ (totals - mean)), mean, most)


def _likeliest(kernel: _Kernel, totals: _Totals) -> tuple[float, _Kernel, float]:
    # Find the most likely length scales and noise ratio, varying one of them at a time;
    # return the negative log likelihood, the kernel and the noise ratio
    seen: dict[tuple[int, ...], float] = {}

    def scaled(choice: tuple[int, ...]) -> _Kernel:
        return replace(kernel, reach=np.array([_REACHES[k] for k in choice[:3]]))

    def unlikely(choice: tuple[int, ...]) -> float:
        if choice not in seen:
            table = scaled(choice)(kernel.known)
            seen[choice] = _unlikeliness(table, totals, _NOISES[choice[3]])
        return seen[choice]

    best: tuple[int, ...] = (_FIRST, _FIRST, _FIRST, 1)
    for _ in range(_SWEEPS):
        before = best
        for place, options in enumerate((_REACHES, _REACHES, _REACHES, _NOISES)):
            choices = [
                (*best[:place], k, *best[place + 1 :]) for k in range(len(options))
            ]
            best = min(choices, key=unlikely)
        if best == before:
            break
    return seen[best], scaled(best), _NOISES[best[3]]


def _unlikeliness(kernel: _Table, totals: _Totals, noise: float) -> float:
    # Negative log marginal likelihood for the most likely variance of the process
    count = len(totals)
    kernel = kernel * (count / np.trace(kernel))
    factor, inverse = _inverse(kernel, noise)
    rest = totals - (inverse @ totals).sum() / inverse.sum()
    scale = max(float(rest @ inverse @ rest) / count, 1e-300)
    return float(0.5 * count * np.log(scale) + np.log(np.diag(factor)).sum())


def _inverse(kernel: _Table, noise: float) -> tuple[_Table, _Table]:
    identity = np.eye(len(kernel))
    factor = linalg.cholesky(kernel + noise * identity, lower=True)
    return factor, linalg.cho_solve((factor, True), identity)


def _coordinates(direction: Directions, name: Coordinates) -> Directions:
    x, y, z = direction.T
    height = np.maximum(z, _LEAST_HEIGHT)
    theta = np.arccos(np.clip(z, -1, 1))
    if name == "profile":
        return np.stack([np.arctan2(y, height), x, theta], axis=-1)
    if name == "sideways":
        return np.stack([np.arctan2(x, height), y, theta], axis=-1)
    return np.stack([x, y, theta], axis=-1)


def _fall(direction: Directions) -> Values:
    # 1 − cos θ, computed without cancellation near the normal
    square = direction[:, 0] ** 2 + direction[:, 1] ** 2
    return np.asarray(square / (1 + direction[:, 2]))
