"""Result folders of recipes."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.files import make_folder, write_text
from clerestory.metrics.honeybee import Light
from clerestory.metrics.honeybee_writer import write_grids_info, write_states
from clerestory.recipes.annual import AnnualLight, annual_light, sunlit_hours
from clerestory.recipes.grid_summary import (
    Range,
    read_ranges,
    write_metrics,
    write_summary,
    write_values,
)
from clerestory.recipes.inputs import occupied_steps, thresholds
from clerestory.recipes.model import RecipeModel
from clerestory.recipes.single_sky import (
    daylight_factors,
    point_in_time,
    sky_views,
)
from clerestory.study.job import Display

Inputs = Mapping[str, Any]


def annual_daylight(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> None:
    """Write hourly illuminance, daylight autonomy and UDI of each grid."""
    limits = thresholds(values["thresholds"])
    ranges = read_ranges(values["grid-metrics"])
    occupied_steps(values["schedule"], np.arange(8760) + 0.5)
    light = annual_light(chosen, values, folder=folder, display=display)
    occupied = occupied_steps(values["schedule"], light.hours)
    write_daylight(folder, light, occupied, limits=limits, ranges=ranges)


def write_daylight(
    folder: Path,
    light: AnnualLight,
    occupied: Bool[np.ndarray, " time"],
    *,
    limits: Mapping[str, float],
    ranges: Sequence[Range],
) -> None:
    """Write hourly illuminance, and autonomy and UDI over the occupied time steps."""
    target, low, high = (limits[key] for key in ("-t", "-lt", "-ut"))
    metrics: dict[str, dict[str, np.ndarray]] = {
        name: {} for name in ("da", "cda", "udi", "udi_lower", "udi_upper")
    }
    for grid in light.grids:
        lux = light.total(grid)[:, occupied]
        for name, share in (
            ("da", lux >= target),
            ("cda", np.minimum(lux / target, 1)),
            ("udi", (lux >= low) & (lux <= high)),
            ("udi_lower", lux < low),
            ("udi_upper", lux > high),
        ):
            metrics[name][grid.full_id] = 100 * share.mean(axis=1)
    write_illuminance(folder, light)
    write_metrics(folder / "metrics", light.grids, metrics)
    write_summary(folder / "grid_summary.csv", light.grids, metrics, ranges)


def write_illuminance(folder: Path, light: AnnualLight) -> None:
    """Write hourly illuminance of all light paths and states."""
    results = folder / "results"
    write_states(
        results, light.grids, light.times, light.paths, timestep=light.timestep
    )


def annual_irradiance(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> None:
    """Write hourly irradiance, and its mean, maximum and sum over the weather file."""
    light = _irradiance(chosen, values, folder, display)
    _write_hourly(folder / "results" / "total", light, "total")
    _write_hourly(folder / "results" / "direct", light, "direct")
    for metric, found in _radiation(light).items():
        write_values(folder / "metrics" / metric, light.grids, found, suffix="res")


def cumulative_radiation(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> None:
    """Write the mean irradiance and the sum of the radiation over the weather file."""
    light = _irradiance(chosen, {**values, "output-type": "solar"}, folder, display)
    found = _radiation(light)
    for metric in ("average_irradiance", "cumulative_radiation"):
        write_values(
            folder / "results" / metric, light.grids, found[metric], suffix="res"
        )


def direct_sun_hours(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> None:
    """Write the time steps with direct sun, and their sum in hours."""
    light = sunlit_hours(chosen, values, display=display)
    results = folder / "results"
    _write_hourly(results / "direct_sun_hours", light, "direct", scale=1, digits=0)
    total = {
        grid.full_id: light.total(grid).sum(axis=1) / light.timestep
        for grid in light.grids
    }
    write_values(results / "cumulative", light.grids, total, suffix="res")


def daylight_factor(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> None:
    """Write the daylight factor of each sensor."""
    ranges = read_ranges(values["grid-metrics"])
    found = daylight_factors(chosen, values, display=display)
    write_values(folder / "results", chosen.grids, found, suffix="res", digits=4)
    metrics = {"daylight-factor": found}
    write_summary(folder / "grid_summary.csv", chosen.grids, metrics, ranges)


def sky_view(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> None:
    """Write the sky view of each sensor."""
    found = sky_views(chosen, values, display=display)
    place = folder / "results" / "sky_view"
    write_values(place, chosen.grids, found, suffix="res", digits=4)


def point_in_time_grid(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> None:
    """Write the illuminance or irradiance of each sensor at one time."""
    found = point_in_time(chosen, values, display=display)
    place = folder / "results" / "pit"
    write_values(place, chosen.grids, found, suffix="res", digits=4)


def _irradiance(
    chosen: RecipeModel, values: Inputs, folder: Path, display: Display
) -> AnnualLight:
    kind = values["output-type"]
    return annual_light(chosen, values, folder=folder, display=display, spectrum=kind)


def _radiation(light: AnnualLight) -> dict[str, dict[str, np.ndarray]]:
    # Mean and maximum irradiance [W/m²], and sum [kWh/m²], over all time steps
    found: dict[str, dict[str, np.ndarray]] = {
        name: {}
        for name in ("average_irradiance", "peak_irradiance", "cumulative_radiation")
    }
    for grid in light.grids:
        watts = light.total(grid).astype(float) / LUMINOUS_EFFICACY
        found["average_irradiance"][grid.full_id] = watts.mean(axis=1)
        found["peak_irradiance"][grid.full_id] = watts.max(axis=1)
        total = watts.sum(axis=1) / light.timestep / 1000
        found["cumulative_radiation"][grid.full_id] = total
    return found


def _write_hourly(
    folder: Path,
    light: AnnualLight,
    kind: Light,
    *,
    scale: float = 1 / LUMINOUS_EFFICACY,
    digits: int = 3,
) -> None:
    # Text matrices, a line for each sensor, of the steps with the sun above the horizon
    write_grids_info(folder, light.grids)
    totals = [light.total(grid, light=kind) for grid in light.grids]
    lit = light.sun_up | np.any([lux.max(axis=0) > 0 for lux in totals], axis=0)
    hours = "\n".join(f"{hour:g}" for hour in light.hours[lit])
    write_text(folder / "sun-up-hours.txt", hours)
    for grid, values in zip(light.grids, totals, strict=True):
        path = folder / f"{grid.full_id}.ill"
        make_folder(path.parent)
        rows = (scale * values[:, lit]).tolist()
        text = "".join("\t".join(f"{x:.{digits}f}" for x in row) + "\n" for row in rows)
        write_text(path, text)
