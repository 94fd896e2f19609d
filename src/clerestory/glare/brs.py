"""Glare index of the Building Research Station (BRS), the predecessor of DGI."""

import math

from clerestory.glare.index import without_logarithm
from clerestory.glare.source_table import GlareSources


def brs_glare_index(sources: GlareSources, *, background: float) -> float:
    """BRS glare index: 10 just imperceptible, 16 acceptable, 22 uncomfortable.

    The index was derived for small luminaires. It is 0 without sources and NaN for a
    background luminance of 0 cd/m².

    Reference: Petherbridge, P., Hopkinson, R. G. (1950): Discomfort glare and the
    lighting of buildings. Transactions of the Illuminating Engineering Society 15(2).

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> round(brs_glare_index(lamp, background=40.0), 1)
    18.0
    """
    special = without_logarithm(sources, background)
    if special is not None:
        return special
    bright = (sources.luminance / sources.position_index) ** 1.6
    total = float((bright * sources.solid_angle**0.8).sum())
    return 10 * math.log10(0.478 * total / background) if total > 0 else 0.0
