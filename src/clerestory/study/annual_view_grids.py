"""Annual glare of the view grids of a study, position by position.

The hourly values of a position are written to a file as soon as they are known, so
that memory does not grow with the number of positions. Traced matrices are cached: an
interrupted run does not trace finished positions again.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import h5netcdf  # type: ignore[import-untyped]
import numpy as np
import xarray as xr
from jaxtyping import Bool, Int

from clerestory.files import replace_path
from clerestory.glare.view_grid_metrics import ViewFigures, view_figures
from clerestory.phases.hourly_file import hourly_variable
from clerestory.phases.matrix_equation import States
from clerestory.study.job import Display
from clerestory.study.results import VIEWS
from clerestory.study.view_grid_positions import ViewGrid
from clerestory.study.view_grid_results import (
    GridFigures,
    WorstMoment,
    disturbed_shares,
    grid_labels,
    grid_rows,
    worst_moments,
)

# File of hourly values in the temporary folder
_FILE = "view_grids.nc"

# Hourly values: their names in results.nc and units, by name of the glare quantity
_HOURLY = {
    "dgp": ("grid_view_dgp", "1"),
    "dgp_error": ("grid_view_dgp_error", "1"),
    "illuminance": ("grid_view_illuminance", "lux"),
}


class PointGlare(Protocol):
    """Function that computes the glare of the views of one position."""

    def __call__(
        self,
        grid: ViewGrid,
        number: int,
        states: States,
        steps: Int[np.ndarray, " step"],
    ) -> xr.Dataset:
        """Return "dgp", "dgp_error" and "illuminance" (view, time)."""


@dataclass(frozen=True, eq=False)
class Hours:
    """Time steps: their middles, those with daylight, and those that are occupied."""

    times: np.ndarray
    lit: Int[np.ndarray, " step"]
    occupied: Bool[np.ndarray, " time"]


def study_view_grids(
    grids: Sequence[ViewGrid],
    glare: PointGlare,
    states: States,
    *,
    every_state: Sequence[States],
    hours: Hours,
    folder: Path,
    display: Display,
) -> xr.Dataset:
    """Return the annual glare of view grids; hourly values are in a file in `folder`.

    Parameters
    ----------
    glare : function that computes the glare of one position
    states : shade states of each window group over time
    every_state : further operations for which grids with `by_state` have figures, such
        as all groups in their first state
    hours : time steps; values are NaN in those without daylight
    """
    if not grids:
        return xr.Dataset()
    cases = [states, *every_state] if any(g.table.by_state for g in grids) else [states]
    rows = grid_rows(grids)
    figures = GridFigures.blank(len(cases), rows[-1].stop)
    worst = [WorstMoment()] * len(grids)
    with _hourly_file(folder / _FILE, rows[-1].stop, len(hours.times)) as variables:
        for place, (grid, own) in enumerate(zip(grids, rows, strict=True)):
            report, count = display(f"view grid {grid.name}"), grid.table.directions
            for number in range(len(grid)):
                first = own.start + number * count
                views = slice(first, first + count)
                for case, operation in enumerate(
                    cases[: None if grid.table.by_state else 1]
                ):
                    found = glare(grid, number, operation, hours.lit)
                    figures.put(case, views, _figures(found, hours))
                    if case == 0:
                        _write(variables, views, found, hours)
                        worst[place] = _worse(worst[place], found, first, hours)
                report((number + 1) / len(grid), f"{number + 1} of {len(grid)}")
    data = xr.open_dataset(folder / _FILE, engine="h5netcdf", cache=False)
    return (
        data.assign_coords(grid_labels(grids) | {"time": hours.times})
        .assign(figures.variables())
        .assign(disturbed_shares(grids, figures) | worst_moments(worst))
    )


def _worse(
    worst: WorstMoment, found: xr.Dataset, first: int, hours: Hours
) -> WorstMoment:
    used = hours.occupied[hours.lit]
    dgp, error = (found[name].values[:, used] for name in ("dgp", "dgp_error"))
    return worst.among(dgp, error, first=first, steps=hours.lit[used])


@contextmanager
def _hourly_file(
    path: Path, views: int, steps: int
) -> Iterator[Mapping[str, h5netcdf.Variable]]:
    with replace_path(path) as made, h5netcdf.File(made, "w") as stored:
        stored.dimensions = {VIEWS: views, "time": steps}
        variables = {}
        for name, (own, unit) in _HOURLY.items():
            variables[name] = hourly_variable(stored, own, (VIEWS, "time"))
            variables[name].attrs["units"] = unit
        yield variables


def _write(
    variables: Mapping[str, h5netcdf.Variable],
    views: slice,
    found: xr.Dataset,
    hours: Hours,
) -> None:
    for name, variable in variables.items():
        values = np.full((found.sizes["view"], len(hours.times)), np.nan, np.float32)
        values[:, hours.lit] = found[name].values
        variable[views] = values


def _figures(found: xr.Dataset, hours: Hours) -> ViewFigures:
    # Dark occupied hours count as free of glare
    parts = []
    for name in ("dgp", "dgp_error"):
        values = np.zeros((found.sizes["view"], len(hours.times)))
        values[:, hours.lit] = found[name].values
        parts.append(values[:, hours.occupied])
    return view_figures(*parts)
