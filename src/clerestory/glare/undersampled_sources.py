"""Glare sources that rest on few path samples.

A path that reaches the sun by chance, as by way of a glossy surface, gives a bright
pixel, which is elsewhere or missing with another seed. The glare without such sources
is computed as well, since errors of this size do not follow from small deviations.
"""

import math
from dataclasses import dataclass

import numpy as np

from clerestory.array_types import Image
from clerestory.glare.glare_view import GlareView
from clerestory.glare.indices import Glare
from clerestory.glare.source_table import GlareSources
from clerestory.glare.sources import Members
from clerestory.glare.uncertainty import UncertainLuminance
from clerestory.scene.view import View

# Effective number of path samples below which a source is undersampled, and largest
# share of DGP that needs no warning
_SAMPLES, _SHARE = 8.0, 0.01

# Effective number of path samples up to which a source is due to a single path
_SINGLE = 1.5


@dataclass(frozen=True)
class UndersampledSources:
    """Undersampled glare sources of a picture, described by the strongest one.

    `without` is DGP without these sources, `right` and `above` are the angles of the
    strongest source from the line of sight [rad].
    """

    count: int
    luminance: float
    samples: float
    right: float
    above: float
    dgp: float
    dgp_error: float
    without: float

    @property
    def share(self) -> float:
        """Fraction of DGP that is lost without the sources."""
        return 1 - self.without / self.dgp if self.dgp > 0 else 0.0

    def words(self) -> str:
        """Direction, number of samples and share of DGP in words."""
        places = [
            f"{abs(math.degrees(angle)):.0f}° {positive if angle >= 0 else negative}"
            for angle, positive, negative in (
                (self.right, "to the right of", "to the left of"),
                (self.above, "above", "below"),
            )
        ]
        relative = 100 / math.sqrt(self.samples)
        few = "a single path sample"
        if self.samples >= _SINGLE:
            few = f"about {self.samples:.0f} path samples"
        cause = "this source" if self.count == 1 else f"{self.count} such sources"
        return (
            f"the glare source {' and '.join(places)} the line of sight rests on {few}"
            f" ({self.luminance:.2g} cd/m² ± {relative:.0f} %); {cause} cause"
            f"{'s' * (self.count == 1)} {100 * self.share:.0f} % of DGP"
            f" {self.dgp:.3f} ± {self.dgp_error:.3f}; more samples expected"
        )


def without_undersampled(
    luminance: UncertainLuminance, eye: GlareView, members: Members
) -> Image | None:
    """Return the luminance, with undersampled sources reduced by their error [cd/m²].

    None if there are no such sources.
    """
    label, row, column = members
    omega = eye.solid_angle[row, column]
    flux = np.bincount(label, luminance.value[row, column] * omega)
    noise = np.bincount(label, (luminance.error[row, column] * omega) ** 2)
    poor = (_SAMPLES * noise > flux**2)[label]
    if not poor.any():
        return None
    place = row[poor], column[poor]
    reduced = luminance.value.copy()
    reduced[place] = np.maximum(reduced[place] - luminance.error[place], 0)
    return reduced


def undersampled_sources(
    result: Glare, without: float, view: View
) -> UndersampledSources | None:
    """Return the undersampled sources, if they have an appreciable share of DGP.

    `without` is DGP without these sources.
    """
    every: GlareSources = result.sources
    sources = every.select(every.samples() < _SAMPLES)
    dgp = result.dgp if sources.count else 0.0
    if not sources.count or without > (1 - _SHARE) * dgp:
        return None
    number = int(np.argmax(sources.weight()))
    direction = sources.direction[number]
    side = np.cross(view.direction, view.up)
    side = side / np.linalg.norm(side)
    above = float(direction @ np.cross(side, view.direction))
    return UndersampledSources(
        count=sources.count,
        luminance=float(sources.luminance[number]),
        samples=float(sources.samples()[number]),
        right=math.atan2(float(direction @ side), float(direction @ view.direction)),
        above=math.asin(max(-1.0, min(1.0, above))),
        dgp=dgp,
        dgp_error=result.errors["dgp"],
        without=without,
    )
