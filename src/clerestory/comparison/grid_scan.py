"""Grid scans: tables of illuminance readings, taken row by row on a grid of points.

A layout defines the measuring points of the columns and rows of the table; each reading
is compared with the sensor of the study at the same point.
"""

from datetime import datetime
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError
from scipy.spatial import cKDTree

from clerestory.checks import require, same_length
from clerestory.comparison.logger_files import CsvFormat
from clerestory.comparison.series import Series
from clerestory.documents import Table
from clerestory.errors import InputError


class GridLayout(CsvFormat):
    """Measuring points of a grid scan.

    Attributes
    ----------
    columns : names of the table columns with readings
    column_axis : axis along which columns follow each other, "x" or "y"
    column_at, row_at : coordinates of the columns along `column_axis`, and of the rows
        along the other horizontal axis [m]
    height : z coordinate of the points [m]
    grid : name of the sensor grid of the study; if empty, all grids are searched
    tolerance : largest distance between a point and a sensor of the study [m]
    """

    columns: list[str] = Field(min_length=1, description="a list of columns")
    column_axis: Literal["x", "y"] = Field(description='"x" or "y"')
    column_at: list[float] = Field(description="a place [m] for each column")
    row_at: list[float] = Field(min_length=1, description="a place [m] for each row")
    height: float = Field(description="the height of the sensors [m]")
    grid: str = ""
    tolerance: float = Field(0.05, gt=0)

    @model_validator(mode="after")
    def _one_place_each(self) -> "GridLayout":
        if len(self.columns) != len(self.column_at):
            expected = "one coordinate for each column expected"
            message = f'"columns" and "column_at" differ in length; {expected}'
            raise PydanticCustomError("rule", message)
        return self

    def positions(self) -> Float[np.ndarray, "row column 3"]:
        """Return the measuring point of each reading [m]."""
        down, across = np.meshgrid(self.row_at, self.column_at, indexing="ij")
        height = np.full(down.shape, self.height)
        x, y = (down, across) if self.column_axis == "y" else (across, down)
        return np.stack([x, y, height], axis=-1)


class GridScan(Table):
    """A grid scan, stored in one file.

    Attributes
    ----------
    file : name of the file
    at : time of the first row, by the clock of the measurement
    layout : name of the layout
    row_minutes : time between rows [min]; 0 for simultaneous readings
    backwards : whether the rows of the file are in the reverse order of `row_at`
    """

    file: str = Field(min_length=1, description="the name of a file in quotes")
    at: datetime = Field(description="a moment such as 2024-06-26T09:00:00")
    layout: str = Field(description="the name of a table [layout.NAME]")
    row_minutes: float = Field(0.0, ge=0)
    backwards: bool = False


def read_scan(
    folder: Path, scan: GridScan, *, layout: GridLayout, near: Series
) -> list[Series]:
    """Return the readings of a scan as one `Series` per time of measurement."""
    path = folder / scan.file
    readings = layout.values(layout.read(path), layout.columns).T
    same_length(readings, layout.row_at, "rows of readings", "measuring points")
    names = sensors_at(layout, near)
    places = names[::-1] if scan.backwards else names
    start = np.datetime64(scan.at.replace(tzinfo=None), "s")
    seconds = np.rint(np.arange(len(places)) * scan.row_minutes * 60).astype(int)
    found = []
    for second in np.unique(seconds):
        rows = np.flatnonzero(seconds == second)
        sensors = tuple(name for i in rows for name in places[i])
        at, values = start + np.array([second], "m8[s]"), readings[rows].reshape(-1, 1)
        offset = near.utc_offset_hours
        found.append(Series(sensors, at, values, 0.0, offset, source=str(path)))
    return found


def sensors_at(layout: GridLayout, near: Series) -> list[list[str]]:
    """Return the names of the study's sensors at the points of a layout, row by row."""
    if near.position is None:
        message = "sensor positions are unknown; the results.nc of a run expected"
        raise InputError(message, file=near.source)
    known = [
        i
        for i, name in enumerate(near.names)
        if (not layout.grid or name.rpartition(".")[0] == layout.grid)
        and not np.any(np.isnan(near.position[i]))
    ]
    message = f'no sensor with a known position in grid "{layout.grid}"'
    require(known, f"{message}; a sensor grid of the study expected", file=near.source)
    points = layout.positions()
    away, best = cKDTree(near.position[known]).query(points)
    x, y, z = points[np.unravel_index(away.argmax(), away.shape)]
    require(
        away.max() <= layout.tolerance,
        f"no sensor within {layout.tolerance:g} m of ({x:g} {y:g} {z:g}); the nearest"
        f" sensor is {away.max():.3g} m away",
        file=near.source,
    )
    return [[near.names[known[i]] for i in row] for row in best]
