"""Sun position of gensky and gendaylit from date, time and site.

As in Radiance, longitudes and meridians are in degrees west. The sun position is
computed by Radiance's formulas, or by the Astronomical Almanac's if a year is given.

References: Radiance, sun.c (time zones, defaults, solar time); J. J. Michalsky, The
Astronomical Almanac's algorithm for approximate solar position (1950-2050), Solar
Energy 40 (3), 1988.
"""

import re
from dataclasses import dataclass

import numpy as np

from clerestory.array_types import Vector
from clerestory.directions import from_azimuth
from clerestory.formats.word_reader import WordReader
from clerestory.scene.primitive import Primitive, primitive
from clerestory.sky.solar_position import (
    equation_of_time,
    horizontal_position,
    solar_declination,
)

# Standard meridians of time zones [deg west], by abbreviation
_ZONES = {
    **{"YST": 135, "YDT": 120, "PST": 120, "PDT": 105, "MST": 105, "MDT": 90},
    **{"CST": 90, "CDT": 75, "EST": 75, "EDT": 60, "AST": 60, "ADT": 45},
    **{"NST": 52.5, "NDT": 37.5, "GMT": 0, "BST": -15, "CET": -15, "CEST": -30},
    **{"EET": -30, "EEST": -45, "GST": -60, "GDT": -75, "IST": -82.5},
    **{"IDT": -97.5, "JST": -135, "NZST": -180, "NZDT": -195},
}
_DAYS_BEFORE = (0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334)
_HOUR = re.compile(r"(\+?)(\d{1,2})(?::(\d{1,2})|(\.\d*))?([A-Za-z]*)", re.ASCII)


@dataclass
class Moment:
    """Date, time and site; if `month` is 0, altitude and azimuth of the sun [rad].

    The azimuth is clockwise from south. Time is standard time, or solar time if `solar`
    is set. Longitude and meridian are positive west. If `zoned`, a time zone given with
    the hour overrides option -m.
    """

    altitude: float = 0.0
    azimuth: float = 0.0
    month: int = 0
    day: int = 0
    year: int = 0
    hour: float = 0.0
    solar: bool = False
    latitude_deg: float = float(np.degrees(0.66))
    longitude_deg: float = float(np.degrees(2.13))
    meridian_deg: float = 120.0
    zoned: bool = False

    def take(self, option: str, words: WordReader) -> bool:
        """Read the option -a, -o, -m or -y; return False for any other option."""
        match option:
            case "-a":
                self.latitude_deg = words.real("a latitude")
            case "-o":
                self.longitude_deg = words.real("a longitude")
            case "-m":
                meridian = words.real("a meridian")
                self.meridian_deg = self.meridian_deg if self.zoned else meridian
            case "-y":
                self.year = words.whole("the year", 1950, 2050)
            case _:
                return False
        return True

    @property
    def day_of_year(self) -> int:
        """Day of the year, 1 for 1 January; 0 if no date is given."""
        return _DAYS_BEFORE[self.month - 1] + self.day if self.month else 0

    def sun(self) -> tuple[float, float]:
        """Return solar altitude, and solar azimuth clockwise from south [rad]."""
        if not self.month:
            return self.altitude, self.azimuth
        if self.year:
            declination, solar_hour = self._almanac()
            return self._position(declination, self.hour if self.solar else solar_hour)
        hour = self.hour
        if not self.solar:
            # Solar time: equation of time and distance from the meridian
            hour += float(equation_of_time(self.day_of_year))
            hour += (self.meridian_deg - self.longitude_deg) / 15
        declination = float(solar_declination(self.day_of_year))
        return self._position(declination, hour)

    def _position(self, declination: float, solar_hour: float) -> tuple[float, float]:
        latitude = np.radians(self.latitude_deg)
        place = horizontal_position(latitude, declination, solar_hour)
        return float(place.altitude), float(place.azimuth - np.pi)

    def _almanac(self) -> tuple[float, float]:
        # Declination [rad] and solar time [h]; n: days since noon of 1 January 2000
        date = np.datetime64(f"{self.year:04d}-{self.month:02d}-01") + self.day - 1
        days = (date - np.datetime64("2000-01-01")) / np.timedelta64(1, "D")
        utc = self.hour + self.meridian_deg / 15
        n = float(days) - 0.5 + utc / 24
        mean_longitude = np.radians(280.460 + 0.9856474 * n)
        anomaly = np.radians(357.528 + 0.9856003 * n)
        longitude = mean_longitude + np.radians(
            1.915 * np.sin(anomaly) + 0.020 * np.sin(2 * anomaly)
        )
        obliquity = np.radians(23.439 - 4e-7 * n)
        ascension = np.arctan2(np.sin(longitude) * np.cos(obliquity), np.cos(longitude))
        sidereal = 6.697375 + 0.0657098242 * n + (n - np.floor(n)) * 24 + 12
        local = sidereal - self.longitude_deg / 15
        solar = np.mod(local - np.degrees(ascension) / 15 + 12, 24)
        sine = np.sin(obliquity) * np.sin(longitude)
        return float(np.arcsin(sine)), float(solar)


def read_moment(words: WordReader) -> Moment:
    """Read `month day hour` or `-ang altitude azimuth` from a command."""
    if words.word("a month or -ang") == "-ang":
        altitude = np.radians(words.real("the sun's altitude"))
        azimuth = np.radians(words.real("the sun's azimuth"))
        return Moment(altitude=float(altitude), azimuth=float(azimuth))
    words.at -= 1
    month = words.whole("the month", 1, 12)
    moment = Moment(month=month, day=words.whole("the day", 1, 31))
    text = words.word("the hour")
    match = _HOUR.fullmatch(text)
    if match is None:
        raise words.error(f'unexpected "{text}"; an hour such as 14:30 expected')
    plus, hour, minute, fraction, zone = match.groups()
    moment.solar = bool(plus)
    moment.hour = float(hour + (fraction or "")) + float(minute or 0) / 60
    if moment.hour > 24:
        raise words.error(f"the hour is {text}; 0 to 24 expected")
    if zone:
        if moment.solar or zone.upper() not in _ZONES:
            known = ", ".join(_ZONES)
            raise words.error(f'unknown time zone "{zone}"; {known} expected')
        moment.meridian_deg, moment.zoned = _ZONES[zone.upper()], True
    return moment


def direction(altitude: float, azimuth: float) -> Vector:
    """Return the unit vector to the sun; azimuth clockwise from south [rad]."""
    return from_azimuth(np.array(azimuth + np.pi), np.array(altitude)) + 0.0


def sun_source(radiance: float, sun: Vector, *, angle_deg: float) -> list[Primitive]:
    """Return the sun: light material, and source of the full angle `angle_deg` [°]."""
    return [
        primitive("void", "light", "solar", (radiance,) * 3),
        primitive("solar", "source", "sun", (*sun, angle_deg)),
    ]
