"""EnergyPlus weather files (.epw).

Hours are numbered 1…24 and mark the end of a time step; the solar position is computed
at the centre of the step. The header states the number of records per hour. In hourly
files the minute field, 0 or 60, is ignored. pvlib's reader is not used, since it
imports pandas and its error messages lack line numbers.

Reference: U.S. Department of Energy, EnergyPlus, Auxiliary Programs, chapter
"EnergyPlus Weather File (EPW) Data Dictionary".
"""

import csv
import warnings
from contextlib import suppress
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

# Largest fraction of the header's period that counts as a deliberate selection of hours
_SELECTION = 0.1

# Dew points of this value [°C] or above are missing (code 99.9); quality control
# removes the codes for missing irradiance
_MISSING_DEW_POINT = 99.0


def read_epw(path: str | Path) -> Weather:
    """Return the weather in an EPW file, dated 2023 (2024 if it has a 29 February)."""
    lines = read_text(path).splitlines()
    table = [_cells(text) for text in lines]
    cells = table[0] if table else [""]
    require(
        "".join(cells[:1]).strip().upper() == "LOCATION",
        "no LOCATION in the first line; an EPW file expected",
        line=1,
    )
    place = "_".join(part.strip() for part in (cells[1:2] + cells[3:4]) if part.strip())
    latitude, longitude, offset, elevation = numbers(cells, _SITE)
    site = Site(latitude, longitude, offset, elevation, place)
    per_hour, periods = _data_periods([row or [""] for row in table[:_HEADER_LINES]])
    rows = DataRows.below(_HEADER_LINES, table, file=path)

    # Convert times from the ends of steps to their centres
    month, day, hour, minute = (rows.column(i, name) for name, i in _TIME.items())
    end = hour if per_hour == 1 else hour - 1 + minute / 60
    times = calendar_times(month, day, end - 0.5 / per_hour, rows=rows)

    direct, diffuse, dew_point = (
        rows.column(i, name, may_miss=True) for name, i in _SERIES.items()
    )
    _warn_of_missing(times, periods, per_hour, rows)
    return weather_of_components(
        site,
        times,
        rows,
        Irradiance(direct, diffuse),
        step_minutes=60 / per_hour,
        dew_point_c=np.where(np.abs(dew_point) < _MISSING_DEW_POINT, dew_point, np.nan),
    )


def _cells(text: str) -> list[str]:
    # Cells of a line; commas within double quotes do not separate
    if '"' in text:
        with suppress(csv.Error):  # a cell longer than 131,072 characters
            return next(csv.reader([text]))
    return text.split(",") if text.strip() else []


def _data_periods(header: list[list[str]]) -> tuple[int, list[tuple[str, str]]]:
    # Records per hour, and first and last day of each period, as text
    for line, cells in enumerate(header, start=1):
        if cells[0].strip().upper() == "DATA PERIODS":
            (count,) = numbers(cells, {"records per hour": 2}, line)
            require(
                count in (1, 2, 3, 4, 5, 6, 10, 12, 15, 20, 30, 60),
                f"{count:g} records per hour; a divisor of 60 expected",
                line=line,
            )
            return int(count), list(zip(cells[5::4], cells[6::4], strict=False))
    raise InputError(
        f"no DATA PERIODS in the first {_HEADER_LINES} lines; an EPW header expected"
    )


def _warn_of_missing(
    times: np.ndarray, periods: list[tuple[str, str]], per_hour: int, rows: DataRows
) -> None:
    # Compare the times with those of the periods in the header
    year = str(times[0])[:4]
    step = np.timedelta64(3600 // per_hour, "s")
    expected = [times[:0]]
    for days in periods:
        dates = [day.replace(" ", "").split("/") for day in days]
        with suppress(ValueError, IndexError):
            first, last = (
                np.datetime64(f"{year}-{int(date[0]):02d}-{int(date[1]):02d}", "s")
                for date in dates
            )
            expected.append(np.arange(first, last + np.timedelta64(1, "D"), step))
    period = np.concatenate(expected) + step // 2
    missing = np.setdiff1d(period, times)
    few = len(times) < _SELECTION * len(period)
    if len(missing) and not (few and np.any(np.diff(times) != step)):
        row = min(int(np.searchsorted(times, missing[0])), len(times) - 1)
        stated = ", ".join(f"{a.strip()} to {b.strip()}" for a, b in periods)
        warnings.warn(
            f"{rows.file}:{rows.lines[row]}: the file lacks {len(missing)} of the"
            f" {len(period)} time steps of its header ({stated}), first"
            f" {missing[0]}; the {len(times)} others are used",
            ClerestoryWarning,
            stacklevel=4,
        )
