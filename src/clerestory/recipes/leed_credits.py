"""LEED v4.1 credit Daylight, option 1, of the grids of a recipe.

Every grid is a space, whose blinds follow LM-83's rule. Files and keys are those that
Ladybug Tools' postprocessing package writes.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.control.lm83_blinds import (
    MOST_SENSORS,
    SUN_LUX,
    operate_by_direct_sun,
)
from clerestory.files import make_folder, write_text
from clerestory.metrics.climate_based_metrics import TARGET_LUX
from clerestory.metrics.honeybee_writer import GridRecord, write_grids_info
from clerestory.metrics.leed import simulated_daylight
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.spatial_metrics import HALF_OF_THE_HOURS, MOST_HOURS
from clerestory.recipes.annual import AnnualLight, annual_light
from clerestory.recipes.data_collection import hourly_collection
from clerestory.recipes.grid_summary import write_values
from clerestory.recipes.model import RecipeModel
from clerestory.recipes.outputs import write_illuminance
from clerestory.recipes.window_blinds import through_blinds, with_blinds
from clerestory.study.job import Display


class _Space(NamedTuple):
    # Daylight autonomy [%] with operated, open and closed blinds, hours above 1000 lux
    # of direct sun, share of sensors above it over time [%], states of the groups, and
    # time steps that meet the criterion of the blinds
    autonomy: Float[np.ndarray, " sensor"]
    opened: Float[np.ndarray, " sensor"]
    closed: Float[np.ndarray, " sensor"]
    hours: Float[np.ndarray, " sensor"]
    sunlit: Float[np.ndarray, " time"]
    states: Mapping[str, Int[np.ndarray, " time"]]
    kept: Bool[np.ndarray, " time"]

    @property
    def sufficient(self) -> Bool[np.ndarray, " sensor"]:
        return _sufficient(self.autonomy)

    @property
    def unexposed(self) -> Bool[np.ndarray, " sensor"]:
        return np.asarray(self.hours <= MOST_HOURS)


def leed_daylight_option_one(
    chosen: RecipeModel, values: Mapping[str, Any], folder: Path, display: Display
) -> None:
    """Write hourly illuminance, sDA and ASE of each grid, and the points of LEED."""
    specular = values["specular-transmission"]
    shaded = with_blinds(
        chosen, diffuse=values["diffuse-transmission"], specular=specular
    )
    inputs = {**values, "timestep": 1}
    light = annual_light(shaded, inputs, folder=folder, display=display)
    light = through_blinds(light, chosen, specular=specular)
    write_illuminance(folder, light)
    write_points(folder / "leed_summary", chosen, light)


def write_points(place: Path, chosen: RecipeModel, light: AnnualLight) -> None:
    """Write sDA, ASE and the states of the blinds of each grid, and the LEED points."""
    spaces = {grid.full_id: _space(light, grid) for grid in light.grids}
    _write_sensors(place, light, spaces)
    cells = chosen.cell_areas()
    rows = {grid.full_id: _row(grid, spaces[grid.full_id]) for grid in light.grids}
    area = np.concatenate(
        [np.full(grid.count, cells[grid.full_id]) for grid in light.grids]
    )
    summary = _whole(spaces, area)
    schedules: dict[str, np.ndarray] = {}
    failed = {}
    for name, space in spaces.items():
        for group, states in space.states.items():
            schedules.setdefault(group, np.zeros_like(states))
            schedules[group] = np.maximum(schedules[group], states)
        if not space.kept.all():
            failed[name] = np.flatnonzero(~space.kept).tolist()
    for file, content in (
        ("summary", summary),
        ("summary_grid", rows),
        ("states_schedule", {g: states.tolist() for g, states in schedules.items()}),
        ("states_schedule_err", failed),
    ):
        write_text(place / f"{file}.json", json.dumps(content, indent=2))


def _space(light: AnnualLight, grid: GridRecord) -> _Space:
    # Blinds of one space: groups with blinds that give it direct sun are operated
    direct, static = light.by_state(grid, light="direct")
    total, base = light.by_state(grid)
    sunny = {path: lux for path, lux in direct.items() if lux[0].max() > 0}
    states = {path: np.zeros(len(light.times), dtype=int) for path in total}
    opened = static + sum(lux[0] for lux in direct.values())
    kept = (opened >= SUN_LUX).mean(axis=0) <= MOST_SENSORS
    if sunny:
        operation = operate_by_direct_sun(sunny, static=static)
        states, kept = states | operation.states, operation.kept
    steps = np.arange(len(light.times))
    lux = base + sum(each[states[path], :, steps].T for path, each in total.items())
    hours = occupied_hours(light.times)
    sun = opened[:, hours]
    return _Space(
        _autonomy(lux, hours),
        _autonomy(base + sum(each[0] for each in total.values()), hours),
        _autonomy(base + sum(each[-1] for each in total.values()), hours),
        (sun > SUN_LUX).sum(axis=1).astype(float),
        100 * (opened >= SUN_LUX).mean(axis=0) * hours,
        {path: states[path] for path in sunny},
        kept | ~hours,
    )


def _autonomy(
    lux: Float[np.ndarray, "sensor time"], hours: Bool[np.ndarray, " time"]
) -> Float[np.ndarray, " sensor"]:
    return np.asarray(100 * (lux[:, hours] >= TARGET_LUX).mean(axis=1))


def _sufficient(autonomy: Float[np.ndarray, " sensor"]) -> Bool[np.ndarray, " sensor"]:
    return np.asarray(autonomy >= 100 * HALF_OF_THE_HOURS - 1e-9)


def _row(grid: GridRecord, space: _Space) -> dict[str, Any]:
    # Summary of one space
    exposure = 100 * float((~space.unexposed).mean())
    daylit = 100 * float(space.sufficient.mean())
    row = {
        "name": grid.name,
        "full_id": grid.full_id,
        "ase": round(exposure, 2),
        "sda": round(daylit, 2),
        "sda_blinds_up": round(100 * float(_sufficient(space.opened).mean()), 2),
        "sda_blinds_down": round(100 * float(_sufficient(space.closed).mean()), 2),
        "sensor_count_passing_ase": int(space.unexposed.sum()),
        "sensor_count_passing_sda": int(space.sufficient.sum()),
        "total_sensor_count": grid.count,
    }
    credit = simulated_daylight(daylit / 100, exposure / 100)
    return row | ({"ase_note": credit.note} if credit.note else {})


def _whole(
    spaces: Mapping[str, _Space], area: Float[np.ndarray, " sensor"]
) -> dict[str, Any]:
    # Summary of all spaces, weighted by floor area
    good = np.concatenate([space.sufficient for space in spaces.values()])
    calm = np.concatenate([space.unexposed for space in spaces.values()])
    daylit = float(np.average(good, weights=area))
    exposed = float(np.average(~calm, weights=area))
    lowest = min(float(space.sufficient.mean()) for space in spaces.values())
    failed = [name for name, space in spaces.items() if not space.kept.all()]
    credit = simulated_daylight(daylit, exposed, lowest=lowest)
    note = credit.note
    if failed:
        note = "0 points: more than 2 % of the sensors are in direct sunlight with all"
        note += f" blinds closed in {', '.join(failed)}"
    points = 0 if failed else credit.points
    return {
        "ase": round(100 * exposed, 2),
        "sda": round(100 * daylit, 2),
        "floor_area_passing_ase": round(float(area[calm].sum()), 4),
        "floor_area_passing_sda": round(float(area[good].sum()), 4),
        "total_floor_area": round(float(area.sum()), 4),
        "sensor_count_passing_ase": int(calm.sum()),
        "sensor_count_passing_sda": int(good.sum()),
        "total_sensor_count": len(area),
        "credits": points if points < 4 else "Exemplary performance",
        **({"note": note} if note else {}),
    }


def _write_sensors(
    place: Path, light: AnnualLight, spaces: Mapping[str, _Space]
) -> None:
    # Values of each sensor, and the share of sensors in direct sunlight of each hour
    for name, suffix, digits, values in (
        ("results/da", "da", 2, {n: s.autonomy for n, s in spaces.items()}),
        ("results/ase_hours_above", "res", 0, {n: s.hours for n, s in spaces.items()}),
        ("pass_fail/DA", "pf", 0, {n: s.sufficient for n, s in spaces.items()}),
        ("pass_fail/ASE", "pf", 0, {n: s.unexposed for n, s in spaces.items()}),
    ):
        write_values(place / name, light.grids, values, suffix=suffix, digits=digits)
    write_grids_info(place, light.grids)
    folder = place / "datacollections" / "ase_percentage_above"
    write_grids_info(folder, light.grids)
    hours = light.hours.astype(int)
    for name, space in spaces.items():
        year = np.zeros(8760)
        year[hours] = space.sunlit
        made = hourly_collection(
            "Percentage above 1000 direct lux",
            year,
            unit="%",
            metadata={"SensorGrid": name},
        )
        path = folder / f"{name}.json"
        make_folder(path.parent)
        write_text(path, json.dumps(made))
