"""Interpolation of hemispherical transmittance or reflectance over incidence.

Displacement interpolation of lobes is linear in flux. At 10° steps, a linear
interpolation is up to 5 % below Fresnel's equations and does not resolve cut-offs
between measured directions.

For isotropic layers the flux is a monotone cubic function of 1 − cos θ, the variable of
Schlick's approximation. For anisotropic layers a Gaussian process is used. With
horizontal slats or prisms the flux depends mainly on the profile angle; with this angle
as a coordinate the process resolves cut-offs between measured directions. Coordinates
and length scales maximize the marginal likelihood of the measured values.

References: C. Schlick, "An inexpensive BRDF model for physically-based rendering",
Computer Graphics Forum 13 (3), 1994; F. N. Fritsch, R. E. Carlson, "Monotone piecewise
cubic interpolation", SIAM Journal on Numerical Analysis 17 (2), 1980; C. E. Rasmussen,
C. K. I. Williams, "Gaussian Processes for Machine Learning", MIT Press 2006, equations
2.30 and 4.17.
"""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from jaxtyping import Float
from scipy import linalg
from scipy.interpolate import PchipInterpolator

from clerestory.array_types import Directions, Values, Vector, Vector2
from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.lobes import NO_LIGHT
from clerestory.gonio.symmetry import Symmetry, fold, images

# Coordinates besides the polar angle: "profile", "sideways": profile angle across
# horizontal or vertical slats, and direction cosine along them; "disc": x and y.
Coordinates = Literal["profile", "sideways", "disc"]
_COORDINATES: tuple[Coordinates, ...] = ("profile", "sideways", "disc")

# Candidate length scales of the kernel [rad or 1], and index of the initial scale.
_REACHES = (0.12, 0.25, 0.5, 1.0, 2.0, 8.0)
_FIRST = 3

# Candidate ratios of noise variance to process variance.
_NOISES = (1e-6, 1e-4, 1e-3)

# Smallest z from which a profile angle is calculated.
_LEAST_HEIGHT = 0.02

# Largest number of sweeps over the length scales and the noise ratio.
_SWEEPS = 4

# Directions with a smaller 1 − cos θ count as normal incidence.
_AT_NORMAL = 1e-9

# Directions count as equal if they agree to this number of decimal places.
_DIGITS = 7


class Flux(Protocol):
    """Hemispherical transmittance or reflectance by incident direction."""

    def at(self, direction: Directions) -> Values:
        """Transmittance or reflectance at each direction; NaN outside the domain."""


@dataclass(frozen=True, eq=False)
class FluxCurve:
    """Hemispherical transmittance or reflectance of an isotropic layer.

    Examples
    --------
    >>> from clerestory.gonio.incident_mesh import arc_mesh
    >>> curve = flux_surface(arc_mesh(np.array([0.0, 0.5, 1.0])), np.full(3, 0.25),
    ...                      symmetry="isotropic", quadrant=np.ones(2))
    >>> float(curve.at(np.array([[0.6, 0, 0.8]]))[0])
    0.25
    """

    curve: PchipInterpolator  # transmittance or reflectance as a function of 1 − cos θ

    def at(self, direction: Directions) -> Values:
        """Transmittance or reflectance; NaN beyond the largest measured polar angle."""
        return np.asarray(self.curve(_fall(direction)))


@dataclass(frozen=True, eq=False)
class FluxProcess:
    """Hemispherical transmittance or reflectance as a Gaussian process."""

    known: Float[np.ndarray, "known 3"]  # measured incident directions
    # Factors of x, y and z that give the mirror images of a direction
    images: Float[np.ndarray, "images 3"]
    coordinates: Coordinates  # coordinates in which the kernel measures distance
    reach: Float[np.ndarray, "3"]  # length scale of each coordinate [rad or 1]
    # Weights of the kernels at the measured directions
    weight: Float[np.ndarray, " known"]
    mean: float  # mean of the process
    most: float  # upper limit of transmittance or reflectance

    def at(self, direction: Directions) -> Values:
        """Transmittance or reflectance at each direction."""
        kernel = _kernel(
            direction, self.known, self.images, self.coordinates, self.reach
        )
        return np.asarray(
            np.clip(self.mean + kernel @ self.weight, NO_LIGHT, self.most)
        )


def flux_surface(
    mesh: Mesh, totals: Values, *, symmetry: Symmetry, quadrant: Vector2
) -> Flux:
    """Interpolate transmittance or reflectance given at the vertices of a mesh.

    `quadrant`: signs of x and y in the measured part of the hemisphere.
    """
    if mesh.arc:
        return _curve(mesh.vertices, totals)
    folded, _ = fold(mesh.vertices, symmetry, quadrant)
    _, first = np.unique(np.round(folded, _DIGITS), axis=0, return_index=True)
    return _process(folded[first], totals[first], images(symmetry))


def _process(
    known: Float[np.ndarray, "known 3"],
    totals: Float[np.ndarray, " known"],
    factors: Float[np.ndarray, "images 3"],
) -> FluxProcess:
    # Select the coordinates with the largest marginal likelihood
    most = max(1.0, float(totals.max()))
    spread = float(np.ptp(totals))
    if spread < 1e-9:
        reach, none = np.ones(3), np.zeros(len(known))
        return FluxProcess(known, factors, "disc", reach, none, float(totals[0]), most)
    found = [_likeliest(known, totals, factors, name) for name in _COORDINATES]
    number = int(np.argmin([unlikely for unlikely, _, _ in found]))
    _, reach, noise = found[number]
    name = _COORDINATES[number]
    kernel = _kernel(known, known, factors, name, reach)
    weight, mean = _weights(kernel, totals, noise)
    return FluxProcess(known, factors, name, reach, weight, mean, most)


def _likeliest(
    known: Float[np.ndarray, "known 3"],
    totals: Float[np.ndarray, " known"],
    factors: Float[np.ndarray, "images 3"],
    name: Coordinates,
) -> tuple[float, Vector, float]:
    """Smallest negative log likelihood, with its length scales and noise ratio."""
    seen: dict[tuple[int, ...], float] = {}

    def unlikely(choice: tuple[int, ...]) -> float:
        if choice not in seen:
            reach = np.array([_REACHES[k] for k in choice[:3]])
            kernel = _kernel(known, known, factors, name, reach)
            seen[choice] = _unlikeliness(kernel, totals, _NOISES[choice[3]])
        return seen[choice]

    best: tuple[int, ...] = (_FIRST, _FIRST, _FIRST, 1)
    for _ in range(_SWEEPS):
        before = best
        for place in range(4):
            count = len(_REACHES) if place < 3 else len(_NOISES)
            choices = [(*best[:place], k, *best[place + 1 :]) for k in range(count)]
            best = min(choices, key=unlikely)
        if best == before:
            break
    return seen[best], np.array([_REACHES[k] for k in best[:3]]), _NOISES[best[3]]


def _unlikeliness(
    kernel: Float[np.ndarray, "known known"],
    totals: Float[np.ndarray, " known"],
    noise: float,
) -> float:
    # Negative log marginal likelihood for the most likely variance of the process
    count = len(totals)
    kernel = kernel * (count / np.trace(kernel))
    factor, inverse = _inverse(kernel, noise)
    rest = totals - (inverse @ totals).sum() / inverse.sum()
    scale = max(float(rest @ inverse @ rest) / count, 1e-300)
    return float(0.5 * count * np.log(scale) + np.log(np.diag(factor)).sum())


def _weights(
    kernel: Float[np.ndarray, "known known"],
    totals: Float[np.ndarray, " known"],
    noise: float,
) -> tuple[Float[np.ndarray, " known"], float]:
    _, inverse = _inverse(kernel, noise * float(np.trace(kernel)) / len(totals))
    mean = float((inverse @ totals).sum() / inverse.sum())
    return np.asarray(inverse @ (totals - mean)), mean


def _inverse(
    kernel: Float[np.ndarray, "known known"], noise: float
) -> tuple[Float[np.ndarray, "known known"], Float[np.ndarray, "known known"]]:
    identity = np.eye(len(kernel))
    factor = linalg.cholesky(kernel + noise * identity, lower=True)
    return factor, linalg.cho_solve((factor, True), identity)


def _kernel(
    one: Float[np.ndarray, "one 3"],
    other: Float[np.ndarray, "other 3"],
    factors: Float[np.ndarray, "images 3"],
    name: Coordinates,
    reach: Vector,
) -> Float[np.ndarray, "one other"]:
    # Matérn kernel of order 3/2, summed over the mirror images
    total = np.zeros((len(one), len(other)))
    place = _coordinates(one, name) / reach
    for factor in factors:
        image = _coordinates(other * factor, name) / reach
        apart = np.sqrt(3) * np.linalg.norm(place[:, None] - image, axis=-1)
        total += (1 + apart) * np.exp(-apart)
    return total


def _coordinates(direction: Directions, name: Coordinates) -> Directions:
    x, y, z = direction.T
    height = np.maximum(z, _LEAST_HEIGHT)
    theta = np.arccos(np.clip(z, -1, 1))
    if name == "profile":
        return np.stack([np.arctan2(y, height), x, theta], axis=-1)
    if name == "sideways":
        return np.stack([np.arctan2(x, height), y, theta], axis=-1)
    return np.stack([x, y, theta], axis=-1)


def _curve(vertices: Directions, totals: Values) -> FluxCurve:
    # Use only directions with x ≥ 0: a direction with x < 0 is a mirror image
    own = vertices[:, 0] >= 0
    fall, total = _fall(vertices[own]), totals[own]
    if fall[0] > _AT_NORMAL:
        fall, total = np.append(0.0, fall), np.append(total[0], total)
    return FluxCurve(PchipInterpolator(fall, total, extrapolate=False))


def _fall(direction: Directions) -> Values:
    # 1 − cos θ, exact near the normal
    square = direction[:, 0] ** 2 + direction[:, 1] ** 2
    return np.asarray(square / (1 + direction[:, 2]))
