"""Typical meteorological years of NREL, third edition (TMY3, .csv).

Hours are numbered 01:00…24:00 and mark the end of a time step.

Reference: S. Wilcox, W. Marion, Users Manual for TMY3 Data Sets,
NREL/TP-581-43156, 2008.
"""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.gap_filling import repaired_weather
from clerestory.sky.table_cells import DataRows, number
from clerestory.sky.time_steps import calendar_times, typical_step
from clerestory.sky.weather import Site, Weather

# Indices of the fields of the first line, from 0
_SITE = {"latitude": 4, "longitude": 5, "time zone": 3, "elevation": 6}

DATE, _TIME = "Date (MM/DD/YYYY)", "Time (HH:MM)"
_SERIES = ("DNI (W/m^2)", "DHI (W/m^2)", "Dew-point (C)")

# Upper limit of the code for a missing dew point; codes for missing irradiance are
# removed by quality control
_MISSING_DEW_POINT = -9900.0


def read_tmy3(path: str | Path) -> Weather:
    """Return the weather of a TMY3 file, in the year 2023."""
    table = list(csv.reader(read_text(path).splitlines()))
    if len(table) < 3 or DATE not in table[1]:
        raise InputError(
            f"no column {DATE!r} in the second line, or no data; a TMY3 file expected",
            file=path,
            line=2,
        )
    latitude, longitude, offset, elevation = (
        number(table[0], i, name=name, file=path, line=1) for name, i in _SITE.items()
    )
    place = "_".join(part.strip() for part in table[0][1:3])
    site = Site(latitude, longitude, offset, elevation, place)
    rows, names = DataRows.below(2, table, file=path), table[1]

    # Convert ends of hours to centres
    month, day = _parts(rows, names, DATE, "/")
    hour, _ = _parts(rows, names, _TIME, ":")
    times = calendar_times(month, day, hour - 0.5, rows=rows)

    direct, diffuse, dew_point = (
        rows.column(_index(names, name, path), name, may_miss=True) for name in _SERIES
    )
    return repaired_weather(
        site,
        times,
        rows,
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        dew_point_c=np.where(dew_point <= _MISSING_DEW_POINT, np.nan, dew_point),
        step_minutes=typical_step(times),
    )


def _index(names: list[str], name: str, path: str | Path) -> int:
    if name not in names:
        raise InputError(
            f"no column {name!r}; a TMY3 file with this column expected",
            file=path,
            line=2,
        )
    return names.index(name)


def _parts(
    rows: DataRows, names: list[str], name: str, separator: str
) -> tuple[np.ndarray, np.ndarray]:
    # Return the first two numbers of a date or time
    i = _index(names, name, rows.file)
    cells = [row[i].split(separator) if i < len(row) else [] for row in rows.cells]
    parts = replace(rows, cells=cells)
    return parts.column(0, name), parts.column(1, name)
