"""Unified glare probability (UGP) of Hirning et al., linear and logistic."""

import numpy as np

from clerestory.array_types import Series, Values
from clerestory.glare.index import GlareIndex, adaptation, by_sources
from clerestory.glare.source_table import GlareSources


def ugp(sources: GlareSources, *, background: Values | float) -> Series:
    """Unified glare probability: fraction of disturbed occupants; 0 without sources.

    Reference: Hirning, M. B., Isoardi, G. L. and Cowling, I. (2014): Discomfort glare
    in open plan green buildings. Energy and Buildings 70.

    >>> window = GlareSources.of(luminance=[3e3], solid_angle=[0.2], position_index=[2])
    >>> ugp(window, background=300.0).round(3).tolist()
    [0.669]
    """
    scale = 0.25 / adaptation(background)
    return by_sources(
        sources, sources.weight(), lambda total: 0.26 * np.log10(scale * total)
    )


def logistic_ugp(sources: GlareSources, *, background: Values | float) -> Series:
    """Unified glare probability in logistic form, between 0 and 1.

    Reference: Hirning, M. B. et al. (2016); ugp2 of evalglare.

    >>> window = GlareSources.of(luminance=[3e3], solid_angle=[0.2], position_index=[2])
    >>> logistic_ugp(window, background=300.0).round(3).tolist()
    [0.527]
    """
    level = adaptation(background)
    return by_sources(
        sources,
        sources.weight(),
        lambda total: (1 + 2 / 7 * (total / level) ** -0.2) ** -10,
    )


UGP = GlareIndex(
    name="ugp",
    formula=lambda eye: ugp(eye.sources, background=eye.background),
    column="ugp",
)
LOGISTIC_UGP = GlareIndex(
    name="logistic_ugp",
    formula=lambda eye: logistic_ugp(eye.sources, background=eye.background),
    column="ugp2",
)
