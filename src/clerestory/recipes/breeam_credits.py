"""Daylighting credits of BREEAM (Hea 01, 4b) of the grids of a recipe.

All grids are occupied spaces of offices. Files and keys are those that Ladybug Tools'
postprocessing package writes.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from clerestory.files import make_folder, write_text
from clerestory.metrics.breeam import (
    CREDITS,
    SHARE_OF_AREA,
    WORST_LUX,
    illuminance_criterion,
)
from clerestory.recipes.annual import AnnualLight, annual_light
from clerestory.recipes.grid_summary import write_values
from clerestory.recipes.model import RecipeModel
from clerestory.recipes.outputs import write_illuminance
from clerestory.study.job import Display

_TYPE = "Office buildings"
_PROGRAM = "BREEAM::Office_buildings::Occupied_spaces"


def breeam_daylight_4b(
    chosen: RecipeModel, values: Mapping[str, Any], folder: Path, display: Display
) -> None:
    """Write hourly illuminance, and the credits of the illuminance criterion."""
    inputs = {**values, "timestep": 1}
    light = annual_light(chosen, inputs, folder=folder, display=display)
    write_illuminance(folder, light)
    write_credits(folder / "breeam_summary", chosen, light)


def write_credits(place: Path, chosen: RecipeModel, light: AnnualLight) -> None:
    """Write the hours of each grid with sufficient light, and the credits of all."""
    cells = chosen.cell_areas()
    spaces, passed, lowest = {}, {}, {}
    total = complying = 0.0
    hours = []
    for grid in light.grids:
        lux = xr.DataArray(light.total(grid), dims=("sensor", "time"))
        found = illuminance_criterion(lux)
        own = _hours(found.mean_hours, found.worst_hours)
        spaces[grid.full_id] = {
            "type": _TYPE,
            "program-type": _PROGRAM,
            "display-name": grid.name,
            **own,
        }
        hours.append(own)
        darkest = int((lux.values >= WORST_LUX).sum(axis=1).argmin())
        lowest[grid.full_id] = _sensor(chosen, grid.name, darkest)
        passed[grid.full_id] = np.full(grid.count, int(found.passed))
        area = grid.count * cells[grid.full_id]
        total, complying = total + area, complying + area * found.passed
    share = 100 * complying / total
    complies = share >= 100 * SHARE_OF_AREA - 1e-9
    credit: dict[str, Any] = {"comply": complies, "credits": CREDITS if complies else 0}
    credit |= {"total_area": round(total, 4)}
    program = {
        "program_type": _PROGRAM,
        **credit,
        "area_comply": round(complying, 4),
        "area_comply_%": share,
        "type": _TYPE,
        **{name: float(np.mean([each[name] for each in hours])) for name in hours[0]},
    }
    make_folder(place)
    for name, content in (
        ("summary", [{"type": _TYPE, **credit}]),
        ("program_summary", [program]),
        ("grid_summary", spaces),
        ("minimum_illuminance_sensors", lowest),
    ):
        write_text(place / f"{name}.json", json.dumps(content, indent=2))
    write_values(place / "pass_fail", light.grids, passed, suffix="pf", digits=0)


def _hours(mean: float, worst: float) -> dict[str, float]:
    return {"average-illuminance-hours": mean, "minimum-illuminance-hours": worst}


def _sensor(chosen: RecipeModel, name: str, number: int) -> dict[str, list[float]]:
    sensors = chosen.model.grids[name]
    return {
        "pos": sensors.position[number].tolist(),
        "dir": sensors.direction[number].tolist(),
    }
