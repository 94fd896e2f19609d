"""View grids in closed form: glare that falls from the window and with the angle."""

import numpy as np
import xarray as xr

from clerestory.glare.view_grid_metrics import view_figures
from clerestory.study.results import Results
from clerestory.study.view_grid_positions import ViewGrid
from clerestory.study.view_grid_results import (
    GridFigures,
    WorstMoment,
    disturbed_shares,
    grid_labels,
    grid_rows,
    worst_moments,
)
from clerestory.study.view_grid_tables import ViewGridTable


def grid(columns=5, rows=6, name="desks", heights=(1.2,), directions=8):
    """Positions in the analytic room, 6.1 m wide and 9.1 m deep."""
    x, y = np.meshgrid(np.linspace(0.6, 5.5, columns), np.linspace(0.8, 8.3, rows))
    place = np.stack([x.ravel(), y.ravel()], axis=1)
    position = [np.column_stack([place, np.full(len(place), z)]) for z in heights]
    table = ViewGridTable.model_construct(
        name=name, directions=directions, first_azimuth_deg=0.0, by_state=False
    )
    return ViewGrid(table, np.concatenate(position))


def dgp(grid, times):
    """Most glare near the window in y = 0, looking at it, at noon; NaN at night."""
    hour = (times - times.astype("datetime64[D]")) / np.timedelta64(1, "h")
    sun = np.clip(np.cos((hour - 12) / 6 * np.pi / 2), 0, None)
    near = np.exp(-grid.position[:, 1] / 4)
    towards = (1 - np.cos(np.radians(grid.azimuths_deg))) / 2
    value = 0.16 + 0.5 * near[:, None, None] * towards[:, None] * sun
    lit = np.abs(hour - 12) < 6
    return np.where(lit, value, np.nan).astype(np.float32)


def with_view_grids(results, *grids, states=0):
    """Add view grids to results."""
    data = results.data
    times, occupied = data["time"].values, data["occupied"].values.astype(bool)
    hourly = np.concatenate([dgp(one, times).reshape(-1, len(times)) for one in grids])
    error = (0.02 * hourly).astype(np.float32)
    figures = GridFigures.blank(1 + states, len(hourly))
    for case in range(1 + states):
        part = view_figures((0.8**case * hourly)[:, occupied], error[:, occupied])
        figures.put(case, slice(0, len(hourly)), part)
    axes = ("grid_view", "time")
    more = xr.Dataset(
        {
            "grid_view_dgp": (axes, hourly),
            "grid_view_dgp_error": (axes, error),
            "grid_view_illuminance": (axes, 1000 * hourly),
        },
        coords=grid_labels(grids) | {"time": times},
    )
    more = more.assign(figures.variables()).assign(disturbed_shares(grids, figures))
    rows = grid_rows(grids)
    lit = np.flatnonzero(occupied & np.isfinite(hourly[0]))
    worst = [
        WorstMoment().among(
            hourly[own][:, lit], error[own][:, lit], first=own.start, steps=lit
        )
        for own in rows
    ]
    more = more.assign(worst_moments(worst))
    return Results(data.merge(more), results.run)
