"""Annual glare of the grids of a recipe: daylight glare probability of each sensor.

A sensor is an eye, and its direction the line of sight. Sensors at one position share
the tracing. The luminance is that of the cells of the sphere around each position, by
the two-phase method or, for window groups, the five-phase method.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.files import make_folder, write_text
from clerestory.metrics.honeybee_writer import (
    GridRecord,
    hours_of_year,
    write_grids_info,
)
from clerestory.phases.matrix_equation import Skies
from clerestory.progress import silent
from clerestory.recipes.annual import recipe_job
from clerestory.recipes.grid_summary import write_values
from clerestory.recipes.inputs import occupied_steps
from clerestory.recipes.model import RecipeModel
from clerestory.scene.sensors import Sensors
from clerestory.study.glazed_grid_points import grid_points
from clerestory.study.job import Display, Job
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.study_skies import study_skies, study_suns
from clerestory.study.study_tracing import trace_study
from clerestory.study.view_grid_points import Positions
from clerestory.study.view_grid_positions import ViewGrid
from clerestory.study.view_grid_tables import ViewGridTable


def annual_glare(
    chosen: RecipeModel, values: Mapping[str, Any], folder: Path, display: Display
) -> None:
    """Write hourly DGP, and the share of occupied hours without glare of each view."""
    occupied_steps(values["schedule"], np.arange(8760) + 0.5)
    with recipe_job(
        chosen, {**values, "timestep": 1}, folder=folder, display=display
    ) as job:
        eyes = {name: _eyes(name, job.inputs.grids[name]) for name in chosen.records}
        inputs = replace(
            job.inputs, view_grids=tuple(grid for grid, _ in eyes.values())
        )
        job = replace(job, inputs=inputs)
        points, skies = _points(job)
        lit = np.flatnonzero(skies.whole.diffuse.max(axis=0) > 0)
        dgp = {
            chosen.records[name].full_id: _sensors(points, *eye, lit, display)
            for name, eye in eyes.items()
        }
    hours = hours_of_year(job.inputs.weather.times)
    occupied = occupied_steps(values["schedule"], hours)
    limit = values["glare-threshold"]
    write_glare(folder, chosen.grids, dgp, hours[lit], occupied[lit], occupied, limit)


def _points(job: Job) -> tuple[Positions, Skies]:
    # Without window groups no matrix of the sensors is needed
    if job.inputs.groups:
        matrices = trace_study(job)
    else:
        suns = study_suns(job.study, job.inputs.weather)
        matrices = StudyMatrices((), (), suns)
    skies = study_skies(job.study, job.inputs, matrices.suns)
    return grid_points(replace(job, display=silent), matrices, skies), skies


def _eyes(name: str, sensors: Sensors) -> tuple[ViewGrid, Int[np.ndarray, " sensor"]]:
    # View grid of the positions, and the position of each sensor
    places, owner = np.unique(sensors.position.round(6), axis=0, return_inverse=True)
    lines = tuple(sensors.direction[owner == k] for k in range(len(places)))
    return ViewGrid(ViewGridTable(name=name, grid=name), places, lines), owner


def _sensors(
    points: Positions,
    grid: ViewGrid,
    owner: Int[np.ndarray, " sensor"],
    lit: Int[np.ndarray, " step"],
    display: Display,
) -> Float[np.ndarray, "sensor step"]:
    # DGP of the sensors of one grid, position by position, in the first states
    states = [np.zeros(len(points.skies.times), int) for _ in points.job.inputs.groups]
    found = np.zeros((len(owner), len(lit)))
    report = display(f"glare of {grid.name}")
    for number in range(len(grid)):
        glare = points.glare(grid, number, states, lit, errors=False)
        found[owner == number] = np.nan_to_num(glare["dgp"].values)
        report((number + 1) / len(grid), f"{number + 1} of {len(grid)} positions")
    return found


def write_glare(
    folder: Path,
    grids: tuple[GridRecord, ...],
    dgp: Mapping[str, Float[np.ndarray, "sensor step"]],
    hours: Float[np.ndarray, " step"],
    used: Bool[np.ndarray, " step"],
    occupied: Bool[np.ndarray, " time"],
    limit: float,
) -> None:
    """Write DGP, a line for each view, and glare autonomy [%].

    `hours` are the hours of the year of the steps with daylight, and `used` which of
    them are occupied. Dark hours are free of glare; so is a DGP below the `limit`.
    """
    results, autonomy = folder / "results", {}
    write_grids_info(results, grids)
    write_text(results / "sun-up-hours.txt", "\n".join(f"{hour:g}" for hour in hours))
    for grid in grids:
        values = dgp[grid.full_id]
        path = results / f"{grid.full_id}.dgp"
        make_folder(path.parent)
        rows = ("\t".join(f"{x:.6f}" for x in row) + "\n" for row in values.tolist())
        write_text(path, "".join(rows))
        glare = (values[:, used] >= limit).sum(axis=1)
        autonomy[grid.full_id] = 100 * (1 - glare / occupied.sum())
    write_values(folder / "metrics" / "ga", grids, autonomy, suffix="ga")
