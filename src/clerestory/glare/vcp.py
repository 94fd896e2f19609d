"""Visual comfort probability (VCP) and Guth's discomfort glare rating (DGR)."""

import math

import numpy as np

from clerestory.array_types import Series, Values
from clerestory.glare.index import GlareIndex, adaptation, by_sources
from clerestory.glare.source_table import GlareSources

# Values of DGR above which VCP is 0 %, and below which it is 100 % (evalglare)
_LARGEST_RATING, _SMALLEST_RATING = 750.0, 20.0


def dgr(sources: GlareSources, *, average: Values | float) -> Series:
    """Guth's discomfort glare rating; 0 without sources.

    `average` is the mean luminance of the field of view [cd/m²].

    Reference: Guth, S. K. (1963): A method for the evaluation of discomfort glare.
    Illuminating Engineering 57. IESNA Lighting Handbook, 9th edition, chapter 9.

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> dgr(lamp, average=60.0).round(1).tolist()
    [127.3]
    """
    omega = sources.solid_angle
    size = 20.4 * omega + 1.52 * omega**0.2 - 0.075
    each = 0.5 * sources.luminance * size / sources.position_index
    power = np.maximum(sources.counts, 1) ** -0.0914
    scale = adaptation(average) ** -0.44
    return by_sources(
        sources, each, lambda total: (np.maximum(total, 0) * scale) ** power
    )


def vcp(rating: Values | float) -> Values:
    """Visual comfort probability [%] from the discomfort glare rating.

    >>> vcp(np.array([120.0])).round(1).tolist()
    [51.7]
    """
    level = np.asarray(rating, dtype=float)
    inside = np.clip(level, _SMALLEST_RATING, _LARGEST_RATING)
    place = (6.374 - 1.3227 * np.log(inside)) / math.sqrt(2)
    share = np.reshape([math.erf(x) for x in place.ravel().tolist()], place.shape)
    found = np.where(level > _LARGEST_RATING, 0.0, 50 + 50 * share)
    return np.where(level < _SMALLEST_RATING, 100.0, found)


DGR = GlareIndex(
    name="dgr",
    formula=lambda eye: dgr(eye.sources, average=eye.average),
    column="dgr",
)
VCP = GlareIndex(
    name="vcp",
    formula=lambda eye: vcp(DGR.formula(eye)),
    thresholds=(80.0, 60.0, 40.0),  # Jakubiec and Reinhart 2012
    glare_increases=False,
    unit="%",
    column="vcp",
)
