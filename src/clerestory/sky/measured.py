"""Measured irradiance in CSV files, in columns that the user names.

Times are read as they stand: ISO 8601 or a given format, with or without an
offset from UTC. Times with an offset may change it over the year (daylight
saving); times without one are local standard time.
"""

import csv
from dataclasses import asdict, dataclass
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.cells import column
from clerestory.sky.closure import Decomposition, split_irradiance
from clerestory.sky.moments import require_growth, typical_step
from clerestory.sky.repair import repair_irradiance, report
from clerestory.sky.sun import sun_position
from clerestory.sky.weather import Site, Weather

StandsFor = Literal["start", "centre", "end"]

# Values that loggers write for missing data
_MISSING = (-9999.9, -9999.0, -999.0, 9999.0, 99999.0)


@dataclass(frozen=True)
class Columns:
    """What the columns of a CSV file are called.

    Attributes
    ----------
    time : one column, or several that together give the time
    global_horizontal, diffuse_horizontal, direct_normal : irradiance [W/m²];
        None where there is none
    dew_point : [°C]
    """

    time: str | tuple[str, ...]
    global_horizontal: str | None = None
    diffuse_horizontal: str | None = None
    direct_normal: str | None = None
    dew_point: str | None = None


def read_measured(
    path: str | Path,
    *,
    columns: Columns,
    site: Site,
    time_format: str | None = None,
    stands_for: StandsFor = "centre",
    separator: str = ",",
    skip_lines: int = 0,
    decomposition: Decomposition = "erbs",
) -> Weather:
    """Return the weather in a CSV file of measured irradiance, in its own years.

    Parameters
    ----------
    columns : their names in the header line
    site : where the measurement was made
    time_format : as for `datetime.strptime`, its parts separated by one space
        where the time is in several columns; None reads ISO 8601
    stands_for : the moment of its step that a time stands for
    separator : between cells
    skip_lines : lines before the header
    decomposition : model that splits global irradiance where it stands alone

    Raises
    ------
    InputError : a column is missing, a cell is not a number or time, time does
        not grow, or there is too little irradiance
    """
    table = _table(path, separator, skip_lines)

    # Go from the stated moment of each step to its centre
    times = _times(table, columns.time, time_format, site.utc_offset_hours)
    require_growth(times, file=path, lines=table.lines)
    step = typical_step(times)
    times = times + np.timedelta64(round(_shift(stands_for) * step * 60), "s")

    # Repair each series, then part sun and sky
    series, notes = _series(table, columns, times)
    sun = sun_position(
        times,
        latitude_deg=site.latitude_deg,
        longitude_deg=site.longitude_deg,
        utc_offset_hours=site.utc_offset_hours,
        elevation=site.elevation,
    )
    split = split_irradiance(times, sun, decomposition=decomposition, **series)
    notes += split.notes
    report(notes, file=path)
    if set(series) == {"global_horizontal"}:
        notes += (f"global irradiance split into sun and sky by {decomposition}",)
    return Weather(
        **asdict(site),
        times=times,
        step_minutes=step,
        direct_normal=split.direct_normal,
        diffuse_horizontal=split.diffuse_horizontal,
        dew_point_c=table.numbers(columns.dew_point) if columns.dew_point else None,
        source=str(path),
        notes=notes,
    )


@dataclass(frozen=True, eq=False)
class _Table:
    path: str | Path
    header_line: int
    names: list[str]
    rows: list[list[str]]
    lines: Int[np.ndarray, " time"]

    def index(self, name: str) -> int:
        """Place of a column, which must be there."""
        if name not in self.names:
            raise InputError(
                f"no column {name!r}; one of {', '.join(self.names)} expected",
                file=self.path,
                line=self.header_line,
            )
        return self.names.index(name)

    def numbers(self, name: str) -> Float[np.ndarray, " time"]:
        """Return a column of numbers; NaN where it is missing."""
        values = column(
            self.rows,
            self.index(name),
            name=name,
            file=self.path,
            lines=self.lines,
            may_miss=True,
        )
        return np.where(np.isin(values, _MISSING), np.nan, values)


def _table(path: str | Path, separator: str, skip_lines: int) -> _Table:
    table = list(csv.reader(read_text(path).splitlines(), delimiter=separator))
    numbers = [i for i, row in enumerate(table) if i > skip_lines and any(row)]
    if not numbers:
        line = max(len(table), 1)
        raise InputError("no data rows after the header", file=path, line=line)
    names = [name.strip() for name in table[skip_lines]]
    rows = [table[i] for i in numbers]
    return _Table(path, skip_lines + 1, names, rows, np.array(numbers) + 1)


def _series(
    table: _Table, columns: Columns, times: np.ndarray
) -> tuple[dict[str, Float[np.ndarray, " time"]], tuple[str, ...]]:
    notes: tuple[str, ...] = ()
    series = {}
    for kind in ("global_horizontal", "diffuse_horizontal", "direct_normal"):
        name = getattr(columns, kind)
        if name is not None:
            series[kind], made = repair_irradiance(
                table.numbers(name),
                name=name,
                times=times,
                file=table.path,
                lines=table.lines,
            )
            notes += made
    return series, notes


def _shift(stands_for: StandsFor) -> float:
    shifts = {"start": 0.5, "centre": 0.0, "end": -0.5}
    if stands_for not in shifts:
        raise InputError(
            f"times stand for {stands_for!r}; 'start', 'centre' or 'end' expected"
        )
    return shifts[stands_for]


def _times(
    table: _Table,
    names: str | tuple[str, ...],
    time_format: str | None,
    utc_offset_hours: float,
) -> np.ndarray:
    # Local standard time, whatever offset the file has
    standard = timezone(timedelta(hours=utc_offset_hours))
    where = [
        table.index(name) for name in ((names,) if isinstance(names, str) else names)
    ]
    moments = []
    for row, line in zip(table.rows, table.lines, strict=True):
        text = " ".join(row[i].strip() for i in where if i < len(row))
        try:
            if time_format is None:
                moment = datetime.fromisoformat(text)
            else:
                moment = datetime.strptime(text, time_format)  # noqa: DTZ007
        except ValueError as error:
            raise InputError(
                f"time {text!r}; {time_format or 'ISO 8601'} expected",
                file=table.path,
                line=int(line),
            ) from error
        if moment.tzinfo is not None:
            moment = moment.astimezone(standard)
        moments.append(moment.replace(tzinfo=UTC).timestamp())
    return np.round(moments).astype("datetime64[s]")
