"""Mapping files (.toml): assignment of measured columns to the series of a study.

Tables are [[logger]] for files of data loggers, [layout.NAME] for the measuring points
of grid scans, and [[scan]] for files of grid scans. File names are relative to the
folder of the mapping file.
"""

from pathlib import Path

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from clerestory.checks import require
from clerestory.comparison.grid_scan import GridLayout, GridScan, read_scan
from clerestory.comparison.logger_files import LoggerFile, read_logger, read_plain
from clerestory.comparison.series import Series
from clerestory.documents import Table, read_toml
from clerestory.files import write_text


class Mapping(Table):
    """Contents of a mapping file."""

    title: str = ""
    utc_offset_hours: float | None = Field(None, ge=-14, le=14)
    clock: str | None = None
    logger: list[LoggerFile] = Field(default_factory=list)
    layout: dict[str, GridLayout] = Field(default_factory=dict)
    scan: list[GridScan] = Field(default_factory=list)

    @model_validator(mode="after")
    def _something(self) -> "Mapping":
        if not self.logger and not self.scan:
            raise PydanticCustomError(
                "rule", "no measurements; a table [[logger]] or [[scan]] expected"
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
    """Return the mapping in a TOML file."""
    return read_toml(path, Mapping)


def read_measured_series(path: str | Path, *, near: Series) -> list[Series]:
    """Return all measured series, with times converted to the UTC offset of a study.

    Parameters
    ----------
    path : mapping file (.toml), or CSV file whose headings are the names of the series
    near : simulated series, which give UTC offset and sensor positions

    Raises
    ------
    InputError : the mapping file or a measurement file is invalid
    """
    path = Path(path)
    if path.suffix.lower() != ".toml":
        return [read_plain(path, utc_offset_hours=near.utc_offset_hours)]
    mapping = read_mapping(path)
    offset = mapping.utc_offset_hours
    offset = near.utc_offset_hours if offset is None else offset
    found = [
        read_logger(path.parent, one, utc_offset_hours=offset, clock=mapping.clock)
        for one in mapping.logger
    ]
    here = near.on_clock(offset)
    for scan in mapping.scan:
        layout = mapping.layout[scan.layout]
        found += read_scan(path.parent, scan, layout=layout, near=here)
    return [series.on_clock(near.utc_offset_hours) for series in found]


def write_layout_sensors(path: str | Path, mapping: Mapping) -> int:
    """Write sensors facing up at the points of all layouts; return their number."""
    places = [one.positions().reshape(-1, 3) for one in mapping.layout.values()]
    require(places, "no table [layout.NAME]; at least one expected")
    points = np.unique(np.concatenate(places).round(6), axis=0)
    lines = [f"{x:.6g} {y:.6g} {z:.6g} 0 0 1" for x, y, z in points]
    write_text(path, "\n".join(lines) + "\n")
    return len(lines)
