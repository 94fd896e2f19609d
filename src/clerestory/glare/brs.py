"""Glare index of the Building Research Station, the forerunner of DGI."""

import math

from clerestory.glare.source_table import GlareSources


def brs_glare_index(sources: GlareSources, *, background: float) -> float:
    """BRS glare index: 10 just imperceptible, 16 acceptable, 22 uncomfortable.

    0 without sources, nan without a background. Made for small luminaires.

    Parameters
    ----------
    background : luminance of what is no source [cd/m²]

    References
    ----------
    Petherbridge, P., Hopkinson, R. G. (1950): Discomfort glare and the lighting of
    buildings. Transactions of the Illuminating Engineering Society 15(2).

    Examples
    --------
    >>> lamp = GlareSources.of(
    ...     luminance=[3000.0], solid_angle=[0.02], position_index=[2.0]
    ... )
    >>> round(brs_glare_index(lamp, background=40.0), 1)
    18.0
    """
    if not sources.count:
        return 0.0
    if background <= 0:
        return math.nan
    bright = (sources.luminance / sources.position_index) ** 1.6
    total = float((bright * sources.solid_angle**0.8).sum())
    return 10 * math.log10(0.478 * total / background) if total > 0 else 0.0
