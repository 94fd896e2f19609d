"""Veiling luminance: disability glare due to light scattered in the eye."""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Series
from clerestory.glare.index import Quantity
from clerestory.glare.source_table import GlareSources

# Added to θ² to avoid division by zero on the line of sight, as in evalglare
_TINY = 1e-16


def veiling_luminance(sources: GlareSources) -> Float[np.ndarray, " source"]:
    """Veiling luminance of each source after Stiles and Holladay, 10 E/θ² [cd/m²].

    E is the vertical illuminance at the eye [lux], θ the angle from the line of sight
    [°]. Valid for young observers and angles from 1° to 30°.

    Reference: Vos, J. J. (2003): On the cause of disability glare and its dependence on
    glare angle, age and ocular pigmentation. Clinical and Experimental Optometry 86(6).
    CIE 146:2002.

    >>> lamp = {"luminance": [1e4], "solid_angle": [0.01], "position_index": [1]}
    >>> lamp = GlareSources.of(**lamp, sigma=np.radians([10]))
    >>> veiling_luminance(lamp).round(2).tolist()
    [9.85]
    """
    degrees = np.degrees(sources.sigma)
    return np.asarray(10 * sources.illuminance / (degrees**2 + _TINY))


def poynter_veiling_luminance(sources: GlareSources) -> Series:
    """Veiling luminance of all sources after Poynter [cd/m²], Lveil of evalglare.

    >>> lamp = {"luminance": [1e4], "solid_angle": [0.01], "position_index": [1]}
    >>> lamp = GlareSources.of(**lamp, sigma=np.radians([10]))
    >>> poynter_veiling_luminance(lamp).round(2).tolist()
    [49.24]
    """
    flux = sources.luminance * np.cos(sources.sigma) * sources.solid_angle
    return 5 * sources.totals(flux / (np.degrees(sources.sigma) + 1e-11))


POYNTER_VEILING_LUMINANCE = Quantity(
    name="veiling_luminance",
    formula=lambda eye: poynter_veiling_luminance(eye.sources),
    unit="cd/m2",
    column="Lveil",
)
CIE_VEILING_LUMINANCE = Quantity(
    name="cie_veiling_luminance",
    formula=lambda eye: eye.sources.totals(veiling_luminance(eye.sources)),
    unit="cd/m2",
    column="Lveil_cie",
)
