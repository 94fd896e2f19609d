"""CSV files of data loggers, with a column of times and one column per series."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float
from pydantic import Field

from clerestory.checks import require
from clerestory.comparison.series import Series
from clerestory.documents import Table
from clerestory.files import csv_rows, read_text
from clerestory.sky.csv_measurements import LoggerTable, local_times, read_table
from clerestory.sky.station_file import OneOrSeveral
from clerestory.sky.time_steps import step_centres


class CsvFormat(Table):
    """Format of a CSV file of measurements.

    Attributes
    ----------
    separator : character between cells
    skip_lines : number of lines before the header
    factor : factor by which the values in the file are multiplied
    """

    separator: str = Field(",", min_length=1, max_length=1)
    skip_lines: int = Field(0, ge=0)
    factor: float = 1.0

    def read(self, path: Path) -> LoggerTable:
        """Return the cells of a file."""
        return read_table(path, self.separator, self.skip_lines)

    def values(
        self, table: LoggerTable, columns: Iterable[str]
    ) -> Float[np.ndarray, "column row"]:
        """Return columns of numbers times `factor`; missing numbers are NaN."""
        return self.factor * np.stack([table.numbers(name) for name in columns])


class LoggerFile(CsvFormat):
    """Description of a CSV file of a data logger.

    Attributes
    ----------
    file : name of the file
    time : name of the column of times, or of several columns whose texts are joined
    columns : column name of each series
    time_format : format for `datetime.strptime`; default: ISO 8601
    stands_for : whether times are "start", "centre" or "end" of time steps; "moment"
        for instantaneous readings
    """

    file: str = Field(min_length=1, description="the name of a file in quotes")
    time: OneOrSeveral = Field(min_length=1, description="the name of a column")
    columns: dict[str, str] = Field(
        min_length=1, description="a table of columns by the names of series"
    )
    time_format: str | None = None
    stands_for: Literal["start", "centre", "end", "moment"] = "centre"


def read_logger(
    folder: Path,
    logger: LoggerFile,
    *,
    utc_offset_hours: float,
    clock: str | None = None,
) -> Series:
    """Return the series in a CSV file of a data logger.

    `clock` is the time zone of a logger on civil time (with daylight saving time), such
    as "Europe/Berlin"; None for local standard time.
    """
    path = folder / logger.file
    table = logger.read(path)
    columns = tuple(logger.time)
    times = local_times(table, columns, logger.time_format, clock, utc_offset_hours)
    if logger.stands_for == "moment":
        times, step = step_centres(times, "centre", rows=table)[0], 0.0
    else:
        times, step = step_centres(times, logger.stands_for, rows=table)
    names, values = tuple(logger.columns), logger.values(table, logger.columns.values())
    return Series(names, times, values, step, utc_offset_hours, source=str(path))


def read_plain(path: str | Path, *, utc_offset_hours: float) -> Series:
    """Return the series of a CSV file whose first column is the time.

    Times in ISO 8601 mark the centres of the time steps; the headings of the other
    columns are the names of the series. `clerestory run` writes tables of this format.
    """
    path = Path(path)
    time, *names = _header(path)
    columns = {name: name for name in names}
    logger = LoggerFile(file=path.name, time=[time], columns=columns)
    return read_logger(path.parent, logger, utc_offset_hours=utc_offset_hours)


def _header(path: Path) -> Sequence[str]:
    rows = csv_rows(read_text(path).splitlines()[:1], file=path)
    names = [name.strip() for row in rows for name in row]
    valid = len(names) > 1 and all(names) and len(set(names)) == len(names)
    message = "a header with a column of times and unique names of series expected"
    require(valid, message, file=path, line=1)
    return names
