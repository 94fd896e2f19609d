"""Unified glare rating (UGR) of CIE 117, and the variant of Fisekis et al."""

import math

import numpy as np

from clerestory.array_types import Series, Values
from clerestory.glare.index import GlareIndex, adaptation, by_sources
from clerestory.glare.source_table import GlareSources


def ugr(sources: GlareSources, *, background: Values | float) -> Series:
    """Unified glare rating: 10 imperceptible, 19 limit for offices, 28 intolerable.

    The rating is 0 without sources and NaN for a background luminance of 0 cd/m².

    Reference: CIE 117-1995: Discomfort glare in interior lighting.

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> ugr(lamp, background=40.0).round(2).tolist()
    [19.59]
    """
    scale = 0.25 / adaptation(background)
    return by_sources(
        sources, sources.weight(), lambda total: 8 * np.log10(scale * total)
    )


def experimental_ugr(
    sources: GlareSources, *, average: Values | float, background: Values | float
) -> Series:
    """UGR with L² of each source replaced by L times the mean luminance Ev/π [cd/m²].

    Reference: Fisekis, K. et al. (2003): Prediction of discomfort glare from windows.
    Lighting Research and Technology 35(4).

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> experimental_ugr(lamp, average=100.0, background=40.0).round(2).tolist()
    [12.59]
    """
    scale = adaptation(average) / adaptation(background)
    flux = sources.luminance * sources.guth_solid_angle()
    return by_sources(sources, flux, lambda total: 8 * np.log10(scale * total))


UGR = GlareIndex(
    name="ugr",
    formula=lambda eye: ugr(eye.sources, background=eye.background),
    thresholds=(13.0, 22.0, 28.0),  # Jakubiec and Reinhart 2012
    column="ugr",
)
EXPERIMENTAL_UGR = GlareIndex(
    name="experimental_ugr",
    formula=lambda eye: experimental_ugr(
        eye.sources, average=eye.illuminance / math.pi, background=eye.cie_background
    ),
    column="ugr_exp",
)
