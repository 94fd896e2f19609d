"""Solar position: altitude and azimuth of the sun.

The default is NREL's Solar Position Algorithm (SPA) as implemented in pvlib; only
pvlib's module `spa` is loaded, since importing all of pvlib takes a second. Radiance's
formulas, for comparisons with Radiance, differ by some tenths of a degree.

References: I. Reda, A. Andreas, NREL/TP-560-34302, 2008; Radiance, src/gen/sun.c,
the formulas of gensky and gendaymtx.
"""

import importlib.util
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import one_of
from clerestory.directions import from_azimuth
from clerestory.sky.weather import Site

_Day = Int[np.ndarray, "*time"] | int
_Times = Float[np.ndarray, "*time"]
SunFormula = Literal["spa", "radiance"]

# Terrestrial time minus universal time [s], and refraction at sunrise [°]
_DELTA_T = 67.0
_REFRACTION_AT_SUNRISE = 0.5667

# ISO 2533 atmosphere: pressure [hPa] and temperature [K] at sea level, lapse rate [K/m]
# and exponent g / (R L)
_PRESSURE, _TEMPERATURE, _LAPSE, _EXPONENT = 1013.25, 288.15, 0.0065, 5.25588


@dataclass(frozen=True, eq=False)
class SunPosition:
    """Solar altitude, including refraction, and azimuth clockwise from north [rad]."""

    altitude: Float[np.ndarray, "*time"]
    azimuth: Float[np.ndarray, "*time"]

    def directions(self) -> Float[np.ndarray, "time 3"]:
        """Unit vectors to the sun: x east, y north, z up."""
        return from_azimuth(self.azimuth, self.altitude)


def day_of_year(times: np.ndarray) -> Int[np.ndarray, " time"]:
    """Day of the year; 1 January is 1."""
    day = times.astype("datetime64[D]") - times.astype("datetime64[Y]")
    return np.asarray(day.astype(int) + 1)


def sun_at(
    site: Site,
    times: np.ndarray,
    *,
    formula: SunFormula = "spa",
    temperature_c: float = 12.0,
) -> SunPosition:
    """Return the solar position at a site, at times in local standard time.

    Formula "spa" is accurate to 0.0003° in the years -2000 to 6000. Refraction depends
    on the elevation of the site and on the air temperature [°C].
    """
    one_of(formula, "sun formula", choices=("spa", "radiance"))
    if formula == "radiance":
        return _radiance(site, times)
    seconds = times.astype("datetime64[s]").astype(float) - 3600 * site.utc_offset_hours
    position = _ALGORITHM.solar_position(
        seconds,
        site.latitude_deg,
        site.longitude_deg,
        site.elevation,
        standard_pressure(site.elevation),
        temperature_c,
        _DELTA_T,
        _REFRACTION_AT_SUNRISE,
        numthreads=1,
    )
    return SunPosition(np.radians(position[2]), np.radians(position[4]))


def _radiance(site: Site, times: np.ndarray) -> SunPosition:
    day = day_of_year(times)
    hour = (times - times.astype("datetime64[D]")) / np.timedelta64(1, "h")
    latitude = np.radians(site.latitude_deg)

    # Solar time from the equation of time and the time zone's meridian
    solar = hour + site.longitude_deg / 15 - site.utc_offset_hours
    return horizontal_position(
        latitude, solar_declination(day), solar + equation_of_time(day)
    )


def equation_of_time(day: _Day) -> _Times:
    """Return Radiance's equation of time [h] for a day of the year."""
    term = 0.170 * np.sin(4 * np.pi / 373 * (day - 80))
    return np.asarray(term - 0.129 * np.sin(2 * np.pi / 355 * (day - 8)))


def solar_declination(day: _Day) -> _Times:
    """Return Radiance's solar declination [rad] for a day of the year."""
    return np.asarray(0.4093 * np.sin(2 * np.pi / 365 * (day - 81)))


def horizontal_position(
    latitude: float, declination: _Times | float, solar_hour: _Times | float
) -> SunPosition:
    """Return the solar position from latitude, declination [rad] and solar time [h]."""
    hour_angle = np.asarray(solar_hour * np.pi / 12)
    sin_d, cos_d = np.sin(declination), np.cos(declination)
    sine = np.sin(latitude) * sin_d - np.cos(latitude) * cos_d * np.cos(hour_angle)
    south = -np.cos(latitude) * sin_d - np.sin(latitude) * cos_d * np.cos(hour_angle)
    azimuth = np.pi - np.arctan2(cos_d * np.sin(hour_angle), south)
    return SunPosition(np.asarray(np.arcsin(np.clip(sine, -1, 1))), np.asarray(azimuth))


def standard_pressure(elevation: float) -> float:
    """Return the air pressure [hPa] of the standard atmosphere at an elevation [m]."""
    ratio = 1 - _LAPSE * elevation / _TEMPERATURE
    return float(_PRESSURE * ratio**_EXPONENT)


def _load() -> ModuleType:
    # Load the module spa without importing the package pvlib
    package = importlib.util.find_spec("pvlib")
    if package is None or package.origin is None:
        raise ModuleNotFoundError("pvlib is not installed", name="pvlib")
    file = Path(package.origin).with_name("spa.py")
    loader = SourceFileLoader("clerestory.sky._pvlib_spa", str(file))
    module = ModuleType(loader.name)
    loader.exec_module(module)
    return module


_ALGORITHM = _load()
