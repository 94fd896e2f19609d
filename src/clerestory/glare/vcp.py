"""Visual comfort probability, and the discomfort glare rating it is made of."""

import math

from clerestory.glare.source_table import GlareSources

# Beyond these ratings nobody, or everybody, is comfortable (evalglare)
_NOBODY, _EVERYBODY = 750.0, 20.0


def dgr(sources: GlareSources, *, average: float) -> float:
    """Guth's discomfort glare rating, 0 without sources.

    Parameters
    ----------
    average : luminance of the whole field of view [cd/m²]

    References
    ----------
    Guth, S. K. (1963): A method for the evaluation of discomfort glare. Illuminating
    Engineering 57. IESNA Lighting Handbook, 9th edition, chapter 9.

    Examples
    --------
    >>> lamp = GlareSources.of(
    ...     luminance=[3000.0], solid_angle=[0.02], position_index=[2.0]
    ... )
    >>> round(dgr(lamp, average=60.0), 1)
    127.3
    """
    if not sources.count:
        return 0.0
    if average <= 0:
        return math.nan
    omega = sources.solid_angle
    size = 20.4 * omega + 1.52 * omega**0.2 - 0.075
    each = 0.5 * sources.luminance * size / (sources.position_index * average**0.44)
    total = float(each.sum())
    return total ** (sources.count**-0.0914) if total > 0 else 0.0


def vcp(rating: float) -> float:
    """Share of people who feel comfortable [%] at a discomfort glare rating.

    Examples
    --------
    >>> round(vcp(120.0), 1)
    51.7
    """
    if math.isnan(rating):
        return math.nan
    if rating > _NOBODY:
        return 0.0
    if rating < _EVERYBODY:
        return 100.0
    return 50 + 50 * math.erf((6.374 - 1.3227 * math.log(rating)) / math.sqrt(2))
