"""Skies of point-in-time recipes: texts of honeybee's skies as commands of Radiance.

A text is a kind of sky, a date and time or the position of the sun, and options:
`cie 21 Jun 12:00 -lat 41.8 -lon -87.8 -tz -6 -type 0`, `cie -alt 71.6 -az 185.2`,
`climate-based 21 Jun 12:00 -lat 41.8 -lon -87.8 -dni 800 -dhi 120`,
`irradiance 558.7`, `illuminance 100000 -u`.
"""

import re
from collections.abc import Sequence

import numpy as np

from clerestory.checks import one_of, require, within
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.radiance.generators.sun_place import Moment

_MONTHS = (
    *("jan", "feb", "mar", "apr", "may", "jun"),
    *("jul", "aug", "sep", "oct", "nov", "dec"),
)
_TIME = re.compile(r"([01]?\d|2[0-3]):([0-5]\d)", re.ASCII)

# Options of gensky by type of CIE sky
_TYPES = ("+s", "-s", "+i", "-i", "-c", "-u")

# Least and greatest value of each option
_LIMITS = {
    "-type": (0, 5),
    "-g": (0, 1),
    "-lat": (-90, 90),
    "-lon": (-180, 180),
    "-tz": (-12, 14),
    "-n": (-360, 360),
    "-alt": (0, 90),
    "-az": (-360, 360),
    "-dni": (0, 2000),
    "-dhi": (0, 2000),
}
_PLACE = {"-lat", "-lon", "-tz", "-n", "-alt", "-az", "-g"}
_OPTIONS = {
    "cie": _PLACE | {"-type"},
    "climate-based": _PLACE | {"-dni", "-dhi"},
    "irradiance": {"-g"},
    "illuminance": {"-g"},
}


def sky_command(text: str) -> str:
    """Return the command of gensky or gendaylit for the text of a sky.

    Azimuths (`-az`) are clockwise from north and longitudes positive east. Without a
    time zone (`-tz`) the time is solar time. `-n` is the angle from +y to north,
    counter-clockwise.

    Raises
    ------
    InputError : the kind of sky, an option or a value is unknown, or one is missing

    Examples
    --------
    >>> sky_command("cie -alt 45 -az 180 -type 4 -g 0.1")
    'gensky -ang 45 0 -c -g 0.1'
    >>> sky_command("illuminance 17900 -u")
    'gensky -ang 45 0 -u -B 100 -g 0.2'
    """
    words = text.lower().split()
    kind = words[0] if words else ""
    one_of(kind, "kind of sky", choices=tuple(_OPTIONS))
    if kind in ("irradiance", "illuminance"):
        return _overcast(kind, words[1:])
    options = next((i for i, w in enumerate(words) if w.startswith("-")), len(words))
    when, given = words[1:options], _values(words[options:], _OPTIONS[kind])
    needed: tuple[str, ...] = ("-lat", "-lon") if when else ("-alt", "-az")
    needed += ("-dni", "-dhi") if kind == "climate-based" else ()
    missing = [name for name in needed if name not in given]
    require(not missing, f'sky "{text}" lacks {" ".join(missing)}; a number expected')
    altitude, azimuth = _sun(when, given) if when else _angles(given)
    require(
        altitude > 0, f'in sky "{text}" the sun is below the horizon; a day expected'
    )
    azimuth -= given.get("-n", 0.0)
    place = f"-ang {altitude:.6g} {azimuth:.6g}"
    ground = f"-g {given.get('-g', 0.2):g}"
    if kind == "cie":
        return f"gensky {place} {_TYPES[int(given.get('-type', 0))]} {ground}"
    return f"gendaylit {place} -W {given['-dni']:g} {given['-dhi']:g} {ground}"


def _overcast(kind: str, words: Sequence[str]) -> str:
    # Overcast or, with -u, uniform sky of an irradiance or illuminance outdoors
    flat = "-u" in words
    rest = [word for word in words if word != "-u"]
    require(rest, f'sky "{kind}" lacks a value; a number expected')
    value = _number(kind, rest[0])
    within(value, kind, least=0, most=1e6)
    given = _values(rest[1:], _OPTIONS[kind])
    watts = value / (LUMINOUS_EFFICACY if kind == "illuminance" else 1)
    name, ground = "-u" if flat else "-c", given.get("-g", 0.2)
    return f"gensky -ang 45 0 {name} -B {watts:.9g} -g {ground:g}"


def _values(words: Sequence[str], known: set[str]) -> dict[str, float]:
    found: dict[str, float] = {}
    require(
        len(words) % 2 == 0, f"option {words[-1:]} lacks a value; a number expected"
    )
    for name, word in zip(words[::2], words[1::2], strict=True):
        one_of(name, "option of the sky", choices=sorted(known))
        found[name] = _number(name, word)
        within(found[name], name, least=_LIMITS[name][0], most=_LIMITS[name][1])
    return found


def _number(name: str, word: str) -> float:
    try:
        return float(word)
    except ValueError:
        require(False, f"{name} of the sky is {word[:40]!r}; a number expected")
        raise


def _angles(given: dict[str, float]) -> tuple[float, float]:
    # Altitude, and azimuth clockwise from south [deg]
    return given["-alt"], given["-az"] - 180


def _sun(when: Sequence[str], given: dict[str, float]) -> tuple[float, float]:
    # The same at a date and time
    day, month, time = (*when, "", "", "")[:3]
    found = _TIME.fullmatch(time)
    valid = day.isascii() and day.isdigit() and 1 <= int(day) <= 31
    message = f'time of the sky is "{" ".join(when)}"; such as "21 Jun 12:00" expected'
    require(valid and month[:3] in _MONTHS and found, message)
    hours, minutes = found.groups() if found else ("0", "0")
    moment = Moment(
        month=_MONTHS.index(month[:3]) + 1,
        day=int(day),
        hour=int(hours) + int(minutes) / 60,
        solar="-tz" not in given,
        latitude_deg=given["-lat"],
        longitude_deg=-given["-lon"],
        meridian_deg=-15 * given.get("-tz", 0.0),
    )
    altitude, azimuth = moment.sun()
    return float(np.degrees(altitude)), float(np.degrees(azimuth))
