"""Grid scans: a table of readings, row by row, taken over a grid at a stated minute.

The table knows nothing of the room. A layout says where the sensors of its columns and
of its rows stood; each reading then belongs to the sensor of the study that is there.
"""

import csv
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Literal, final

import numpy as np
from jaxtyping import Float

from clerestory.comparison.series import Series
from clerestory.errors import InputError
from clerestory.files import read_text

Axis = Literal["x", "y"]


@final
@dataclass(frozen=True)
class GridLayout:
    """Where the readings of a scan were taken.

    Attributes
    ----------
    columns : names of the columns that are read, in any choice and order
    column_axis : along which the sensors of a row stand
    column_at, row_at : where those of each column and of each row stand [m], on that
        axis and the other one
    height : of all of them [m]
    grid : of the study that they belong to; any if empty
    separator, skip_lines : how the file is written
    factor : by which readings are multiplied, 1000 for kilolux
    tolerance : how far the study's sensor may stand off [m]

    Raises
    ------
    InputError : not one place for each column
    """

    columns: tuple[str, ...]
    column_axis: Axis
    column_at: tuple[float, ...]
    row_at: tuple[float, ...]
    height: float
    grid: str = ""
    separator: str = ","
    skip_lines: int = 0
    factor: float = 1.0
    tolerance: float = 0.05

    def __post_init__(self) -> None:
        if len(self.columns) != len(self.column_at):
            raise InputError(
                f"{len(self.column_at)} places for {len(self.columns)} columns;"
                " one each expected"
            )

    def positions(self) -> Float[np.ndarray, "row column 3"]:
        """Where each reading is taken [m]."""
        down, across = np.meshgrid(self.row_at, self.column_at, indexing="ij")
        height = np.full(down.shape, self.height)
        x, y = (down, across) if self.column_axis == "y" else (across, down)
        return np.stack([x, y, height], axis=-1)


@final
@dataclass(frozen=True)
class ScanTime:
    """When a scan was taken.

    Attributes
    ----------
    at : of its first row, on the clock of the measurement
    row_minutes : from one row to the next [min]; 0 if all were taken at once
    backwards : whether the first row of the file stands at the last place
    """

    at: datetime
    row_minutes: float = 0.0
    backwards: bool = False


def read_scan(
    path: str | Path, *, layout: GridLayout, when: ScanTime, near: Series
) -> list[Series]:
    """Return the readings of a scan, one set of series for each moment.

    Parameters
    ----------
    near : series of the study, with the places of their sensors

    Raises
    ------
    InputError : the file lacks a column or a row, a cell is not a number, or the study
        has no sensor at a place
    """
    readings = layout.factor * _cells(path, layout)
    names = sensors_at(layout, near)
    places = names[::-1] if when.backwards else names
    start = np.datetime64(when.at.replace(tzinfo=None), "s")
    moments = [
        start + np.timedelta64(round(number * when.row_minutes * 60), "s")
        for number in range(len(places))
    ]
    found = []
    for moment in dict.fromkeys(moments):
        rows = [i for i, each in enumerate(moments) if each == moment]
        found.append(
            Series(
                tuple(name for i in rows for name in places[i]),
                np.array([moment]),
                readings[rows].reshape(-1, 1),
                0.0,
                near.utc_offset_hours,
                source=str(path),
            )
        )
    return found


def sensors_at(layout: GridLayout, near: Series) -> list[list[str]]:
    """Return the study's sensor at each place of a layout, row by row.

    Raises
    ------
    InputError : there is none within the tolerance
    """
    if near.position is None:
        raise InputError(
            "no places of sensors; the results.nc of a run expected with scans",
            file=near.source,
        )
    ours = [
        i
        for i, name in enumerate(near.names)
        if not layout.grid or name.rpartition(".")[0] == layout.grid
    ]
    places = near.position[ours]
    if not ours or np.all(np.isnan(places)):
        raise InputError(f'no sensors in grid "{layout.grid}"', file=near.source)
    found = []
    for row in layout.positions():
        away = np.linalg.norm(row[:, None] - places[None], axis=-1)
        best = np.nanargmin(away, axis=1)
        far = away[np.arange(len(row)), best]
        if np.any(far > layout.tolerance):
            x, y, z = row[int(np.argmax(far))]
            raise InputError(
                f"no sensor within {layout.tolerance:g} m of ({x:g} {y:g} {z:g});"
                f" the next is {far.max():.3g} m away",
                file=near.source,
            )
        found.append([near.names[ours[i]] for i in best])
    return found


def _cells(path: str | Path, layout: GridLayout) -> np.ndarray:
    lines = read_text(path).splitlines()[layout.skip_lines :]
    table = [row for row in csv.reader(lines, delimiter=layout.separator) if any(row)]
    head = [name.strip() for name in table[0]] if table else []
    missing = next((name for name in layout.columns if name not in head), None)
    if missing is not None:
        raise InputError(
            f'no column "{missing}"; one of {", ".join(head) or "a header"} expected',
            file=path,
            line=layout.skip_lines + 1,
        )
    if len(table) - 1 != len(layout.row_at):
        raise InputError(
            f"{len(table) - 1} rows of readings; {len(layout.row_at)} expected",
            file=path,
        )
    picked = [head.index(name) for name in layout.columns]
    return np.array([[_number(row, i, path) for i in picked] for row in table[1:]])


def _number(row: list[str], place: int, path: str | Path) -> float:
    # An empty cell is a reading that was not taken
    text = row[place].strip() if place < len(row) else ""
    try:
        value = float(text) if text else float("nan")
    except ValueError:
        raise InputError(f'"{text}"; a number expected', file=path) from None
    return value if np.isfinite(value) else float("nan")
