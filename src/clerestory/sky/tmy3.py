"""Typical meteorological years of NREL, third edition (TMY3, .csv).

Hours are numbered 01:00…24:00 and stand for the time that ends there.

Reference: S. Wilcox, W. Marion, Users Manual for TMY3 Data Sets,
NREL/TP-581-43156, 2008.
"""

import csv
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.gap_filling import repaired_weather
from clerestory.sky.table_cells import column, number
from clerestory.sky.time_steps import moments, typical_step
from clerestory.sky.weather import Site, Weather

_DATE, _TIME = "Date (MM/DD/YYYY)", "Time (HH:MM)"
_DIRECT, _DIFFUSE, _DEW_POINT = "DNI (W/m^2)", "DHI (W/m^2)", "Dew-point (C)"

# The code for a missing dew point [°C]; missing irradiance is out of range as well
_MISSING_DEW_POINT = -9900.0


def read_tmy3(path: str | Path) -> Weather:
    """Return the weather of a TMY3 file, in the year 2023.

    Raises
    ------
    InputError : the two header lines are not those of a TMY3 file, or a row is wrong
    """
    table = list(csv.reader(read_text(path).splitlines()))
    if len(table) < 3 or _DATE not in table[1]:
        raise InputError(
            f"no column {_DATE!r} in the second line, or no data; a TMY3 file expected",
            file=path,
            line=2,
        )
    site, names = table[0], table[1]
    numbers = [i for i, row in enumerate(table) if i > 1 and row]
    rows = [table[i] for i in numbers]
    at = np.array(numbers) + 1

    # Go from the end of each hour to its centre
    month, day = _parts(rows, names, _DATE, "/", path, at)
    hour, _ = _parts(rows, names, _TIME, ":", path, at)
    times = moments(month, day, hour - 0.5, file=path, lines=at)

    # Read the irradiance and the dew point
    direct, diffuse, dew_point = (
        column(
            rows,
            _index(names, name, path),
            name=name,
            file=path,
            lines=at,
            may_miss=True,
        )
        for name in (_DIRECT, _DIFFUSE, _DEW_POINT)
    )
    return repaired_weather(
        _site(site, path),
        times,
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        dew_point_c=np.where(dew_point <= _MISSING_DEW_POINT, np.nan, dew_point),
        step_minutes=typical_step(times),
        file=path,
        lines=at,
    )


def _site(cells: list[str], path: str | Path) -> Site:
    latitude, longitude, offset, elevation = (
        number(cells, index, name=name, file=path, line=1)
        for index, name in (
            (4, "latitude"),
            (5, "longitude"),
            (3, "time zone"),
            (6, "elevation"),
        )
    )
    place = "_".join(part.strip() for part in cells[1:3])
    return Site(latitude, longitude, offset, elevation, place)


def _index(names: list[str], name: str, path: str | Path) -> int:
    if name not in names:
        raise InputError(f"no column {name!r}; a TMY3 file has one", file=path, line=2)
    return names.index(name)


def _parts(
    rows: list[list[str]],
    names: list[str],
    name: str,
    separator: str,
    path: str | Path,
    at: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    # First two numbers of a date or a time
    index = _index(names, name, path)
    cells = [row[index].split(separator) if index < len(row) else [] for row in rows]
    first = column(cells, 0, name=name, file=path, lines=at)
    return first, column(cells, 1, name=name, file=path, lines=at)
