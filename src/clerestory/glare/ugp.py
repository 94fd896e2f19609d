"""Unified glare probability of Hirning, fitted in open-plan green buildings."""

import math

from clerestory.glare.source_table import GlareSources


def ugp(sources: GlareSources, *, background: float) -> float:
    """Unified glare probability, the share of people disturbed; 0 without sources.

    Parameters
    ----------
    background : luminance of what is no source [cd/m²]

    References
    ----------
    Hirning, M. B., Isoardi, G. L. and Cowling, I. (2014): Discomfort glare in open
    plan green buildings. Energy and Buildings 70.

    Examples
    --------
    >>> window = GlareSources.of(
    ...     luminance=[3000.0], solid_angle=[0.2], position_index=[2.0]
    ... )
    >>> round(ugp(window, background=300.0), 3)
    0.669
    """
    if not sources.count:
        return 0.0
    if background <= 0:
        return math.nan
    return 0.26 * math.log10(0.25 / background * float(sources.weight().sum()))


def logistic_ugp(sources: GlareSources, *, background: float) -> float:
    """Unified glare probability in its later form, which stays between 0 and 1.

    References
    ----------
    Hirning, M. B. et al. (2016), as in evalglare's UGP2.

    Examples
    --------
    >>> window = GlareSources.of(
    ...     luminance=[3000.0], solid_angle=[0.2], position_index=[2.0]
    ... )
    >>> round(logistic_ugp(window, background=300.0), 3)
    0.527
    """
    if not sources.count:
        return 0.0
    if background <= 0:
        return math.nan
    ratio = float(sources.weight().sum()) / background
    return float((1 + 2 / 7 * ratio**-0.2) ** -10)
