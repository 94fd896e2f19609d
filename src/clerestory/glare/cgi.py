"""CIE glare index (CGI) of Einhorn."""

import math

from clerestory.glare.index import GlareIndex, without_logarithm
from clerestory.glare.source_table import GlareSources


def cgi(sources: GlareSources, *, illuminance: float, direct: float) -> float:
    """CIE glare index; 0 without sources.

    Illuminances are vertical, at the eye [lux]; `direct` is that from the sources
    alone.

    Reference: Einhorn, H. D. (1979): Discomfort glare: a formula to bridge differences.
    Lighting Research and Technology 11(2).

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> round(cgi(lamp, illuminance=190.0, direct=52.0), 2)
    21.75
    """
    special = without_logarithm(sources, illuminance)
    if special is not None:
        return special
    scale = 2 * (1 + direct / 500) / illuminance
    return 8 * math.log10(scale * float(sources.weight().sum()))


CGI = GlareIndex(
    name="cgi",
    formula=lambda eye: cgi(
        eye.sources, illuminance=eye.illuminance, direct=eye.direct_illuminance
    ),
    thresholds=(13.0, 22.0, 28.0),  # Jakubiec and Reinhart 2012
    column="cgi",
)
