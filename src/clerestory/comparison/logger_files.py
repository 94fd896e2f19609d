"""CSV files of data loggers, with a column of times and one column per series."""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from clerestory.comparison.series import Series
from clerestory.documents import Table
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.csv_measurements import local_times, read_table
from clerestory.sky.station_file import OneOrSeveral
from clerestory.sky.time_steps import step_centres


class LoggerFile(Table):
    """Description of a CSV file of a data logger.

    Attributes
    ----------
    file : name of the file
    time : column of times, or several columns whose texts are joined
    columns : column name of each series
    time_format : format for `datetime.strptime`; default: ISO 8601
    stands_for : whether times are the "start", "centre" or "end" of the steps; "moment"
        for instantaneous readings
    separator : character between cells
    skip_lines : number of lines before the header
    factor : factor on the values, 1000 for kilolux
    """

    file: str = Field(min_length=1, description="the name of a file in quotes")
    time: OneOrSeveral = Field(min_length=1, description="the name of a column")
    columns: dict[str, str] = Field(
        min_length=1, description="a table of columns by the names of series"
    )
    time_format: str | None = None
    stands_for: Literal["start", "centre", "end", "moment"] = "centre"
    separator: str = Field(",", min_length=1, max_length=1)
    skip_lines: int = Field(0, ge=0)
    factor: float = 1.0


def read_logger(
    folder: Path,
    logger: LoggerFile,
    *,
    utc_offset_hours: float,
    clock: str | None = None,
) -> Series:
    """Return the series in a CSV file of a data logger.

    Parameters
    ----------
    utc_offset_hours : local standard time minus UTC [h]
    clock : time zone of civil time, such as "Europe/Berlin", with its daylight saving
        time; None for local standard time
    """
    path = folder / logger.file
    table = read_table(path, logger.separator, logger.skip_lines)
    columns = tuple(logger.time)
    times = local_times(table, columns, logger.time_format, clock, utc_offset_hours)
    momentary = logger.stands_for == "moment"
    times, step = step_centres(
        times,
        "centre" if logger.stands_for == "moment" else logger.stands_for,
        rows=table,
    )
    step = 0.0 if momentary else step
    values = [logger.factor * table.numbers(name) for name in logger.columns.values()]
    return Series(
        tuple(logger.columns),
        times,
        np.array(values).reshape(len(values), len(times)),
        step,
        utc_offset_hours,
        source=str(path),
    )


def read_plain(path: str | Path, *, utc_offset_hours: float) -> Series:
    """Return the series of a CSV file whose first column is the time.

    Times are in ISO 8601 and mark the centres of the steps; the headings of the other
    columns are the names of the series. `clerestory run` writes tables of this format.
    """
    path = Path(path)
    time, *names = _header(path)
    columns = {name: name for name in names}
    logger = LoggerFile(file=path.name, time=[time], columns=columns)
    return read_logger(path.parent, logger, utc_offset_hours=utc_offset_hours)


def _header(path: Path) -> Sequence[str]:
    rows = csv.reader(read_text(path).splitlines()[:1])
    names = [name.strip() for row in rows for name in row]
    if len(names) < 2 or not all(names) or len(set(names)) < len(names):
        raise InputError(
            "a header with a column of times and unique names of series expected",
            file=path,
            line=1,
        )
    return names
