"""EnergyPlus weather files (.epw).

Hours are numbered 1…24 and mark the end of a time step; the solar position is computed
at the centre of the step. The header states the number of records per hour. In hourly
files the minute field, 0 or 60, is ignored. pvlib's reader is not used, since it
imports pandas and its error messages lack line numbers.

Reference: U.S. Department of Energy, EnergyPlus, Auxiliary Programs, chapter
"EnergyPlus Weather File (EPW) Data Dictionary".
"""

import warnings
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import read_text
from clerestory.sky.irradiance_decomposition import Irradiance
from clerestory.sky.measured_weather import weather_of_components
from clerestory.sky.table_cells import DataRows, numbers
from clerestory.sky.time_steps import calendar_times
from clerestory.sky.weather import Site, Weather

_HEADER_LINES = 8

# Indices of the fields in a line, from 0
_SITE = {"latitude": 6, "longitude": 7, "time zone": 8, "elevation": 9}
_TIME = {"month": 1, "day": 2, "hour": 3, "minute": 4}
_SERIES = {
    "direct normal irradiance": 14,
    "diffuse horizontal irradiance": 15,
    "dew point": 7,
}

# Dew points of this value [°C] or above are missing (code 99.9); quality control
# removes the codes for missing irradiance
_MISSING_DEW_POINT = 99.0


def read_epw(path: str | Path) -> Weather:
    """Return the weather in an EPW file, dated 2023 (2024 if it has a 29 February)."""
    lines = read_text(path).splitlines()
    cells = lines[0].split(",") if lines else [""]
    require(
        cells[0].strip().upper() == "LOCATION",
        "no LOCATION in the first line; an EPW file expected",
        line=1,
    )
    place = "_".join(part.strip() for part in (cells[1:2] + cells[3:4]) if part.strip())
    latitude, longitude, offset, elevation = numbers(cells, _SITE)
    site = Site(latitude, longitude, offset, elevation, place)
    per_hour = _records_per_hour(lines)
    table = (text.split(",") if text.strip() else [] for text in lines)
    rows = DataRows.below(_HEADER_LINES, table, file=path)

    # Convert times from the ends of steps to their centres
    month, day, hour, minute = (rows.column(i, name) for name, i in _TIME.items())
    end = hour if per_hour == 1 else hour - 1 + minute / 60
    times = calendar_times(month, day, end - 0.5 / per_hour, rows=rows)

    direct, diffuse, dew_point = (
        rows.column(i, name, may_miss=True) for name, i in _SERIES.items()
    )
    _warn_if_truncated(times, per_hour, lines, path)
    return weather_of_components(
        site,
        times,
        rows,
        Irradiance(direct, diffuse),
        step_minutes=60 / per_hour,
        dew_point_c=np.where(np.abs(dew_point) < _MISSING_DEW_POINT, dew_point, np.nan),
    )


def _records_per_hour(lines: list[str]) -> int:
    for line, text in enumerate(lines[:_HEADER_LINES], start=1):
        cells = text.split(",")
        if cells[0].strip().upper() == "DATA PERIODS":
            (count,) = numbers(cells, {"records per hour": 2}, line)
            require(
                count in (1, 2, 3, 4, 5, 6, 10, 12, 15, 20, 30, 60),
                f"{count:g} records per hour; a divisor of 60 expected",
                line=line,
            )
            return int(count)
    raise InputError(
        f"no DATA PERIODS in the first {_HEADER_LINES} lines; an EPW header expected"
    )


def _warn_if_truncated(
    times: np.ndarray, per_hour: int, lines: list[str], path: str | Path
) -> None:
    # A truncated year has no gaps before the last row; a selection of hours has gaps
    step = np.timedelta64(3600 // per_hour, "s")
    unbroken = len(times) > 24 * per_hour and bool(np.all(np.diff(times) == step))
    last = times[-1].astype("datetime64[D]")
    year_end = np.datetime64(f"{last.astype('datetime64[Y]')}-12-31")
    header = " ".join(lines[:_HEADER_LINES]).replace(" ", "")
    if unbroken and last < year_end and "12/31" in header.split("DATAPERIODS")[-1]:
        warnings.warn(
            f"{path}:{len(lines)}: the data end at {times[-1]}, the header states"
            f" 12/31; {len(times)} steps are used",
            ClerestoryWarning,
            stacklevel=3,
        )
