"""EnergyPlus weather files (.epw).

Hours are numbered 1…24 and stand for the time that ends there; the sun is
evaluated half a step earlier. The minute field of hourly files is 0 or 60
and means nothing; the header tells the records per hour.

Reference: U.S. Department of Energy, EnergyPlus, Auxiliary Programs, chapter
"EnergyPlus Weather File (EPW) Data Dictionary".
"""

import warnings
from pathlib import Path

import numpy as np

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import read_text
from clerestory.sky.gap_filling import repaired_weather
from clerestory.sky.table_cells import column, number
from clerestory.sky.time_steps import moments
from clerestory.sky.weather import Site, Weather

_HEADER_LINES = 8

# Fields of a data row, counted from 0
_TIME = {"month": 1, "day": 2, "hour": 3, "minute": 4}
_SERIES = {
    "direct normal irradiance": 14,
    "diffuse horizontal irradiance": 15,
    "dew point": 7,
}

# Codes for missing data: 9999 W/m² and more, 99.9 °C
_MISSING_IRRADIANCE = 9999.0
_MISSING_DEW_POINT = 99.0


def read_epw(path: str | Path) -> Weather:
    """Return the weather of an EPW file, in the year 2023 (2024 with a 29 February).

    Raises
    ------
    InputError : the header is not that of an EPW, a row is short or holds no
        numbers, or too many values are missing
    """
    lines = read_text(path).splitlines()
    cells = lines[0].split(",") if lines else []
    if not cells or cells[0].strip().upper() != "LOCATION":
        raise InputError(
            "no LOCATION in the first line; an EPW file expected", file=path, line=1
        )
    site = _site(cells, path)
    per_hour = _records_per_hour(lines, path)

    # Split the data rows
    numbers = [i for i, text in enumerate(lines) if i >= _HEADER_LINES and text.strip()]
    if not numbers:
        raise InputError("no data rows after the header", file=path, line=len(lines))
    rows = [lines[i].split(",") for i in numbers]
    at = np.array(numbers) + 1
    month, day, hour, minute = (
        column(rows, index, name=name, file=path, lines=at)
        for name, index in _TIME.items()
    )

    # Go from the end of each step to its centre
    end = hour if per_hour == 1 else hour - 1 + minute / 60
    centre = end - 0.5 / per_hour
    times = moments(month, day, centre, file=path, lines=at)

    # Read the irradiance and the dew point
    direct, diffuse, dew_point = (
        column(rows, index, name=name, file=path, lines=at, may_miss=True)
        for name, index in _SERIES.items()
    )
    _warn_if_cut_off(times, per_hour, lines, path)
    return repaired_weather(
        site,
        times,
        direct_normal=np.where(direct >= _MISSING_IRRADIANCE, np.nan, direct),
        diffuse_horizontal=np.where(diffuse >= _MISSING_IRRADIANCE, np.nan, diffuse),
        dew_point_c=np.where(np.abs(dew_point) < _MISSING_DEW_POINT, dew_point, np.nan),
        step_minutes=60 / per_hour,
        file=path,
        lines=at,
    )


def _site(cells: list[str], path: str | Path) -> Site:
    place = "_".join(part.strip() for part in (cells[1:2] + cells[3:4]) if part.strip())
    latitude, longitude, offset, elevation = (
        number(cells, index, name=name, file=path, line=1)
        for index, name in (
            (6, "latitude"),
            (7, "longitude"),
            (8, "time zone"),
            (9, "elevation"),
        )
    )
    return Site(latitude, longitude, offset, elevation, place)


def _records_per_hour(lines: list[str], path: str | Path) -> int:
    for i, text in enumerate(lines[:_HEADER_LINES]):
        cells = text.split(",")
        if cells[0].strip().upper() == "DATA PERIODS":
            count = number(cells, 2, name="records per hour", file=path, line=i + 1)
            if count not in (1, 2, 3, 4, 5, 6, 10, 12, 15, 20, 30, 60):
                raise InputError(
                    f"{count:g} records per hour; a divisor of 60 expected",
                    file=path,
                    line=i + 1,
                )
            return int(count)
    raise InputError(
        f"no DATA PERIODS in the first {_HEADER_LINES} lines; an EPW header expected",
        file=path,
    )


def _warn_if_cut_off(
    times: np.ndarray, per_hour: int, lines: list[str], path: str | Path
) -> None:
    # A year without holes that stops early was cut; a choice of hours has holes
    step = np.timedelta64(3600 // per_hour, "s")
    unbroken = len(times) > 24 * per_hour and bool(np.all(np.diff(times) == step))
    last = times[-1].astype("datetime64[D]")
    year_end = np.datetime64(f"{last.astype('datetime64[Y]')}-12-31")
    header = " ".join(lines[:_HEADER_LINES]).replace(" ", "")
    if unbroken and last < year_end and "12/31" in header.split("DATAPERIODS")[-1]:
        warnings.warn(
            f"{path}:{len(lines)}: the data stop at {times[-1]}, the header"
            f" promises 12/31; {len(times)} steps are used",
            ClerestoryWarning,
            stacklevel=3,
        )
