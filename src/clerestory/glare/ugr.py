"""Unified glare rating of CIE 117, and Fisekis's variant of it."""

import math

from clerestory.glare.source_table import GlareSources


def ugr(sources: GlareSources, *, background: float) -> float:
    """Unified glare rating: 10 imperceptible, 19 a limit for offices, 28 intolerable.

    0 without sources, nan without a background.

    Parameters
    ----------
    background : luminance of what is no source [cd/m²]

    References
    ----------
    CIE 117-1995: Discomfort glare in interior lighting.

    Examples
    --------
    >>> lamp = GlareSources.of(
    ...     luminance=[3000.0], solid_angle=[0.02], position_index=[2.0]
    ... )
    >>> round(ugr(lamp, background=40.0), 2)
    19.59
    """
    if not sources.count:
        return 0.0
    if background <= 0:
        return math.nan
    return 8 * math.log10(0.25 / background * float(sources.weight().sum()))


def experimental_ugr(
    sources: GlareSources, *, average: float, background: float
) -> float:
    """UGR with one luminance of each source replaced by that of the whole field.

    Parameters
    ----------
    average : luminance of the whole field of view, Ev/π [cd/m²]
    background : luminance of what is no source [cd/m²]

    References
    ----------
    Fisekis, K. et al. (2003): Prediction of discomfort glare from windows. Lighting
    Research and Technology 35(4).

    Examples
    --------
    >>> lamp = GlareSources.of(
    ...     luminance=[3000.0], solid_angle=[0.02], position_index=[2.0]
    ... )
    >>> round(experimental_ugr(lamp, average=100.0, background=40.0), 2)
    12.59
    """
    if not sources.count:
        return 0.0
    if background <= 0 or average <= 0:
        return math.nan
    seen = float((sources.luminance * sources.guth_solid_angle()).sum())
    return 8 * math.log10(average * seen / background)
