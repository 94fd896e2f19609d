"""Measured irradiance in CSV files with user-defined columns.

Times are in ISO 8601 or a given format, with or without UTC offset, which may change
with daylight saving time. Times without offset are local standard time, or the civil
time of a given time zone; the hour repeated at the end of daylight saving time is
resolved by the order of the rows.
"""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from typing import get_args
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np

from clerestory.array_types import Series
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.files import csv_rows, read_text
from clerestory.sky.irradiance_decomposition import Decomposition
from clerestory.sky.measured_weather import Measurement, Quantity, weather_of
from clerestory.sky.table_cells import DataRows
from clerestory.sky.time_steps import StandsFor, step_centres
from clerestory.sky.weather import Site, Weather

# Values that data loggers write for missing data
_MISSING = (-9999.9, -9999.0, -999.0, 9999.0, 99999.0)


@dataclass(frozen=True)
class Columns:
    """Column names of the quantities in a CSV file; None if not measured.

    If the time is in several columns, their texts are joined by spaces. Irradiance is
    in W/m², illuminance in lux, and the dew point temperature in °C.
    """

    time: str | tuple[str, ...]
    global_horizontal: str | None = None
    diffuse_horizontal: str | None = None
    direct_normal: str | None = None
    global_illuminance: str | None = None
    diffuse_illuminance: str | None = None
    direct_illuminance: str | None = None
    dew_point: str | None = None

    def series(self) -> dict[Quantity, str]:
        """Return the names of the irradiance and illuminance columns, by quantity."""
        named = {q: getattr(self, q) for q in get_args(Quantity)}
        return {q: name for q, name in named.items() if name is not None}


def read_measured(
    path: str | Path,
    *,
    columns: Columns,
    site: Site,
    time_format: str | None = None,
    stands_for: StandsFor = "centre",
    clock: str | None = None,
    separator: str = ",",
    skip_lines: int = 0,
    decomposition: Decomposition = "erbs",
) -> Weather:
    """Return the weather in a CSV file of measured irradiance or illuminance.

    `time_format` is a format of `datetime.strptime`; default: ISO 8601. Times mark the
    "start", "centre" or "end" of the steps, in local standard time or in the civil time
    of the zone `clock`, such as "Europe/Berlin". `skip_lines` lines precede the header.
    """
    table = read_table(path, separator, skip_lines)
    times = local_times(table, columns.time, time_format, clock, site.utc_offset_hours)
    times, step = step_centres(times, stands_for, rows=table)
    names = columns.series()
    series = {quantity: table.numbers(name) for quantity, name in names.items()}
    dew_point = table.numbers(columns.dew_point) if columns.dew_point else None
    return weather_of(
        Measurement(site, times, step, series, table, names, dew_point),
        decomposition=decomposition,
    )


@dataclass(frozen=True, eq=False)
class LoggerTable(DataRows):
    """Rows of a CSV file, with line number and column names of the header."""

    header_line: int
    names: list[str]

    def index(self, name: str) -> int:
        """Return the index of a column; raise `InputError` if there is none."""
        require(
            name in self.names,
            f"no column {name!r}; one of {', '.join(self.names)} expected",
            file=self.file,
            line=self.header_line,
        )
        return self.names.index(name)

    def numbers(self, name: str) -> Series:
        """Return a column of numbers, with NaN for missing values."""
        values = self.column(self.index(name), name, may_miss=True)
        return np.where(np.isin(values, _MISSING), np.nan, values)


def read_table(path: str | Path, separator: str, skip_lines: int) -> LoggerTable:
    """Return the cells of a CSV file whose header follows `skip_lines` lines."""
    table = csv_rows(read_text(path).splitlines(), file=path, separator=separator)
    filled = (row if any(row) else [] for row in table)
    rows = DataRows.below(skip_lines + 1, filled, file=path)
    names = [name.strip() for name in table[skip_lines]]
    return LoggerTable(path, rows.cells, rows.lines, skip_lines + 1, names)


def local_times(
    table: LoggerTable,
    names: str | tuple[str, ...],
    time_format: str | None,
    clock: str | None,
    utc_offset_hours: float,
) -> np.ndarray:
    """Return the times of the rows in local standard time."""
    standard = timezone(timedelta(hours=utc_offset_hours))
    zone = _zone(clock)
    names = (names,) if isinstance(names, str) else names
    where = [table.index(name) for name in names]
    moments: list[float] = []
    for row, line in zip(table.cells, table.lines, strict=True):
        text = " ".join(row[i].strip() for i in where if i < len(row))
        try:
            if time_format is None:
                moment = datetime.fromisoformat(text)
            else:
                moment = datetime.strptime(text, time_format)  # noqa: DTZ007
        except ValueError as error:
            raise InputError(
                f"time {text!r}; {time_format or 'ISO 8601'} expected",
                file=table.file,
                line=int(line),
            ) from error
        if moment.tzinfo is None and zone is not None:
            before = moments[-1] if moments else -np.inf
            moment = _civil_time(moment, zone, standard, before)
        if moment.tzinfo is not None:
            moment = moment.astimezone(standard)
        moments.append(moment.replace(tzinfo=UTC).timestamp())
    return np.round(moments).astype("datetime64[s]")


def _zone(clock: str | None) -> ZoneInfo | None:
    if clock is None:
        return None
    try:
        return ZoneInfo(clock)
    except (ZoneInfoNotFoundError, ValueError, OSError) as error:
        raise InputError(
            f"unknown time zone {clock!r}; a name such as 'Europe/Berlin' expected"
        ) from error


def _civil_time(
    moment: datetime, zone: ZoneInfo, standard: timezone, before: float
) -> datetime:
    # In the hour repeated at the end of daylight saving time, take the second
    # occurrence if the first is not later than the previous row
    first = moment.replace(tzinfo=zone).astimezone(standard)
    if first.replace(tzinfo=UTC).timestamp() > before:
        return first
    return moment.replace(tzinfo=zone, fold=1)
