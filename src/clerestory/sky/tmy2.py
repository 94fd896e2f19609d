"""Typical meteorological years of NREL, second edition (TMY2, .tm2).

Fields have fixed columns. Hours are numbered 1…24 and mark the end of a time step.

Reference: W. Marion, K. Urban, User's Manual for TMY2s, NREL, 1995, tables 3-1 and 3-2.
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.files import read_text
from clerestory.sky.irradiance_decomposition import Irradiance
from clerestory.sky.measured_weather import weather_of_components
from clerestory.sky.table_cells import DataRows, numbers
from clerestory.sky.time_steps import calendar_times
from clerestory.sky.weather import Site, Weather

# Character range of each field, from 0, end excluded
_SITE = {
    "time zone": (33, 36),
    "latitude [°]": (39, 41),
    "latitude [']": (42, 44),
    "longitude [°]": (47, 50),
    "longitude [']": (51, 53),
    "elevation": (55, 59),
}
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
    """Return the weather in a TMY2 file, dated 2023 (2024 if it has a 29 February)."""
    lines = read_text(path).splitlines() or [""]
    require(
        is_tmy2_header(lines[0]),
        "no TMY2 header in the first line; a TMY2 file expected",
        line=1,
    )
    fields = (_cells(text, _DATA.values()) if text.strip() else [] for text in lines)
    rows = DataRows.below(1, fields, file=path)
    month, day, hour, direct, diffuse, dew_point = (
        rows.column(i, name) for i, name in enumerate(_DATA)
    )
    times = calendar_times(month, day, hour - 0.5, rows=rows)
    dew_point = np.where(dew_point == _MISSING_DEW_POINT, np.nan, dew_point / 10)
    site, parts = _site(lines[0]), Irradiance(direct, diffuse)
    return weather_of_components(site, times, rows, parts, dew_point_c=dew_point)


def is_tmy2_header(line: str) -> bool:
    """Whether a line has N or S, and E or W, in the columns of a TMY2 header."""
    return line[37:38] in ("N", "S") and line[45:46] in ("E", "W")


def _site(header: str) -> Site:
    cells = _cells(header, _SITE.values())
    indices = {name: i for i, name in enumerate(_SITE)}
    offset, north, north_minute, east, east_minute, elevation = numbers(cells, indices)
    latitude = (north + north_minute / 60) * (1 if header[37] == "N" else -1)
    longitude = (east + east_minute / 60) * (1 if header[45] == "E" else -1)
    return Site(latitude, longitude, offset, elevation, "_".join(header[7:32].split()))


def _cells(text: str, ranges: Iterable[tuple[int, int]]) -> list[str]:
    return [text[start:stop] for start, stop in ranges]
