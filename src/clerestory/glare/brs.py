"""Glare index of the Building Research Station (BRS), the predecessor of DGI."""

import numpy as np

from clerestory.array_types import Series, Values
from clerestory.glare.index import adaptation, by_sources
from clerestory.glare.source_table import GlareSources


def brs_glare_index(sources: GlareSources, *, background: Values | float) -> Series:
    """BRS glare index: 10 just imperceptible, 16 acceptable, 22 uncomfortable.

    The index was derived for small luminaires. It is 0 without sources and NaN for a
    background luminance of 0 cd/m².

    Reference: Petherbridge, P., Hopkinson, R. G. (1950): Discomfort glare and the
    lighting of buildings. Transactions of the Illuminating Engineering Society 15(2).

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> brs_glare_index(lamp, background=40.0).round(1).tolist()
    [18.0]
    """
    level = adaptation(background)
    bright = (sources.luminance / sources.position_index) ** 1.6
    each = bright * sources.solid_angle**0.8
    return by_sources(sources, each, lambda total: 10 * np.log10(0.478 * total / level))
