"""CIE glare index of Einhorn."""

import math

from clerestory.glare.source_table import GlareSources


def cgi(sources: GlareSources, *, illuminance: float, direct: float) -> float:
    """CIE glare index, 0 without sources.

    Parameters
    ----------
    illuminance : on the eye, from everything in view [lux]
    direct : its part that comes from the sources [lux]

    References
    ----------
    Einhorn, H. D. (1979): Discomfort glare: a formula to bridge differences. Lighting
    Research and Technology 11(2).

    Examples
    --------
    >>> lamp = GlareSources.of(
    ...     luminance=[3000.0], solid_angle=[0.02], position_index=[2.0]
    ... )
    >>> round(cgi(lamp, illuminance=190.0, direct=52.0), 2)
    21.75
    """
    if not sources.count:
        return 0.0
    if illuminance <= 0:
        return math.nan
    scale = 2 * (1 + direct / 500) / illuminance
    return 8 * math.log10(scale * float(sources.weight().sum()))
