"""Definition of a glare index: formula and thresholds.

The formula of every index is in a module that also defines a `GlareIndex`. Results,
tables and comparisons contain all indices listed in the module `indices`.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Indices, Series, Values
from clerestory.glare.index_settings import IndexSettings
from clerestory.glare.source_table import GlareSources

CATEGORIES = ("imperceptible", "perceptible", "disturbing", "intolerable")


@dataclass(frozen=True, eq=False, kw_only=True)
class EyePhotometry:
    """Photometric quantities of a field of view: the inputs of the glare indices.

    There is one value for each time step. `illuminance` is vertical, at the eye [lux].
    `average` is the mean luminance of the picture, `reference` the mean luminance of
    the task, if any, else of the picture, `brightest` the largest luminance [cd/m²];
    `eye_illuminance` is the illuminance that adapts the eye in DGP, measured or from
    the picture; `solid_angle` is that of the view [sr].
    """

    sources: GlareSources
    illuminance: Series
    average: Series
    reference: Series
    brightest: Series
    eye_illuminance: Series
    solid_angle: float
    settings: IndexSettings

    @classmethod
    def joined(cls, parts: Sequence["EyePhotometry"]) -> "EyePhotometry":
        """Return parts of equal settings, whose time steps follow each other."""
        sources = GlareSources.joined([part.sources for part in parts])
        series = (
            np.concatenate([getattr(part, name) for part in parts]) for name in _SERIES
        )
        return parts[0]._with(sources, *series)

    def at_step(self, step: int) -> "EyePhotometry":
        """Return the quantities of one time step."""
        series = (getattr(self, name)[step : step + 1] for name in _SERIES)
        return self._with(self.sources.at_step(step), *series)

    def _with(self, sources: GlareSources, *series: np.ndarray) -> "EyePhotometry":
        # The same view and settings at other time steps
        illuminance, average, reference, brightest, eye_illuminance = series
        return replace(
            self,
            sources=sources,
            illuminance=illuminance,
            average=average,
            reference=reference,
            brightest=brightest,
            eye_illuminance=eye_illuminance,
        )

    @cached_property
    def direct_illuminance(self) -> Series:
        """Vertical illuminance at the eye from the glare sources, Edir [lux]."""
        return self.sources.totals(self.sources.illuminance)

    @cached_property
    def cie_background(self) -> Series:
        """Background luminance as defined by the CIE, (Ev − Edir)/π [cd/m²]."""
        return np.asarray((self.illuminance - self.direct_illuminance) / math.pi)

    @cached_property
    def background(self) -> Series:
        """Background luminance as defined by the settings [cd/m²]."""
        if self.settings.background == "cie":
            return self.cie_background
        if self.settings.background == "illuminance":
            return np.asarray(self.illuminance / math.pi)
        flux = self.sources.totals(self.sources.luminance * self.sources.solid_angle)
        rest = self.solid_angle - self.sources.totals(self.sources.solid_angle)
        other = self.solid_angle * self.average - flux
        found = np.divide(other, rest, out=self.average.copy(), where=rest != 0)
        return np.asarray(found)


_SERIES = ("illuminance", "average", "reference", "brightest", "eye_illuminance")


@dataclass(frozen=True)
class Quantity:
    """A quantity reported for every picture.

    `column` is the name in evalglare's output; None if evalglare does not print it.
    """

    name: str
    formula: Callable[[EyePhotometry], Series]
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


def by_sources(
    sources: GlareSources,
    values: Float[np.ndarray, " source"],
    formula: Callable[[Series], Series],
) -> Series:
    """Return a formula of the sum of values at each time step; 0 without sources."""
    seen = sources.counts > 0
    return np.where(seen, formula(np.where(seen, sources.totals(values), 1.0)), 0.0)


def adaptation(luminance: Values | float) -> Values:
    """Return an adaptation luminance or illuminance; NaN unless positive."""
    level = np.asarray(luminance, dtype=float)
    return np.where(level > 0, level, np.nan)
