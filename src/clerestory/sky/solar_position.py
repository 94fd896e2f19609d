"""Solar position: altitude and azimuth of the sun.

The default is NREL's Solar Position Algorithm (SPA) of pvlib; only the module `spa` is
loaded, since importing the package takes a second. Radiance's formulas, for comparisons
with Radiance, differ by some tenths of a degree.

References: I. Reda, A. Andreas, NREL/TP-560-34302, 2008; Radiance, src/gen/sun.c,
the formulas of gensky and gendaymtx.
"""

import importlib.util
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.directions import from_azimuth
from clerestory.errors import InputError
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
    """Solar position at each moment.

    Attributes
    ----------
    altitude : solar altitude, including refraction [rad]
    azimuth : solar azimuth, clockwise from north [rad]
    """

    altitude: Float[np.ndarray, "*time"]
    azimuth: Float[np.ndarray, "*time"]

    def directions(self) -> Float[np.ndarray, "time 3"]:
        """Unit vectors to the sun: x east, y north, z up."""
        return from_azimuth(self.azimuth, self.altitude)


def day_of_year(times: np.ndarray) -> Int[np.ndarray, " time"]:
    """Day of the year; 1 January is 1."""
    day = times.astype("datetime64[D]") - times.astype("datetime64[Y]").astype(
        "datetime64[D]"
    )
    return np.asarray(day.astype(int) + 1)


def sun_position(
    times: np.ndarray,
    *,
    latitude_deg: float,
    longitude_deg: float,
    utc_offset_hours: float,
    elevation: float = 0.0,
    temperature_c: float = 12.0,
    formula: SunFormula = "spa",
) -> SunPosition:
    """Return the solar position at moments of local standard time.

    Parameters
    ----------
    times : local standard time
    latitude_deg, longitude_deg : latitude, north-positive, and longitude, east-positive
        [°]
    utc_offset_hours : local standard time minus UTC [h]
    elevation : elevation above sea level [m], for refraction
    temperature_c : air temperature [°C], for refraction
    formula : "spa", accurate to 0.0003° in the years -2000 to 6000, or "radiance"

    Examples
    --------
    The example of NREL/TP-560-34302, table A5.1: zenith 50.11162°, azimuth 194.34024°.

    >>> noon = np.array(["2003-10-17T12:30:30"], dtype="datetime64[s]")
    >>> sun = sun_position(noon, latitude_deg=39.742476, longitude_deg=-105.1786,
    ...                    utc_offset_hours=-7, elevation=1830.14, temperature_c=11)
    >>> float(np.degrees(sun.azimuth[0]).round(4))
    194.3402
    """
    if formula == "radiance":
        return _radiance(times, latitude_deg, longitude_deg, utc_offset_hours)
    if formula != "spa":
        raise InputError(
            f"unknown sun formula {formula!r}; 'spa' or 'radiance' expected"
        )
    seconds = times.astype("datetime64[s]").astype(float) - 3600 * utc_offset_hours
    altitude, azimuth = _spa(
        seconds,
        latitude_deg=latitude_deg,
        longitude_deg=longitude_deg,
        elevation=elevation,
        temperature_c=temperature_c,
    )
    return SunPosition(np.radians(altitude), np.radians(azimuth))


def sun_at(
    site: Site, times: np.ndarray, *, formula: SunFormula = "spa"
) -> SunPosition:
    """Return the solar position at a site, at moments of its local standard time."""
    return sun_position(
        times,
        latitude_deg=site.latitude_deg,
        longitude_deg=site.longitude_deg,
        utc_offset_hours=site.utc_offset_hours,
        elevation=site.elevation,
        formula=formula,
    )


def _radiance(
    times: np.ndarray,
    latitude_deg: float,
    longitude_deg: float,
    utc_offset_hours: float,
) -> SunPosition:
    day = day_of_year(times)
    hour = (times - times.astype("datetime64[D]")) / np.timedelta64(1, "h")
    latitude = np.radians(latitude_deg)

    # Solar time from the equation of time and the time zone's meridian
    solar = hour + longitude_deg / 15 - utc_offset_hours + equation_of_time(day)
    return horizontal_position(latitude, solar_declination(day), solar)


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
    """Return the solar position for a latitude and declination [rad], at solar time."""
    hour_angle = np.asarray(solar_hour * np.pi / 12)
    sin_d, cos_d = np.sin(declination), np.cos(declination)
    sine = np.sin(latitude) * sin_d - np.cos(latitude) * cos_d * np.cos(hour_angle)
    south = -np.cos(latitude) * sin_d - np.sin(latitude) * cos_d * np.cos(hour_angle)
    azimuth = np.pi - np.arctan2(cos_d * np.sin(hour_angle), south)
    altitude = np.arcsin(np.clip(sine, -1, 1))
    return SunPosition(np.asarray(altitude), np.asarray(azimuth))


def standard_pressure(elevation: float) -> float:
    """Return the air pressure [hPa] of the standard atmosphere at an elevation [m].

    >>> round(standard_pressure(1000), 1)
    898.7
    """
    ratio = 1 - _LAPSE * elevation / _TEMPERATURE
    return float(_PRESSURE * ratio**_EXPONENT)


def _spa(
    seconds: Float[np.ndarray, " time"],
    *,
    latitude_deg: float,
    longitude_deg: float,
    elevation: float,
    temperature_c: float,
) -> tuple[Float[np.ndarray, " time"], Float[np.ndarray, " time"]]:
    """Return the solar altitude, including refraction, and the azimuth [°].

    Parameters
    ----------
    seconds : seconds since 1970-01-01, UTC
    elevation : elevation above sea level [m]
    """
    position = _ALGORITHM.solar_position(
        seconds,
        latitude_deg,
        longitude_deg,
        elevation,
        standard_pressure(elevation),
        temperature_c,
        _DELTA_T,
        _REFRACTION_AT_SUNRISE,
        numthreads=1,
    )
    return position[2], position[4]


def _load() -> ModuleType:
    # Load the module spa without importing the package pvlib
    package = importlib.util.find_spec("pvlib")
    if package is None or not package.submodule_search_locations:
        raise ModuleNotFoundError("pvlib is not installed", name="pvlib")
    file = Path(package.submodule_search_locations[0]) / "spa.py"
    spec = importlib.util.spec_from_file_location("clerestory.sky._pvlib_spa", file)
    if spec is None or spec.loader is None:
        raise ModuleNotFoundError(f"{file} cannot be loaded", name="pvlib.spa")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


_ALGORITHM = _load()
