"""Total flux between measured directions: a smooth curve, or a Gaussian process.

Displacement alone would leave the flux straight between the corners of a triangle.
That lies beneath Fresnel's curves by 5 % at 10° steps, and knows nothing of the edge
of a cut-off that runs between directions.

Along an arc a curve without overshoot follows the measured values over 1 − cos θ, the
variable of Schlick's approximation of Fresnel's formulas: flux is even about the normal
and bends towards grazing incidence. Around the normal
a Gaussian process does, in coordinates that suit windows: for bars along the width the
flux depends on the profile angle across them and hardly on anything else, and then
every measured direction says something about every other of its profile angle, so that
a cut-off is found much finer than the steps between neighbours. Which coordinates
suit, and how far values reach along each, is what makes the measured values most
likely; the images that symmetry implies count as well.

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

# Beside the profile angle across bars along the width, or along the height, stands
# what those leave unchanged: the cosine to the bars.
Coordinates = Literal["profile", "sideways", "disc"]
_COORDINATES: tuple[Coordinates, ...] = ("profile", "sideways", "disc")

# How far values reach along a coordinate: choices, and the first tried [rad or 1].
_REACHES = (0.12, 0.25, 0.5, 1.0, 2.0, 8.0)
_FIRST = 3

# Variance of the noise of measured fluxes as a share of that of the process.
_NOISES = (1e-6, 1e-4, 1e-3)

# Profile angles near the horizon are limited by this least height.
_LEAST_HEIGHT = 0.02

# Sweeps over the choices; two or three suffice.
_SWEEPS = 4

# 1 − cos θ of what counts as the normal.
_AT_NORMAL = 1e-9

# Directions of the same place, as digits of the unit vector.
_DIGITS = 7


class Flux(Protocol):
    """From incident direction to the share of light that is scattered in all."""

    def at(self, direction: Directions) -> Values:
        """Share at each direction; not a number where nothing is said."""


@dataclass(frozen=True, eq=False)
class FluxCurve:
    """Flux along the arc of an isotropic layer.

    Attributes
    ----------
    curve : over 1 − cos θ

    Examples
    --------
    >>> from clerestory.gonio.incident_mesh import string
    >>> curve = flux_surface(string(np.array([0.0, 0.5, 1.0])), np.full(3, 0.25),
    ...                      symmetry="isotropic", quadrant=np.ones(2))
    >>> float(curve.at(np.array([[0.6, 0, 0.8]]))[0])
    0.25
    """

    curve: PchipInterpolator

    def at(self, direction: Directions) -> Values:
        """Share at each direction; not a number beyond the outermost ones."""
        return np.asarray(self.curve(_fall(direction)))


@dataclass(frozen=True, eq=False)
class FluxProcess:
    """Flux around the normal as a Gaussian process.

    Attributes
    ----------
    known : measured directions
    images : factors of x, y, z that symmetry implies
    coordinates : in which values reach
    reach : how far along each [rad or 1]
    weight : of the kernels about the known directions
    mean, most : of the process, and the largest share that is believed
    """

    known: Float[np.ndarray, "known 3"]
    images: Float[np.ndarray, "images 3"]
    coordinates: Coordinates
    reach: Float[np.ndarray, "3"]
    weight: Float[np.ndarray, " known"]
    mean: float
    most: float

    def at(self, direction: Directions) -> Values:
        """Share at each direction."""
        kernel = _kernel(
            direction, self.known, self.images, self.coordinates, self.reach
        )
        return np.asarray(
            np.clip(self.mean + kernel @ self.weight, NO_LIGHT, self.most)
        )


def flux_surface(
    mesh: Mesh, totals: Values, *, symmetry: Symmetry, quadrant: Vector2
) -> Flux:
    """Return what follows the shares at the vertices of a mesh.

    Parameters
    ----------
    quadrant : signs of x and y of the measured part
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
    # The likeliest of all coordinates, each from its own search
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
    """Search one coordinate's reach after the other, then the noise.

    Returns
    -------
    negative logarithm of the likelihood, reaches, noise
    """
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
    # −log of the marginal likelihood, the scale of the process put in its best place
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
    # Matérn's of order 3/2, whose curves may bend sharply, over all images
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
    # Beyond the normal the arc has a mirror image; up to the normal flux is even
    own = vertices[:, 0] >= 0
    fall, total = _fall(vertices[own]), totals[own]
    if fall[0] > _AT_NORMAL:
        fall, total = np.append(0.0, fall), np.append(total[0], total)
    return FluxCurve(PchipInterpolator(fall, total, extrapolate=False))


def _fall(direction: Directions) -> Values:
    # 1 − cos θ, exact near the normal
    square = direction[:, 0] ** 2 + direction[:, 1] ** 2
    return np.asarray(square / (1 + direction[:, 2]))
