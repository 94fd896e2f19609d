"""Veiling luminance: disability glare, light scattered in the eye over the task."""

import numpy as np
from jaxtyping import Float

from clerestory.glare.source_table import GlareSources

# Keeps a source on the line of sight finite, as evalglare does
_TINY = 1e-16


def veiling_luminance(sources: GlareSources) -> Float[np.ndarray, " source"]:
    """Veiling luminance by each source after Stiles and Holladay [cd/m²].

    Ten times the illuminance of the eye over the square of the angle in degrees; for
    young eyes and angles from 1° to 30°.

    References
    ----------
    Vos, J. J. (2003): On the cause of disability glare and its dependence on glare
    angle, age and ocular pigmentation. Clinical and Experimental Optometry 86(6).
    CIE 146:2002.

    Examples
    --------
    >>> lamp = GlareSources.of(
    ...     luminance=[1e4],
    ...     solid_angle=[0.01],
    ...     position_index=[1.0],
    ...     sigma=[np.radians(10)],
    ... )
    >>> veiling_luminance(lamp).round(2).tolist()
    [9.85]
    """
    degrees = np.degrees(sources.sigma)
    veil: np.ndarray = 10 * sources.illuminance / (degrees**2 + _TINY)
    return veil


def poynter_veiling_luminance(sources: GlareSources) -> float:
    """Veiling luminance by all sources in the form evalglare prints as Lveil [cd/m²].

    Examples
    --------
    >>> lamp = GlareSources.of(
    ...     luminance=[1e4],
    ...     solid_angle=[0.01],
    ...     position_index=[1.0],
    ...     sigma=[np.radians(10)],
    ... )
    >>> round(poynter_veiling_luminance(lamp), 2)
    49.24
    """
    seen = sources.luminance * np.cos(sources.sigma) * sources.solid_angle
    return float(5 * (seen / (np.degrees(sources.sigma) + 1e-11)).sum())
