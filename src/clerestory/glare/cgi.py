"""CIE glare index (CGI) of Einhorn."""

import numpy as np

from clerestory.array_types import Series, Values
from clerestory.glare.index import GlareIndex, adaptation, by_sources
from clerestory.glare.source_table import GlareSources


def cgi(
    sources: GlareSources, *, illuminance: Values | float, direct: Values | float
) -> Series:
    """CIE glare index; 0 without sources.

    Illuminances are vertical, at the eye [lux]; `direct` is that from the sources
    alone.

    Reference: Einhorn, H. D. (1979): Discomfort glare: a formula to bridge differences.
    Lighting Research and Technology 11(2).

    >>> lamp = GlareSources.of(luminance=[3e3], solid_angle=[0.02], position_index=[2])
    >>> cgi(lamp, illuminance=190.0, direct=52.0).round(2).tolist()
    [21.75]
    """
    scale = 2 * (1 + np.asarray(direct) / 500) / adaptation(illuminance)
    return by_sources(
        sources, sources.weight(), lambda total: 8 * np.log10(scale * total)
    )


CGI = GlareIndex(
    name="cgi",
    formula=lambda eye: cgi(
        eye.sources, illuminance=eye.illuminance, direct=eye.direct_illuminance
    ),
    thresholds=(13.0, 22.0, 28.0),  # Jakubiec and Reinhart 2012
    column="cgi",
)
