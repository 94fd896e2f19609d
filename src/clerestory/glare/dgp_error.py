"""Standard error of DGP at a view point, to first order.

DGP depends on the luminance L of a cell by the vertical illuminance, Σ L ω cos θ, and
by the glare sources, Σ L^a1 ω/P^a4, with L = 0 below the threshold of sources. The
derivatives by both sums are those of the DGP equation at the time step.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.glare.eye_directions import SunDisc, seen_by
from clerestory.glare.index_settings import DgpCoefficients
from clerestory.glare.sphere_samples import SphereSamples
from clerestory.scene.view import View

Light = Float[np.ndarray, "cell step"]


class DgpTerms(NamedTuple):
    """Derivatives of DGP in each view at each time step.

    `by_level` is that by the vertical illuminance, `by_glare` by the sum over sources.
    `value` is DGP if every cell were a source of its own, without its limit of 1.
    """

    value: Float[np.ndarray, "view step"]
    by_level: Float[np.ndarray, "view step"]
    by_glare: Float[np.ndarray, "view step"]


@dataclass(frozen=True, eq=False)
class DgpModel:
    """DGP as a function of the luminance of cells, in several views.

    `threshold` is the luminance above which cells are glare sources [cd/m²].
    """

    samples: SphereSamples
    views: Sequence[View]
    threshold: float
    coefficients: DgpCoefficients

    def glare(self, luminance: Light) -> Light:
        """Return L^a1, 0 below the threshold."""
        bright = np.where(luminance > self.threshold, luminance, 0)
        return np.asarray(bright**self.coefficients.a1)

    @cached_property
    def weights(
        self,
    ) -> tuple[Float[np.ndarray, "view cell"], Float[np.ndarray, "view cell"]]:
        """Weights of L and of L^a1 in both sums, ω cos θ and ω/P^a4."""
        found = [self._weights(view, self.samples.direction) for view in self.views]
        cosine, index = (np.array(part) for part in zip(*found, strict=True))
        omega = self.samples.solid_angle
        return (cosine * omega).astype("f4"), (index * omega).astype("f4")

    def terms(self, luminance: Light, sun: SunDisc | None = None) -> DgpTerms:
        """Return the derivatives."""
        k, (of_level, of_glare) = self.coefficients, self.weights
        illuminance = (of_level @ luminance).astype(float)
        total = (of_glare @ self.glare(luminance)).astype(float)
        if sun is not None:
            found = [self._weights(view, sun.direction) for view in self.views]
            beside, high = (np.array(part) for part in zip(*found, strict=True))
            illuminance += sun.luminance * sun.solid_angle * beside
            total += sun.luminance**k.a1 * sun.solid_angle * high
        illuminance = np.maximum(illuminance, 1e-9)
        value = k.c1 * illuminance + k.c3
        value += k.c2 * np.log10(1 + total / illuminance**k.a3)
        return DgpTerms(value, *dgp_slopes(illuminance, total, k))

    def _weights(self, view: View, direction: np.ndarray) -> tuple[Values, Values]:
        # Cosine and P^−a4 of each direction, 0 behind the eye
        eye = seen_by(view, direction)
        index = eye.position_index**-self.coefficients.a4
        return eye.cosine, np.where(eye.ahead, index, 0)

    def variance(
        self, terms: DgpTerms, of_level: Light, of_glare: Light
    ) -> Float[np.ndarray, "view step"]:
        """Variance of DGP by independent deviations of L and L^a1 of each cell.

        Both deviations of a cell are fully correlated.
        """
        one, other = self.weights
        square = np.square(terms.by_level) * (one**2 @ np.square(of_level))
        square += np.square(terms.by_glare) * (other**2 @ np.square(of_glare))
        both = terms.by_level * terms.by_glare * ((one * other) @ (of_level * of_glare))
        return np.asarray(np.maximum(square + 2 * both, 0))


def dgp_slopes(
    illuminance: Values, total: Values, coefficients: DgpCoefficients
) -> tuple[Values, Values]:
    """Return the derivatives of DGP by the vertical illuminance and by the sum.

    `total` is the sum of L^a1 ω/P^a4 over the glare sources.
    """
    k, illuminance = coefficients, np.maximum(illuminance, 1e-9)
    by_glare = k.c2 / np.log(10) / (illuminance**k.a3 + total)
    by_level = k.c1 - by_glare * k.a3 * total / illuminance
    return by_level, by_glare


def limited(
    error: Float[np.ndarray, "view step"], value: Float[np.ndarray, "view step"]
) -> Float[np.ndarray, "view step"]:
    """Return the standard error of DGP with its limit of 1, for normal errors.

    `value` is DGP without the limit.

    >>> limited(np.full((1, 2), 0.02), np.array([[0.5, 1.2]])).tolist()
    [[0.02, 0.0]]
    """
    share = (1 - value) / np.maximum(error, 1e-9)
    below = np.clip(0.5 + share / 4, 0, 1)
    return np.asarray(error * below)


def statistical_variance(
    model: DgpModel,
    terms: DgpTerms,
    luminance: Light,
    variance: Light,
    shared: Float[np.ndarray, "draw cell step"],
) -> Float[np.ndarray, "view step"]:
    """Return the variance of DGP by the statistical errors of the luminance.

    `variance` is independent by cell; the mean of the squares of `shared` deviations is
    the variance that cells have in common.
    """
    own = np.sqrt(variance)
    found = model.variance(terms, own, _half(model, luminance, own))
    level, high = model.weights
    for change in shared:
        both = terms.by_level * (level @ change)
        both += terms.by_glare * (high @ _half(model, luminance, change))
        found += np.square(both) / len(shared)
    return found


def _half(model: DgpModel, luminance: Light, change: Light) -> Light:
    # Half of the difference of L^a1 for luminances above and below by the change
    more, less = luminance + change, np.maximum(luminance - change, 0)
    return np.asarray((model.glare(more) - model.glare(less)) / 2)
