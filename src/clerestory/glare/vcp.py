"""Visual comfort probability (VCP) and Guth's discomfort glare rating (DGR)."""

import math

from clerestory.glare.index import GlareIndex, without_logarithm
from clerestory.glare.source_table import GlareSources

# Values of DGR above which VCP is 0 %, and below which it is 100 % (evalglare)
_LARGEST_RATING, _SMALLEST_RATING = 750.0, 20.0


def dgr(sources: GlareSources, *, average: float) -> float:
    """Guth's discomfort glare rating; 0 without sources.

    `average` is the mean luminance of the field of view [cd/m²].

    Reference: Guth, S. K. (1963): A method for the evaluation of discomfort glare.
    Illuminating Engineering 57. IESNA Lighting Handbook, 9th edition, chapter 9.

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> round(dgr(lamp, average=60.0), 1)
    127.3
    """
    special = without_logarithm(sources, average)
    if special is not None:
        return special
    omega = sources.solid_angle
    size = 20.4 * omega + 1.52 * omega**0.2 - 0.075
    each = 0.5 * sources.luminance * size / (sources.position_index * average**0.44)
    total = float(each.sum())
    return total ** (sources.count**-0.0914) if total > 0 else 0.0


def vcp(rating: float) -> float:
    """Visual comfort probability [%] from the discomfort glare rating.

    >>> round(vcp(120.0), 1)
    51.7
    """
    if math.isnan(rating):
        return math.nan
    if rating > _LARGEST_RATING:
        return 0.0
    if rating < _SMALLEST_RATING:
        return 100.0
    return 50 + 50 * math.erf((6.374 - 1.3227 * math.log(rating)) / math.sqrt(2))


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
