"""Tables of view grids for spreadsheets: annual figures of each view, hourly DGP."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from clerestory.escaping import csv_line, table_cell
from clerestory.files import replace_file, write_text
from clerestory.glare.comfort_classes import protection_level
from clerestory.study.results import VIEWS, Results

# Number of time steps that are read at a time
_BLOCK = 730

_EXCEEDED, _SHARE = "grid_view_exceeded_dgp", "grid_view_glare_share"


def view_grids(results: Results) -> list[str]:
    """Names of the view grids, in the order of the study."""
    if "view_grid" not in results.data:
        return []
    return [str(name) for name in results.data["view_grid_name"].values]


def view_grid_part(data: xr.Dataset, grid: str) -> xr.Dataset:
    """Return the results of the views of one grid, which are contiguous."""
    members = np.flatnonzero(data["view_grid"].values == grid)
    return data.isel({VIEWS: slice(members[0], members[-1] + 1)})


def write_grid_views(results: Results, path: str | Path, *, grid: str) -> None:
    """Write position, direction and annual glare of each view, a line per view.

    Azimuths are clockwise from the scene's +y.
    """
    part = view_grid_part(results.data, grid)
    names = [table_cell(str(name)) for name in part[VIEWS].values]
    table = pd.DataFrame({"view": names, "position": part["grid_view_number"] + 1})
    table[["x [m]", "y [m]", "z [m]"]] = part["grid_view_position"]
    table["azimuth [deg]"] = part["grid_view_azimuth"]
    table["DGP exceeded in 5 %"] = part[_EXCEEDED]
    table["DGP exceeded in 5 %, standard error"] = part[f"{_EXCEEDED}_error"]
    table["EN 17037"] = [protection_level(float(dgp)) for dgp in part[_EXCEEDED]]
    for number, limit in enumerate(part["dgp_limit"].values.tolist()):
        head = f"hours above {limit:.2f}"
        for name, more in ((_SHARE, ""), (f"{_SHARE}_error", ", standard error")):
            table[f"{head}{more} [%]"] = 100 * part[name][:, number]
    by_state = part.get(f"{_EXCEEDED}_by_state", ())
    for number, dgp in enumerate(by_state):
        table[f"DGP exceeded in 5 %, state {number}"] = dgp
    text = table.to_csv(index=False, float_format="%.6g", lineterminator="\n")
    write_text(path, text)


def write_grid_dgp(results: Results, path: str | Path, *, grid: str) -> None:
    """Write the DGP of each view of a grid, a line per time step; empty in the dark."""
    part = view_grid_part(results.data, grid)
    head = csv_line(["time", *(str(name) for name in part[VIEWS].values)])
    with replace_file(path) as stream:
        stream.write(f"{head}\n".encode())
        for line in _lines(part):
            stream.write(line.encode())


def _lines(part: xr.Dataset) -> Iterator[str]:
    moments = np.datetime_as_string(part["time"].values, unit="m").tolist()
    form = ",%.3f" * part.sizes[VIEWS] + "\n"
    for first in range(0, len(moments), _BLOCK):
        block = slice(first, first + _BLOCK)
        values = part["grid_view_dgp"].isel(time=block).values
        for moment, row in zip(moments[block], values.T, strict=True):
            stamp = moment.replace("T", " ")
            # Empty cells for NaN
            yield stamp + (form % tuple(row.tolist())).replace("nan", "")
