"""Typical meteorological years of NREL, second edition (TMY2, .tm2).

Lines have fixed columns. Hours are numbered 1…24 and stand for the time that
ends there.

Reference: W. Marion, K. Urban, User's Manual for TMY2s, NREL, 1995, tables 3-1 and 3-2.
"""

from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.gap_filling import repaired_weather
from clerestory.sky.table_cells import column, number
from clerestory.sky.time_steps import moments, typical_step
from clerestory.sky.weather import Site, Weather

# Columns of the data, from the first (counted from 0) up to the last
_DATA = {
    "month": (3, 5),
    "day": (5, 7),
    "hour": (7, 9),
    "direct normal irradiance": (23, 27),
    "diffuse horizontal irradiance": (29, 33),
    "dew point": (73, 77),
}
_MISSING_DEW_POINT = 9999.0


def read_tmy2(path: str | Path) -> Weather:
    """Return the weather of a TMY2 file, in the year 2023 (2024 with a 29 February).

    Raises
    ------
    InputError : the header is not that of a TMY2 file, or a row is wrong
    """
    lines = read_text(path).splitlines()
    if not lines or not looks_like_tmy2(lines[0]):
        raise InputError("no TMY2 header in the first line", file=path, line=1)
    numbers = [i for i, text in enumerate(lines) if i > 0 and text.strip()]
    if not numbers:
        raise InputError("no data rows after the header", file=path, line=len(lines))
    at = np.array(numbers) + 1
    rows = [[lines[i][start:stop] for start, stop in _DATA.values()] for i in numbers]
    month, day, hour, direct, diffuse, dew_point = (
        column(rows, i, name=name, file=path, lines=at) for i, name in enumerate(_DATA)
    )
    times = moments(month, day, hour - 0.5, file=path, lines=at)
    return repaired_weather(
        _site(lines[0], path),
        times,
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        dew_point_c=np.where(dew_point == _MISSING_DEW_POINT, np.nan, dew_point / 10),
        step_minutes=typical_step(times),
        file=path,
        lines=at,
    )


def looks_like_tmy2(first_line: str) -> bool:
    """Whether a line has hemispheres where TMY2 headers have them."""
    return first_line[37:38] in ("N", "S") and first_line[45:46] in ("E", "W")


def _site(header: str, path: str | Path) -> Site:
    spans = {
        "time zone": (33, 36),
        "latitude [°]": (39, 41),
        "latitude [']": (42, 44),
        "longitude [°]": (47, 50),
        "longitude [']": (51, 53),
        "elevation": (55, 59),
    }
    cells = [header[start:stop] for start, stop in spans.values()]
    offset, north, north_minute, east, east_minute, elevation = (
        number(cells, i, name=name, file=path, line=1) for i, name in enumerate(spans)
    )
    latitude = (north + north_minute / 60) * (1 if header[37] == "N" else -1)
    longitude = (east + east_minute / 60) * (1 if header[45] == "E" else -1)
    return Site(latitude, longitude, offset, elevation, "_".join(header[7:32].split()))
