"""Daylighting credits of BREEAM (Hea 01, 4b) of the grids of a recipe.

The use of a room is its program in the model, such as
`BREEAM::Education_buildings::Preschools`; other rooms are offices. Files and keys are
those that Ladybug Tools' postprocessing package writes.
"""

import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from clerestory.files import make_folder, write_text
from clerestory.metrics.breeam import illuminance_criterion
from clerestory.metrics.breeam_space_types import (
    SpaceType,
    program_of,
    space_type_of_program,
)
from clerestory.metrics.honeybee_writer import GridRecord
from clerestory.recipes.annual import AnnualLight, annual_light
from clerestory.recipes.grid_summary import write_values
from clerestory.recipes.model import RecipeModel
from clerestory.recipes.outputs import write_illuminance
from clerestory.study.job import Display


class _Space(NamedTuple):
    # Hours of a grid with sufficient mean and lowest illuminance, for the most credits,
    # and which limits of its type are met
    record: GridRecord
    type: SpaceType
    area: float
    mean_hours: float
    worst_hours: float
    met: tuple[tuple[bool, bool], ...]
    darkest: int

    @property
    def grade(self) -> int:
        """3: limits are met; 2, 1: the mean or the lowest illuminance is sufficient."""
        if (True, True) in self.met:
            return 3
        mean, worst = self.met[-1]
        return 2 if mean else int(worst)

    @property
    def hours(self) -> dict[str, float]:
        """Hours by the key in files."""
        return {
            "average-illuminance-hours": self.mean_hours,
            "minimum-illuminance-hours": self.worst_hours,
        }


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
    programs = defaultdict[str, list[_Space]](list)
    grids, lowest, grades = {}, {}, {}
    for grid in light.grids:
        known = space_type_of_program(chosen.programs.get(grid.full_id, ""))
        area = grid.count * cells[grid.full_id]
        space = _space(grid, known, area, light.total(grid))
        programs[program_of(known)].append(space)
        grids[grid.full_id] = {
            "type": known.building,
            "program-type": program_of(known),
            "display-name": grid.name,
            **space.hours,
        }
        lowest[grid.full_id] = _sensor(chosen, grid.name, space.darkest)
        grades[grid.full_id] = np.full(grid.count, space.grade)
    summary = [_program(name, spaces) for name, spaces in programs.items()]
    make_folder(place)
    for name, content in (
        ("summary", _buildings(summary)),
        ("program_summary", summary),
        ("grid_summary", grids),
        ("minimum_illuminance_sensors", lowest),
    ):
        write_text(place / f"{name}.json", json.dumps(content, indent=2))
    write_values(place / "pass_fail", light.grids, grades, suffix="pf", digits=0)


def _space(
    grid: GridRecord, known: SpaceType, area: float, total: np.ndarray
) -> _Space:
    lux = xr.DataArray(total, dims=("sensor", "time"))
    found = [
        illuminance_criterion(
            lux, mean_lux=own.mean_lux, worst_lux=own.worst_lux, hours=own.hours
        )
        for own in known.limits
    ]
    pairs = zip(known.limits, found, strict=True)
    return _Space(
        *(grid, known, area, found[0].mean_hours, found[0].worst_hours),
        tuple((x.mean_hours >= y.hours, x.worst_hours >= y.hours) for y, x in pairs),
        int((total >= known.limits[0].worst_lux).sum(axis=1).argmin()),
    )


def _program(name: str, spaces: Sequence[_Space]) -> dict[str, Any]:
    # Credits of the spaces of one program: the most whose limits are met
    known = spaces[0].type
    areas = np.array([space.area for space in spaces])
    total = areas.sum()
    complying = 0.0
    for number, limits in enumerate(known.limits):
        met = np.array([all(space.met[number]) for space in spaces])
        complying = float(areas[met].sum())
        comply = bool(complying >= limits.share_of_area * total - 1e-9)
        if comply:
            break
    hours = np.array([list(space.hours.values()) for space in spaces])
    return {
        "program_type": name,
        "comply": comply,
        "credits": limits.credits if comply else 0,
        "total_area": round(float(total), 4),
        "area_comply": round(complying, 4),
        "area_comply_%": 100 * complying / float(total),
        "type": known.building,
        **dict(zip(spaces[0].hours, (areas @ hours / total).tolist(), strict=True)),
    }


def _buildings(programs: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    # Credits of each type of building: the least of those of its programs
    found = []
    for kind in dict.fromkeys(program["type"] for program in programs):
        own = [program for program in programs if program["type"] == kind]
        comply = all(program["comply"] for program in own)
        found.append(
            {
                "type": kind,
                "comply": comply,
                "credits": min(program["credits"] for program in own) if comply else 0,
                "total_area": sum(program["total_area"] for program in own),
            }
        )
    return found


def _sensor(chosen: RecipeModel, name: str, number: int) -> dict[str, list[float]]:
    sensors = chosen.model.grids[name]
    return {
        "pos": sensors.position[number].tolist(),
        "dir": sensors.direction[number].tolist(),
    }
