"""Files of radiation networks: SURFRAD (NOAA) and SRML (University of Oregon).

SURFRAD's daily files contain the location of the station; SRML's monthly files, read by
pvlib, do not. Time steps are one to several minutes; `measured_weather` applies quality
control and decomposition.
"""

import importlib
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.array_types import Series
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.irradiance_decomposition import Decomposition
from clerestory.sky.measured_weather import Measurement, Quantity, weather_of
from clerestory.sky.table_cells import DataRows, numbers
from clerestory.sky.time_steps import StandsFor, step_centres
from clerestory.sky.weather import Site, Weather

# SURFRAD rows: index, from 0, smallest and largest value of each time cell; indices of
# irradiance cells, each of which is followed by a quality flag
_TIME = {
    "year": (0, 1900, 2200),
    "day": (1, 1, 366),
    "hour": (4, 0, 24),
    "minute": (5, 0, 60),
}
_SERIES: dict[Quantity, int] = {"direct_normal": 12, "diffuse_horizontal": 14}

# Values below this are missing; SURFRAD files contain -9999.9
_MISSING = -9000.0

# Prefixes of pvlib's column names for SRML quantities; an instrument number follows
_SRML: dict[Quantity, str] = {
    "global_horizontal": "ghi",
    "diffuse_horizontal": "dhi",
    "direct_normal": "dni",
}
_SRML_HEADER = 1

# Largest number of columns; pvlib's time for each grows with their number
_MOST_COLUMNS = 1000

# Exceptions that pvlib and pandas raise on damaged files
_BROKEN = (ValueError, LookupError, TypeError, AttributeError, ArithmeticError)


def read_surfrad(path: str | Path, *, utc_offset_hours: float | None = None) -> Weather:
    """Return the weather of a SURFRAD file (.dat), one day in steps of a minute.

    Times are UTC and mark the end of a minute. Direct normal irradiance is measured by
    a pyrheliometer, diffuse horizontal irradiance by a shaded pyranometer. The default
    of `utc_offset_hours` is the longitude / 15, rounded.

    Reference: NOAA Global Monitoring Laboratory, SURFRAD README.
    """
    lines = read_text(path).splitlines()
    require(
        is_surfrad(lines),
        "no station in the first lines, or no data; a file of SURFRAD expected",
        file=path,
        line=1,
    )
    site = _surfrad_site(lines, utc_offset_hours)
    rows = DataRows.below(2, (text.split() for text in lines), file=path)
    cells = {name: rows.column(index, name) for name, index in _SERIES.items()}
    series = {q: np.where(x < _MISSING, np.nan, x) for q, x in cells.items()}
    return _weather(_surfrad_times(rows), site, series, rows, stands_for="end")


def is_surfrad(head: list[str]) -> bool:
    """Whether the first lines of a file are those of a SURFRAD file."""
    return (
        len(head) > 2
        and head[1].split()[3:5] == ["m", "version"]
        and len(head[2].split()) > max(_SERIES.values())
    )


def _surfrad_site(lines: list[str], offset: float | None) -> Site:
    fields = {"latitude": 0, "longitude": 1, "elevation": 2}
    latitude, longitude, elevation = numbers(lines[1].split(), fields, 2)

    # All stations are west of Greenwich; older files omit the minus sign of longitude
    longitude = -abs(longitude)
    if offset is None:
        offset = round(longitude / 15)
    return Site(latitude, longitude, offset, elevation, lines[0].strip())


def _surfrad_times(rows: DataRows) -> np.ndarray:
    # UTC times from year, day of the year, hour and minute
    cells, valid = {}, np.ones(len(rows.lines), dtype=bool)
    for name, (index, least, most) in _TIME.items():
        cells[name] = rows.column(index, name)
        valid &= (cells[name] >= least) & (cells[name] <= most)
    fault = (
        "the time is not in the calendar; year, day of year, hour and minute expected"
    )
    rows.require(valid, lambda _: fault)
    year = (cells["year"].astype(int) - 1970).astype("datetime64[Y]")
    day = year.astype("datetime64[D]") + (cells["day"].astype(int) - 1)
    seconds = np.round(3600 * cells["hour"] + 60 * cells["minute"]).astype(int)
    return np.asarray(day.astype("datetime64[s]") + seconds)


def read_srml(
    path: str | Path, *, site: Site, decomposition: Decomposition = "erbs"
) -> Weather:
    """Return the weather of a monthly file of SRML, University of Oregon (.txt).

    If a quantity is measured by several instruments, the first is used; values flagged
    as bad by SRML are treated as missing.

    Reference: F. Vignola et al., SRML, Archival (short interval) data files.
    """
    pd = importlib.import_module("pandas")
    data = _read_srml(path)
    require(
        isinstance(data.index, pd.DatetimeIndex),
        "the times cannot be read; dates of the calendar expected",
        file=path,
    )
    utc = data.index.tz_convert("UTC").tz_localize(None).to_numpy()
    series, names = {}, {}
    for quantity, short in _SRML.items():
        found = [name for name in data.columns if name.startswith(f"{short}_")]
        if found:
            try:
                values = pd.to_numeric(data[found[0]], errors="coerce")
            except OverflowError as error:
                text = f"column {found[0]} has too large a number; W/m² expected"
                raise InputError(text, file=path) from error
            series[quantity] = values.to_numpy(float)
            names[quantity] = found[0]
    return _weather(
        utc.astype("datetime64[s]"),
        site,
        series,
        DataRows(path, [], np.arange(len(data)) + _SRML_HEADER + 1),
        names=names,
        stands_for="start",
        decomposition=decomposition,
    )


def _read_srml(path: str | Path) -> Any:
    # Open the file first, since pvlib interprets the path of a missing file as a URL,
    # and takes the first cells of longer lines as labels
    cells = [line.count("\t") + 1 for line in read_text(path).splitlines()] or [0]
    longest, most = max(cells), min(cells[0], _MOST_COLUMNS)
    fault = f"{longest} columns; {most} or fewer expected"
    require(longest <= most, fault, file=path, line=1 + cells.index(longest))
    iotools = importlib.import_module("pvlib.iotools")
    try:
        with warnings.catch_warnings():
            # pvlib 0.16 uses options that pandas 4 will remove
            warnings.simplefilter("ignore", DeprecationWarning)
            return iotools.read_srml(str(path))
    except _BROKEN as error:
        text = " ".join(str(error).split())
        raise InputError(
            f"{text[:100]}; a file of SRML expected", file=path, line=1
        ) from error


def _weather(
    utc: np.ndarray,
    site: Site,
    series: dict[Quantity, Series],
    rows: DataRows,
    *,
    names: dict[Quantity, str] | None = None,
    stands_for: StandsFor,
    decomposition: Decomposition = "erbs",
) -> Weather:
    local = utc + np.timedelta64(round(site.utc_offset_hours * 3600), "s")
    times, step = step_centres(local, stands_for, rows=rows)
    measurement = Measurement(site, times, step, series, rows, names or {})
    return weather_of(measurement, decomposition=decomposition)
