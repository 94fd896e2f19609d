"""Daylight glare probability (DGP), corrections of DGP, and simplified DGP (DGPs)."""

import numpy as np

from clerestory.array_types import Series, Values
from clerestory.glare.index import EyePhotometry, GlareIndex
from clerestory.glare.index_settings import EVALGLARE, DgpCoefficients
from clerestory.glare.source_table import GlareSources

# Vertical illuminance from which the low-light correction factor is 1 [lux]
_BRIGHT = 1000.0


def dgp(
    sources: GlareSources,
    *,
    illuminance: Values | float,
    coefficients: DgpCoefficients = EVALGLARE,
) -> Series:
    """Daylight glare probability: probability that a person is disturbed, at most 1.

    Valid for vertical illuminances above 380 lux and DGP above 0.2. With sources from a
    picture of the direct sun alone, the result is the enhanced simplified DGP.
    `illuminance` is vertical, at the eye [lux].

    Reference: Wienold, J. and Christoffersen, J. (2006): Evaluation methods and
    development of a new glare prediction model for daylight environments with the use
    of CCD cameras. Energy and Buildings 38(7), equation 4.

    >>> sun = GlareSources.of(luminance=[1e6], solid_angle=[6.8e-5], position_index=[3])
    >>> dgp(sun, illuminance=3000.0).round(3).tolist()
    [0.384]
    """
    k, level = coefficients, np.asarray(illuminance, dtype=float)
    lit, level = level > 0, np.where(level > 0, level, 1.0)
    weight = sources.luminance**k.a1 / sources.position_index**k.a4
    total = sources.totals(weight * sources.solid_angle**k.a2)
    glare = k.c2 * np.log10(1 + total / level**k.a3)
    value = k.c1 * level**k.a5 + k.c3 + glare
    return np.asarray(np.minimum(np.where(lit, value, k.c3), 1.0))


def simplified_dgp(illuminance: Values) -> Values:
    """Simplified DGP (DGPs), from the vertical illuminance at the eye [lux] alone.

    Valid only if neither the sun nor its specular reflection is visible.

    Reference: Wienold, J. (2007): Dynamic simulation of blind control strategies for
    visual comfort and energy balance analysis. Building Simulation, Beijing.

    >>> simplified_dgp(np.array([2000.0])).round(4).tolist()
    [0.3084]
    """
    plain = 6.22e-5 * np.asarray(illuminance, dtype=float) + 0.184
    return np.asarray(np.minimum(plain, 1.0))


def corrected_dgp(eye: EyePhotometry) -> Series:
    """Return DGP with the corrections for low light and age of the settings."""
    level, settings = eye.eye_illuminance, eye.settings
    value = dgp(eye.sources, illuminance=level, coefficients=settings.coefficients)
    if settings.low_light:
        value = value * low_light_correction(level)
    if settings.age is not None:
        value = value * age_correction(settings.age)
    return np.asarray(np.minimum(value, 1.0))


def low_light_correction(illuminance: Values) -> Values:
    """Correction factor of DGP at low vertical illuminance [lux]; 1 from 1000 lux.

    Reference: Wienold, J. (2012): New features of evalglare. 11th International
    Radiance Workshop, Copenhagen.

    >>> low_light_correction(np.array([100.0, 300.0, 2000.0])).round(3).tolist()
    [0.168, 0.961, 1.0]
    """
    level = np.asarray(illuminance, dtype=float)
    factor = 1 / (1 + np.exp(4 - 0.024 * np.minimum(level, _BRIGHT)))
    return np.where(level < _BRIGHT, factor, 1.0)


def age_correction(age: float) -> float:
    """Correction factor of DGP for the age of the observer [years]; 1 at 20.

    The effect was not significant in later studies; evalglare no longer applies it.

    Reference: Wienold, J. (2012), as above.

    >>> age_correction(20.0), round(age_correction(60.0), 3)
    (1.0, 1.25)
    """
    return 1 / (1.1 - 0.5 * age / 100)


DGP = GlareIndex(
    name="dgp",
    formula=corrected_dgp,
    thresholds=(0.35, 0.40, 0.45),  # Wienold 2009
    column="dgp",
)
SIMPLIFIED_DGP = GlareIndex(
    name="simplified_dgp",
    formula=lambda eye: simplified_dgp(eye.eye_illuminance),
    thresholds=DGP.thresholds,
)
