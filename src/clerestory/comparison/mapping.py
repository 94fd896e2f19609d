"""Mapping files (.toml): which measured column belongs to which series of a study.

    utc_offset_hours = 1

    [[logger]]
    file = "desk.csv"
    time = "TIMESTAMP"
    stands_for = "end"
    columns = { "desks.1" = "E1_lx", "eye.dgp" = "DGP" }

    [layout.classroom]
    columns = ["N1", "N2"]
    column_axis = "y"
    column_at = [0.5, 1.5]
    row_at = [1.0, 2.0, 3.0]
    height = 0.75

    [[scan]]
    file = "0900.csv"
    at = 2024-06-26T09:00:00
    layout = "classroom"

Files are named relative to the mapping.
"""

from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)
from pydantic_core import PydanticCustomError

from clerestory.comparison.grid_scan import Axis, GridLayout, ScanTime, read_scan
from clerestory.comparison.logger_files import (
    Layout,
    StandsFor,
    read_logger,
    read_plain,
)
from clerestory.comparison.series import Series
from clerestory.errors import InputError
from clerestory.files import read_text, write_text
from clerestory.study.config_errors import input_error, parse_toml


def _several(value: Any) -> Any:
    # One name is a list of one
    return [value] if isinstance(value, str) else value


class _Table(BaseModel):
    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False
    )


class LoggerTable(_Table):
    """A CSV file with a column of times."""

    file: str = Field(min_length=1, description="the name of a file in quotes")
    time: Annotated[list[str], BeforeValidator(_several)] = Field(
        min_length=1, description="the name of a column"
    )
    columns: dict[str, str] = Field(
        min_length=1, description="a table of columns by the names of series"
    )
    time_format: str | None = None
    stands_for: StandsFor = "centre"
    separator: str = Field(",", min_length=1, max_length=1)
    skip_lines: int = Field(0, ge=0)
    factor: float = 1.0


class LayoutTable(_Table):
    """Where the readings of a scan were taken."""

    columns: list[str] = Field(min_length=1, description="a list of columns")
    column_axis: Axis = Field(description='"x" or "y"')
    column_at: list[float] = Field(description="a place [m] for each column")
    row_at: list[float] = Field(min_length=1, description="a place [m] for each row")
    height: float = Field(description="the height of the sensors [m]")
    grid: str = ""
    separator: str = Field(",", min_length=1, max_length=1)
    skip_lines: int = Field(0, ge=0)
    factor: float = 1.0
    tolerance: float = Field(0.05, gt=0)

    @model_validator(mode="after")
    def _one_place_each(self) -> "LayoutTable":
        if len(self.columns) != len(self.column_at):
            raise PydanticCustomError(
                "rule", '"columns" and "column_at" differ in length; one each expected'
            )
        return self

    def layout(self) -> GridLayout:
        """Return the same as a plain value."""
        facts = self.model_dump()
        for key in ("columns", "column_at", "row_at"):
            facts[key] = tuple(facts[key])
        return GridLayout(**facts)


class ScanTable(_Table):
    """A grid scan in a file of its own."""

    file: str = Field(min_length=1, description="the name of a file in quotes")
    at: datetime = Field(description="a moment such as 2024-06-26T09:00:00")
    layout: str = Field(description="the name of a table [layout.NAME]")
    row_minutes: float = Field(0.0, ge=0)
    backwards: bool = False


class Mapping(_Table):
    """A whole mapping file."""

    title: str = ""
    utc_offset_hours: float | None = Field(None, ge=-14, le=14)
    clock: str | None = None
    logger: list[LoggerTable] = Field(default_factory=list)
    layout: dict[str, LayoutTable] = Field(default_factory=dict)
    scan: list[ScanTable] = Field(default_factory=list)

    @model_validator(mode="after")
    def _something(self) -> "Mapping":
        if not self.logger and not self.scan:
            raise PydanticCustomError(
                "rule", "nothing measured; a table [[logger]] or [[scan]] expected"
            )
        for scan in self.scan:
            if scan.layout not in self.layout:
                raise PydanticCustomError(
                    "rule",
                    'no table [layout.{name}]; the layout of scan "{file}" expected',
                    {"name": scan.layout, "file": scan.file},
                )
        return self


def read_mapping(path: str | Path) -> Mapping:
    """Return the mapping in a TOML file.

    Raises
    ------
    InputError : it is not TOML, or a key is missing, unknown or wrong
    """
    path = Path(path)
    text = read_text(path)
    try:
        return Mapping.model_validate(parse_toml(text, file=path))
    except ValidationError as error:
        raise input_error(error, model=Mapping, text=text, file=path) from error


def read_measured_series(path: str | Path, *, near: Series) -> list[Series]:
    """Return all that was measured, on the clock of a study.

    Parameters
    ----------
    path : a mapping (.toml), or a CSV file whose columns are named as series are
    near : series of the study

    Raises
    ------
    InputError : the mapping or one of its files is wrong
    """
    path = Path(path)
    if path.suffix.lower() != ".toml":
        return [read_plain(path, utc_offset_hours=near.utc_offset_hours)]
    mapping = read_mapping(path)
    offset = mapping.utc_offset_hours
    offset = near.utc_offset_hours if offset is None else offset
    found = []
    for table in mapping.logger:
        given = table.model_dump(exclude={"file", "columns", "time"})
        layout = Layout(tuple(table.time), clock=mapping.clock, **given)
        file = path.parent / table.file
        found.append(
            read_logger(
                file, layout=layout, columns=table.columns, utc_offset_hours=offset
            )
        )
    for scan in mapping.scan:
        when = ScanTime(scan.at, scan.row_minutes, scan.backwards)
        layout_of = mapping.layout[scan.layout].layout()
        here = near.on_clock(offset)
        found += read_scan(
            path.parent / scan.file, layout=layout_of, when=when, near=here
        )
    return [series.on_clock(near.utc_offset_hours) for series in found]


def write_layout_sensors(path: str | Path, mapping: Mapping) -> int:
    """Write the places of all layouts as upward sensors; return how many there are.

    Raises
    ------
    InputError : there is no layout
    """
    places = [t.layout().positions().reshape(-1, 3) for t in mapping.layout.values()]
    if not places:
        raise InputError("no table [layout.NAME]; the places of scans expected")
    points = np.unique(np.concatenate(places).round(6), axis=0)
    lines = [f"{x:.6g} {y:.6g} {z:.6g} 0 0 1" for x, y, z in points]
    write_text(path, "\n".join(lines) + "\n")
    return len(lines)
