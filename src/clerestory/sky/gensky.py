"""CIE skies with the zenith luminance of Radiance's gensky.

If no irradiance is given, the zenith luminance is a function of the solar altitude and
the turbidity.

Reference: Radiance, gensky; zenith luminance after R. Dogniaux (clear) and
R. G. Hopkinson (overcast).
"""

from typing import Literal

import numpy as np

from clerestory.checks import require
from clerestory.constants import GROUND_REFLECTANCE
from clerestory.directions import from_azimuth
from clerestory.errors import InputError
from clerestory.sky.luminance_distribution import (
    Distribution,
    cie_general,
    horizontal_integral,
    intermediate,
    overcast,
)
from clerestory.sky.point_sky import PointSky

CieSky = Literal["uniform", "overcast", "intermediate", "clear"]

# Luminous efficacy of sky and sun in gensky [lm/W]
_SKY_EFFICACY = 203.0
_SUN_EFFICACY = 208.0

# Solid angle of the solar disc in gensky, of diameter 0.5° [sr]
SUN_SOLID_ANGLE = 6e-5

# Upper limit of the solar altitude for skies with sun [rad]
HIGHEST_SUN = np.radians(87.0)


def cie_sky(
    kind: CieSky | int,
    *,
    sun_altitude: float,
    sun_azimuth: float,
    with_sun: bool = False,
    turbidity: float = 2.45,
    diffuse_horizontal: float | None = None,
    direct_normal: float | None = None,
    ground_reflectance: float = GROUND_REFLECTANCE,
) -> PointSky:
    """Return a CIE sky at one moment, as gensky does.

    `kind` is a sky type of gensky, or the number of a CIE general sky, 1…15. Azimuth is
    clockwise from north [rad]. By default, diffuse irradiance [W/m²] follows from
    gensky's zenith luminance for the Linke turbidity, and direct irradiance from
    gensky's solar radiance; CIE general skies require diffuse irradiance. The ground
    reflects sunlight even without `with_sun`; uniform and overcast skies have no sun.
    """
    is_overcast = kind in ("uniform", "overcast")
    altitude = sun_altitude if is_overcast else min(sun_altitude, HIGHEST_SUN)
    sun = from_azimuth(np.array(sun_azimuth), np.array(altitude))
    distribution = _distribution(kind)
    total = horizontal_integral(distribution, sun=sun)
    if diffuse_horizontal is not None:
        scale = diffuse_horizontal / total
    elif isinstance(kind, int):
        raise InputError(
            f"CIE general sky {kind} without diffuse irradiance; a value in W/m²"
            " expected"
        )
    else:
        at_zenith = float(distribution(np.array([0.0, 0.0, 1.0]), sun))
        scale = zenith_radiance(kind, altitude, turbidity) / at_zenith

    # Ground radiance from global horizontal irradiance
    direct = 0.0
    if not is_overcast and sun[2] > 0:
        direct = sun_radiance(kind, float(sun[2])) * SUN_SOLID_ANGLE
        direct = direct if direct_normal is None else direct_normal
    level = scale * total + direct * max(float(sun[2]), 0.0)
    ground = ground_reflectance * level / np.pi
    return PointSky(distribution, scale, sun, direct if with_sun else 0.0, ground)


def _distribution(kind: CieSky | int) -> Distribution:
    if isinstance(kind, int):
        return cie_general(kind)
    named: dict[str, Distribution] = {
        "uniform": cie_general(5),
        "overcast": overcast,
        "intermediate": intermediate,
        "clear": cie_general(12),
    }
    require(
        kind in named, f"unknown sky {kind!r}; {', '.join(named)} or 1 to 15 expected"
    )
    return named[kind]


def zenith_radiance(kind: CieSky, altitude: float, turbidity: float) -> float:
    """Return gensky's zenith radiance [W/(m²·sr)] from solar altitude [rad]."""
    # Zenith luminance [kcd/m²]
    cloudy = 8.6 * np.sin(altitude) + 0.123
    clear = (1.376 * turbidity - 1.81) * np.tan(altitude) + 0.38
    level = {
        "uniform": cloudy,
        "overcast": cloudy,
        "clear": clear,
        "intermediate": (clear + cloudy) / 2,
    }[kind]
    return max(float(level), 0.0) * 1000 / _SKY_EFFICACY


def sun_radiance(kind: CieSky | int, height: float) -> float:
    """Return gensky's solar radiance [W/(m²·sr)] from the sine of the altitude."""
    radiance = 1.5e9 / _SUN_EFFICACY * (1.147 - 0.147 / max(height, 0.16))
    return radiance * (0.15 if kind == "intermediate" else 1.0)
