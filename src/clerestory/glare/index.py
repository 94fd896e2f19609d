"""Definition of a glare index: formula and thresholds.

The formula of every index is in a module that also defines a `GlareIndex`. Results,
tables and comparisons contain all indices listed in the module `indices`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clerestory.array_types import Indices, Values
from clerestory.glare.index_settings import IndexSettings
from clerestory.glare.source_table import GlareSources

CATEGORIES = ("imperceptible", "perceptible", "disturbing", "intolerable")


@dataclass(frozen=True, eq=False, kw_only=True)
class EyePhotometry:
    """Photometric quantities of a field of view: the inputs of the glare indices.

    `illuminance` is vertical, at the eye [lux]. `average` is the mean luminance of the
    picture, `reference` the mean luminance of the task, if any, else of the picture,
    `brightest` the largest luminance [cd/m²]; `solid_angle` is that of the view [sr].
    """

    sources: GlareSources
    illuminance: float
    average: float
    reference: float
    brightest: float
    solid_angle: float
    settings: IndexSettings

    @cached_property
    def direct_illuminance(self) -> float:
        """Vertical illuminance at the eye from the glare sources, Edir [lux]."""
        return float(self.sources.illuminance.sum())

    @cached_property
    def cie_background(self) -> float:
        """Background luminance as defined by the CIE, (Ev − Edir)/π [cd/m²]."""
        return (self.illuminance - self.direct_illuminance) / math.pi

    @cached_property
    def background(self) -> float:
        """Background luminance as defined by the settings [cd/m²]."""
        if self.settings.background == "cie":
            return self.cie_background
        if self.settings.background == "illuminance":
            return self.illuminance / math.pi
        omega = float(self.sources.solid_angle.sum())
        flux = float(self.sources.luminance @ self.sources.solid_angle)
        rest = self.solid_angle - omega
        return (self.solid_angle * self.average - flux) / rest if rest else self.average

    @cached_property
    def eye_illuminance(self) -> float:
        """Vertical illuminance at the eye, measured or from the picture [lux]."""
        given = self.settings.given_illuminance
        return self.illuminance if given is None else given


@dataclass(frozen=True)
class Quantity:
    """A quantity reported for every picture.

    `column` is the name in evalglare's output; None if evalglare does not print it.
    """

    name: str
    formula: Callable[[EyePhotometry], float]
    unit: str = "1"
    column: str | None = None


@dataclass(frozen=True, kw_only=True)
class GlareIndex(Quantity):
    """An index of discomfort glare; all indices but VCP increase with glare.

    `thresholds` are the values from which glare is perceptible, disturbing and
    intolerable; empty if not published.
    """

    thresholds: tuple[float, ...] = ()
    glare_increases: bool = True

    def category(self, values: Values) -> Indices:
        """Index of the glare category in `CATEGORIES`; 0 for NaN, as in the dark."""
        sign = 1 if self.glare_increases else -1
        limits = sign * np.asarray(self.thresholds)
        found = np.searchsorted(limits, sign * values, side="left")
        return np.where(np.isnan(values), 0, found)


def without_logarithm(sources: GlareSources, adaptation: float) -> float | None:
    """Return the value of a logarithmic index where its logarithm is undefined.

    The value is 0 without glare sources, and NaN for an adaptation luminance of 0 or
    less; otherwise the logarithm is defined, and None is returned.
    """
    if not sources.count:
        return 0.0
    return math.nan if adaptation <= 0 else None
