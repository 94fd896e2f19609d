"""Unified glare probability (UGP) of Hirning et al., linear and logistic."""

import math

from clerestory.glare.index import GlareIndex, without_logarithm
from clerestory.glare.source_table import GlareSources


def ugp(sources: GlareSources, *, background: float) -> float:
    """Unified glare probability: fraction of disturbed occupants; 0 without sources.

    Reference: Hirning, M. B., Isoardi, G. L. and Cowling, I. (2014): Discomfort glare
    in open plan green buildings. Energy and Buildings 70.

    >>> window = GlareSources.of(luminance=[3e3], solid_angle=[0.2], position_index=[2])
    >>> round(ugp(window, background=300.0), 3)
    0.669
    """
    special = without_logarithm(sources, background)
    if special is not None:
        return special
    return 0.26 * math.log10(0.25 / background * float(sources.weight().sum()))


def logistic_ugp(sources: GlareSources, *, background: float) -> float:
    """Unified glare probability in logistic form, between 0 and 1.

    Reference: Hirning, M. B. et al. (2016); ugp2 of evalglare.

    >>> window = GlareSources.of(luminance=[3e3], solid_angle=[0.2], position_index=[2])
    >>> round(logistic_ugp(window, background=300.0), 3)
    0.527
    """
    special = without_logarithm(sources, background)
    if special is not None:
        return special
    ratio = float(sources.weight().sum()) / background
    return float((1 + 2 / 7 * ratio**-0.2) ** -10)


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
