"""Weather files of Radiance and Daysim (.wea).

Hours are the moments at which the sun is evaluated. Longitude and time zone
are west-positive degrees and end here.
"""

from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.cells import column, number
from clerestory.sky.moments import moments, typical_step
from clerestory.sky.repair import repaired_weather
from clerestory.sky.weather import Site, Weather

_KEYS = (
    "place",
    "latitude",
    "longitude",
    "time_zone",
    "site_elevation",
    "weather_data_file_units",
)


def read_wea(path: str | Path) -> Weather:
    """Return the weather of a WEA file, in the year 2023 (2024 with a 29 February).

    Raises
    ------
    InputError : the header is incomplete, the units are not direct normal and
        diffuse horizontal irradiance (units 1), or a row is wrong
    """
    lines = read_text(path).splitlines()
    site = _site(lines, path)

    # Split the data rows
    numbers = [i for i, text in enumerate(lines) if i >= len(_KEYS) and text.strip()]
    if not numbers:
        raise InputError("no data rows after the header", file=path, line=len(lines))
    rows = [lines[i].split() for i in numbers]
    at = np.array(numbers) + 1
    month, day, hour, direct, diffuse = (
        column(rows, index, name=name, file=path, lines=at, may_miss=index > 2)
        for index, name in enumerate(
            (
                "month",
                "day",
                "hour",
                "direct normal irradiance",
                "diffuse horizontal irradiance",
            )
        )
    )
    times = moments(month, day, hour, file=path, lines=at)
    return repaired_weather(
        site,
        times,
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        step_minutes=typical_step(times),
        file=path,
        lines=at,
    )


def _site(lines: list[str], path: str | Path) -> Site:
    values = {}
    place = ""
    for i, key in enumerate(_KEYS):
        cells = lines[i].split(maxsplit=1) if i < len(lines) else []
        if not cells or cells[0] != key:
            found = cells[0] if cells else "nothing"
            raise InputError(
                f"{found!r} in the header; {key!r} expected", file=path, line=i + 1
            )
        if key == "place":
            place = cells[1].strip() if len(cells) > 1 else ""
        else:
            values[key] = number(cells, 1, name=key, file=path, line=i + 1)
    units = values["weather_data_file_units"]
    if units != 1:
        raise InputError(
            f"weather_data_file_units {units:g}; 1 expected, direct normal and"
            " diffuse horizontal irradiance",
            file=path,
            line=len(_KEYS),
        )
    return Site(
        latitude_deg=values["latitude"],
        longitude_deg=-values["longitude"],
        utc_offset_hours=-values["time_zone"] / 15,
        elevation=values["site_elevation"],
        place=place,
    )
