"""Daylight provision by EN 17037 of the grids of a recipe.

The occupied hours of all metrics are the daylight hours. Files and keys are those that
Ladybug Tools' postprocessing package writes.
"""

import json
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.files import make_folder, write_text
from clerestory.metrics.climate_based_metrics import daylight_autonomy
from clerestory.metrics.compliance import levels_reached
from clerestory.metrics.en17037 import (
    MINIMUM_AREA,
    MINIMUM_LUX,
    SHARE_OF_HOURS,
    TARGET_AREA,
    TARGET_LUX,
    daylight_hours,
)
from clerestory.recipes.annual import AnnualLight, annual_light
from clerestory.recipes.data_collection import hourly_collection
from clerestory.recipes.grid_summary import read_ranges, write_values
from clerestory.recipes.inputs import thresholds
from clerestory.recipes.model import RecipeModel
from clerestory.recipes.outputs import write_daylight
from clerestory.sky.weather_formats import read_weather
from clerestory.study.job import Display

# Illuminances of levels 1 to 3 [lux] and the area that must reach them, by kind
_KINDS = {
    "Minimum Illuminance": (MINIMUM_LUX, MINIMUM_AREA),
    "Target Illuminance": (TARGET_LUX, TARGET_AREA),
}

# Hours with the illuminance, by kind, illuminance and grid [%]
Autonomy = dict[str, dict[float, dict[str, np.ndarray]]]


def annual_daylight_en17037(
    chosen: RecipeModel, values: Mapping[str, Any], folder: Path, display: Display
) -> None:
    """Write annual daylight metrics of the daylight hours, and levels of EN 17037."""
    limits = thresholds(values["thresholds"])
    ranges = read_ranges(values["grid-metrics"])
    inputs = {**values, "wea": values["epw"], "timestep": 1}
    light = annual_light(chosen, inputs, folder=folder, display=display)
    hours = daylight_hours(read_weather(values["epw"]).diffuse_horizontal)
    write_daylight(folder, light, hours, limits=limits, ranges=ranges)
    schedule = hourly_collection(
        "Schedule: Daylight Hours", hours.astype(int), unit="Occupancy"
    )
    write_text(folder / "daylight_hours.json", json.dumps(schedule))
    write_levels(folder / "en17037", chosen, light, hours)


def write_levels(
    folder: Path,
    chosen: RecipeModel,
    light: AnnualLight,
    hours: Bool[np.ndarray, " time"],
) -> None:
    """Write the areas that reach each level in half of the daylight hours."""
    reached: Autonomy = {}
    for kind, (levels, _) in _KINDS.items():
        reached[kind] = {lux: {} for lux in levels}
        for grid in light.grids:
            hourly = xr.DataArray(light.total(grid), dims=("sensor", "time"))
            for lux in levels:
                share = daylight_autonomy(hourly, hours, target_lux=lux).values
                reached[kind][lux][grid.full_id] = 100 * share
    _write(folder, chosen, reached)


def _write(folder: Path, chosen: RecipeModel, reached: Autonomy) -> None:
    # Values of the sensors, and summaries of each grid and of all grids
    grids, weights = chosen.grids, chosen.cell_areas()
    summaries = []
    for grid in grids:
        rows = {
            kind: {lux: each[grid.full_id] for lux, each in by_lux.items()}
            for kind, by_lux in reached.items()
        }
        head = {"Sensor Grid": grid.full_id, "Total Sensors": grid.count}
        area = np.full(grid.count, weights[grid.full_id])
        summaries.append(head | _summary(rows, area, shares=False))
    for kind, by_lux in reached.items():
        for lux, found in by_lux.items():
            name = f"{kind} {lux:g}"
            write_values(folder / "da" / name, grids, found, suffix="da")
            enough = {g: _enough(share) for g, share in found.items()}
            area_shares = {
                g: np.array([100 * each.mean()]) for g, each in enough.items()
            }
            write_values(folder / "sda" / name, grids, area_shares, suffix="sda")
        wanted = 100 * _KINDS[kind][1]
        level = {}
        for grid in grids:
            parts = [100 * _enough(f[grid.full_id]).mean() for f in by_lux.values()]
            own = levels_reached(parts, [wanted] * len(parts))
            level[grid.full_id] = np.full(grid.count, own)
        place = folder / "compliance_level" / kind
        write_values(place, grids, level, suffix="pf", digits=0)
    whole = {
        kind: {
            lux: np.concatenate([found[grid.full_id] for grid in grids])
            for lux, found in by_lux.items()
        }
        for kind, by_lux in reached.items()
    }
    area = np.concatenate([np.full(g.count, weights[g.full_id]) for g in grids])
    total = {"Total Sensors": len(area)} | _summary(whole, area, shares=True)
    make_folder(folder)
    write_text(folder / "summary.json", json.dumps(total, indent=2))
    write_text(folder / "summary_grid.json", json.dumps(summaries, indent=2))


def _enough(share: np.ndarray) -> np.ndarray:
    return np.asarray(share >= 100 * SHARE_OF_HOURS - 1e-9)


def _summary(
    reached: Mapping[str, Mapping[float, np.ndarray]], area: np.ndarray, *, shares: bool
) -> dict[str, Any]:
    # Areas that reach each illuminance in half of the daylight hours [%], and verdicts
    found: dict[str, Any] = {}
    for kind, by_lux in reached.items():
        wanted = 100 * _KINDS[kind][1]
        parts = []
        for lux, share in by_lux.items():
            part = 100 * float(np.average(_enough(share), weights=area))
            parts.append(part)
            row = {"sDA": round(part, 2), "passes": bool(part >= wanted - 1e-9)}
            found[f"{kind} {lux:g}"] = row
        if shares:
            low, middle, high = by_lux
            names = (
                f"High (>= {high:g} lux)",
                f"Medium ({middle:g} - {high:g} lux)",
                f"Minimum ({low:g} - {middle:g} lux)",
                f"Fail (< {low:g} lux)",
            )
            bounds = [0.0, *parts[::-1], 100.0]
            own = [round(b - a, 2) for a, b in pairwise(bounds)]
            found[f"{kind} Sensor Percentage"] = dict(zip(names, own, strict=True))
    return found
