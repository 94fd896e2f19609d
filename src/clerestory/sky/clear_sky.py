"""Clear-sky irradiance of Ineichen and Perez.

Global horizontal and direct normal irradiance are functions of the solar altitude, the
Linke turbidity and the elevation of the site; diffuse horizontal irradiance is the
global minus the direct horizontal irradiance. The model is that of
`pvlib.clearsky.ineichen`, which is not used, since it imports pandas.

References: P. Ineichen, R. Perez, A new airmass independent formulation for the Linke
turbidity coefficient, Solar Energy 73 (3), 2002; F. Kasten, A. T. Young, Applied
Optics 28, 1989 (air mass); J. W. Spencer, Search 2 (5), 1971 (distance to the sun).
"""

from dataclasses import asdict

import numpy as np

from clerestory.array_types import Series
from clerestory.checks import require, within
from clerestory.sky.sky_state import orbit_factor
from clerestory.sky.solar_position import day_of_year, sun_at
from clerestory.sky.weather import TYPICAL_YEAR, Site, Weather

SOLAR_CONSTANT = 1366.1

_MINUTES_A_YEAR = 365 * 24 * 60


def clear_sky_weather(
    site: Site, *, turbidity: float = 3.0, step_minutes: int = 60
) -> Weather:
    """Return the weather of the year 2023 with clear sky of constant Linke turbidity.

    Turbidity is 2 for a very clear, 3 for a typical and 5 for a hazy atmosphere. The
    length of a time step must divide 60 minutes.

    >>> place = Site(51.5, 0.0, 0.0, place="London")
    >>> year = clear_sky_weather(place, step_minutes=30)
    >>> len(year), str(year.times[0]), bool(800 < year.direct_normal.max() < 1000)
    (17520, '2023-01-01T00:15:00', True)
    """
    within(turbidity, "turbidity", least=1, most=10)
    require(
        step_minutes > 0 and 60 % step_minutes == 0,
        f"time steps of {step_minutes} minutes; a divisor of 60 expected",
    )
    start = np.datetime64(f"{TYPICAL_YEAR}-01-01T00:00:00", "s")
    middles = np.arange(30 * step_minutes, 60 * _MINUTES_A_YEAR, 60 * step_minutes)
    times = start + middles.astype("timedelta64[s]")
    direct, diffuse = clear_sky_irradiance(
        sun_at(site, times).altitude,
        extraterrestrial=SOLAR_CONSTANT * orbit_factor(day_of_year(times)),
        turbidity=turbidity,
        elevation=site.elevation,
    )
    return Weather(
        **asdict(site),
        times=times,
        step_minutes=float(step_minutes),
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        source=f"clear sky of Ineichen and Perez, turbidity {turbidity:g}",
    )


def clear_sky_irradiance(
    altitude: Series,
    *,
    extraterrestrial: Series | float = SOLAR_CONSTANT,
    turbidity: float = 3.0,
    elevation: float = 0.0,
) -> tuple[Series, Series]:
    """Direct normal and diffuse horizontal irradiance of a clear sky [W/m²].

    The solar altitude [rad] includes refraction; `turbidity` is the Linke turbidity.
    """
    sine = np.maximum(np.sin(altitude), 1e-3)
    altitude_deg = np.degrees(np.maximum(altitude, 0))
    pressure = (1 - 2.25577e-5 * elevation) ** 5.25588
    mass = pressure / (sine + 0.50572 * (altitude_deg + 6.07995) ** -1.6364)
    low, high = np.exp(-elevation / 8000), np.exp(-elevation / 1250)

    # Global horizontal and direct normal irradiance of Ineichen and Perez
    c1, c2 = 5.09e-5 * elevation + 0.868, 3.92e-5 * elevation + 0.0387
    attenuation = np.exp(-c2 * mass * (low + high * (turbidity - 1)))
    total = c1 * extraterrestrial * sine * attenuation
    factor = 0.664 + 0.163 / low
    beam = extraterrestrial * factor * np.exp(-0.09 * mass * (turbidity - 1))
    share = 1 - (0.1 - 0.2 * np.exp(-turbidity)) / (0.1 + 0.882 / low)
    direct = np.minimum(beam, np.maximum(total * share / sine, 0))
    up = np.sin(altitude) > 0
    diffuse = np.maximum(total - direct * sine, 0)
    return np.where(up, direct, 0.0), np.where(up, diffuse, 0.0)
