"""Daylight glare index (DGI), and its modification by Fisekis et al."""

import math

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Series, Values
from clerestory.glare.index import GlareIndex, adaptation, by_sources
from clerestory.glare.source_table import GlareSources


def dgi(
    sources: GlareSources,
    *,
    background: Values | float,
    weighted: Float[np.ndarray, " source"] | None = None,
) -> Series:
    """Daylight glare index: 16 just perceptible, 24 just uncomfortable, 28 intolerable.

    The index is 0 without sources. The background luminance is in cd/m²; `weighted` is
    the position-weighted solid angle of each source [sr], by default ω/P².

    Reference: Hopkinson, R. G. (1972): Glare from daylighting in buildings. Applied
    Ergonomics 3(4). Chauvel, P. et al. (1982): Glare from windows: current views of
    the problem. Lighting Research and Technology 14(1).

    >>> window = GlareSources.of(luminance=[5e3], solid_angle=[0.5], position_index=[2])
    >>> dgi(window, background=300.0).round(1).tolist()
    [21.4]
    """
    omega = sources.guth_solid_angle() if weighted is None else weighted
    below = sources.at_source(background)
    below += 0.07 * sources.solid_angle**0.5 * sources.luminance
    terms = sources.luminance**1.6 * omega**0.8 / below
    return by_sources(
        sources, terms, lambda total: 10 * np.log10(0.478 * adaptation(total))
    )


def modified_dgi(sources: GlareSources, *, average: Values | float) -> Series:
    """DGI with an adaptation luminance in place of the background luminance.

    The adaptation luminance is a power of `average`, the mean luminance Ev/π [cd/m²].

    Reference: Fisekis, K. et al. (2003): Prediction of discomfort glare from windows.
    Lighting Research and Technology 35(4), equation 11.

    >>> window = GlareSources.of(luminance=[5e3], solid_angle=[0.5], position_index=[2])
    >>> modified_dgi(window, average=800.0).round(1).tolist()
    [21.4]
    """
    level = np.asarray(average, dtype=float)
    adapted = np.where(level > 0, np.maximum(level, 0) ** 0.85, level)
    return dgi(sources, background=adapted)


DGI = GlareIndex(
    name="dgi",
    formula=lambda eye: dgi(eye.sources, background=eye.background),
    thresholds=(18.0, 24.0, 31.0),  # Jakubiec and Reinhart 2012
    column="dgi",
)
MODIFIED_DGI = GlareIndex(
    name="modified_dgi",
    formula=lambda eye: modified_dgi(eye.sources, average=eye.illuminance / math.pi),
    column="dgi_mod",
)
