"""Standard error of DGP at a view point, to first order.

DGP depends on the luminance L of a cell by the vertical illuminance, Σ L ω cos θ, and
by the glare sources, Σ L^a1 ω/P^a4, with L = 0 below the threshold of sources. The
derivatives by both sums are those of the DGP equation at the time step.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
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
    """Derivatives of DGP in one view at each time step, and weights of the cells.

    `cosine` is that of each cell, 0 behind the eye; `weight` is P^−a4.
    """

    by_illuminance: Float[np.ndarray, " step"]
    by_glare: Float[np.ndarray, " step"]
    cosine: Values
    weight: Values


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

    def terms(self, luminance: Light, sun: SunDisc | None = None) -> Iterator[DgpTerms]:
        """Yield the derivatives in each view."""
        k, omega = self.coefficients, self.samples.solid_angle
        glare = self.glare(luminance)
        for view in self.views:
            cosine, weight = self._weights(view, self.samples.direction)
            illuminance, total = (omega * cosine) @ luminance, (omega * weight) @ glare
            if sun is not None:
                beside, high = self._weights(view, sun.direction)
                illuminance += sun.luminance * sun.solid_angle * beside
                total += sun.luminance**k.a1 * sun.solid_angle * high
            illuminance = np.maximum(illuminance, 1e-9)
            by_glare = k.c2 / np.log(10) / (illuminance**k.a3 + total)
            by_level = k.c1 - by_glare * k.a3 * total / illuminance
            yield DgpTerms(by_level, by_glare, cosine, weight)

    def _weights(self, view: View, direction: np.ndarray) -> tuple[Values, Values]:
        eye = seen_by(view, direction)
        index = eye.position_index**-self.coefficients.a4
        return eye.cosine, np.where(eye.ahead, index, 0)


def dgp_variance(
    model: DgpModel,
    luminance: Light,
    variance: Light,
    shared: Float[np.ndarray, "draw cell step"],
    sun: SunDisc,
) -> Float[np.ndarray, "view step"]:
    """Return the variance of DGP by the statistical errors of the luminance.

    `variance` is independent by cell; the mean of the squares of `shared` deviations is
    the variance that cells have in common.
    """
    omega = model.samples.solid_angle
    found = np.zeros((len(model.views), luminance.shape[1]))
    changes = [
        (change, _half(model, luminance, change))
        for change in (np.sqrt(variance), *shared)
    ]
    for number, each in enumerate(model.terms(luminance, sun)):
        level, high = omega * each.cosine, omega * each.weight
        own, common = changes[0], changes[1:]
        part = each.by_illuminance * own[0] * level[:, None]
        part += each.by_glare * own[1] * high[:, None]
        found[number] = np.einsum("ij,ij->j", part, part)
        for one, other in common:
            change = each.by_illuminance * (level @ one)
            change += each.by_glare * (high @ other)
            found[number] += change**2 / len(common)
    return found


def _half(model: DgpModel, luminance: Light, change: Light) -> Light:
    # Half of the difference of L^a1 for luminances above and below by the change
    more, less = luminance + change, np.maximum(luminance - change, 0)
    return np.asarray((model.glare(more) - model.glare(less)) / 2)
