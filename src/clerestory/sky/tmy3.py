"""Typical meteorological years of NREL, third edition (TMY3, .csv).

Hours are numbered 01:00…24:00 and mark the end of a time step.

Reference: S. Wilcox, W. Marion, Users Manual for TMY3 Data Sets,
NREL/TP-581-43156, 2008.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.files import csv_rows, read_text
from clerestory.sky.irradiance_decomposition import Irradiance
from clerestory.sky.measured_weather import weather_of_components
from clerestory.sky.table_cells import DataRows, numbers
from clerestory.sky.time_steps import calendar_times
from clerestory.sky.weather import Site, Weather

# Indices of the fields of the first line, from 0
_SITE = {"latitude": 4, "longitude": 5, "time zone": 3, "elevation": 6}

DATE, _TIME = "Date (MM/DD/YYYY)", "Time (HH:MM)"
_SERIES = ("DNI (W/m^2)", "DHI (W/m^2)", "Dew-point (C)")

# Dew points up to this value are missing; quality control removes the codes for missing
# irradiance
_MISSING_DEW_POINT = -9900.0


def read_tmy3(path: str | Path) -> Weather:
    """Return the weather in a TMY3 file, dated 2023."""
    table = csv_rows(read_text(path).splitlines(), file=path)
    require(
        len(table) > 2 and DATE in table[1],
        f"no column {DATE!r} in the second line, or no data; a TMY3 file expected",
        line=2,
    )
    place = "_".join(part.strip() for part in table[0][1:3])
    latitude, longitude, offset, elevation = numbers(table[0], _SITE)
    site = Site(latitude, longitude, offset, elevation, place)
    rows = DataRows.below(2, table, file=path)
    index = {name: i for i, name in enumerate(table[1])}
    for name in (_TIME, *_SERIES):
        require(
            name in index,
            f"no column {name!r}; a TMY3 file with this column expected",
            line=2,
        )

    # Convert times from the ends of hours to their centres
    month, day = _parts(rows, index[DATE], DATE, "/")
    hour, _ = _parts(rows, index[_TIME], _TIME, ":")
    times = calendar_times(month, day, hour - 0.5, rows=rows)

    direct, diffuse, dew_point = (
        rows.column(index[name], name, may_miss=True) for name in _SERIES
    )
    dew_point = np.where(dew_point <= _MISSING_DEW_POINT, np.nan, dew_point)
    parts = Irradiance(direct, diffuse)
    return weather_of_components(site, times, rows, parts, dew_point_c=dew_point)


def _parts(
    rows: DataRows, index: int, name: str, separator: str
) -> tuple[np.ndarray, np.ndarray]:
    # Return the first two numbers of each date or time, such as month and day
    cells = [
        row[index].split(separator) if index < len(row) else [] for row in rows.cells
    ]
    parts = replace(rows, cells=cells)
    return parts.column(0, name), parts.column(1, name)
