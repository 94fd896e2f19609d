"""Series in CSV files: a column of times, and a column for every series."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, final

import numpy as np

from clerestory.comparison.series import Series
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.csv_measurements import local_times, read_table
from clerestory.sky.time_steps import centres, require_increasing, typical_step

StandsFor = Literal["start", "centre", "end", "moment"]


@final
@dataclass(frozen=True)
class Layout:
    """How a CSV file of series is written.

    Attributes
    ----------
    time : one column, or several that together give the time
    time_format : as for `datetime.strptime`; None reads ISO 8601
    stands_for : the part of its step that a time names; "moment" for readings that
        stand for no step
    clock : time zone of the clock, such as "Europe/Berlin", with its daylight saving;
        None for local standard time
    separator : between cells
    skip_lines : lines before the header
    factor : by which values are multiplied, 1000 for kilolux
    """

    time: tuple[str, ...]
    time_format: str | None = None
    stands_for: StandsFor = "centre"
    clock: str | None = None
    separator: str = ","
    skip_lines: int = 0
    factor: float = 1.0


def read_logger(
    path: str | Path,
    *,
    layout: Layout,
    columns: Mapping[str, str],
    utc_offset_hours: float,
) -> Series:
    """Return the series in a CSV file.

    Parameters
    ----------
    columns : by the name of the series, what its column is called
    utc_offset_hours : of local standard time

    Raises
    ------
    InputError : a column is missing, a cell is not a number or a time, time does not
        grow
    """
    table = read_table(path, layout.separator, layout.skip_lines)
    times = local_times(
        table, layout.time, layout.time_format, layout.clock, utc_offset_hours
    )
    require_increasing(times, rows=table)
    step = 0.0
    if layout.stands_for != "moment":
        step = typical_step(times)
        times = centres(times, step, layout.stands_for)
    values = [layout.factor * table.numbers(name) for name in columns.values()]
    return Series(
        tuple(columns),
        times,
        np.array(values).reshape(len(columns), len(times)),
        step,
        utc_offset_hours,
        source=str(path),
    )


def read_plain(path: str | Path, *, utc_offset_hours: float) -> Series:
    """Return the series of a CSV file whose first column is the time.

    Times are ISO 8601 and the middles of their steps; the other columns are named as
    series are. Tables of `clerestory run` are such files.

    Raises
    ------
    InputError : as for `read_logger`
    """
    names = _header(path)
    layout = Layout((names[0],))
    columns = {name: name for name in names[1:]}
    return read_logger(
        path, layout=layout, columns=columns, utc_offset_hours=utc_offset_hours
    )


def _header(path: str | Path) -> Sequence[str]:
    rows = csv.reader(read_text(path).splitlines()[:1])
    names = [name.strip() for row in rows for name in row]
    if len(names) < 2 or not all(names) or len(set(names)) < len(names):
        raise InputError(
            "a header with a column of times and different names of series expected",
            file=path,
            line=1,
        )
    return names
