"""`clerestory metrics`: daylight metrics of a run or of a honeybee results folder."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from clerestory.checks import require
from clerestory.cli.metrics_input import (
    HOURS_A_YEAR,
    HourlyGrid,
    brightest_half,
    hourly_grids,
)
from clerestory.cli.progress import say
from clerestory.cli.requests.study import Metrics
from clerestory.escaping import csv_line
from clerestory.files import write_text
from clerestory.metrics import climate_based_metrics as climate
from clerestory.metrics import en17037, honeybee_writer
from clerestory.metrics.compliance import assess
from clerestory.metrics.leed import Version, points_error, simulated_daylight
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.replicates import (
    error_of_group_mean,
    errors_of,
    hourly_replicates,
    metric_error,
)
from clerestory.metrics.sensor_metrics import sensor_metrics
from clerestory.metrics.spatial_metrics import (
    RoomShare,
    hours_above,
    spatial_autonomy,
    sunlight_exposure,
)
from clerestory.metrics.standards import standards_named
from clerestory.report.compliance_words import (
    assessment_lines,
    level_words,
    provision_words,
)
from clerestory.report.uncertain_value import Figure
from clerestory.study.compliance_table import assessments_of
from clerestory.study.results import read_results


def metrics(request: Metrics) -> None:
    """Print daylight metrics of each grid; write metrics per sensor to a CSV file."""
    results, names, quiet = request.results, request.grid or [], request.quiet
    found = hourly_grids(request)
    grids = [grid for grid in found if not names or grid.name in names]
    require(grids, f"no grid called {' or '.join(names)} in the results", file=results)
    times = grids[0].lux["time"].values
    hours = occupied_hours(times, from_hour=request.from_hour, to_hour=request.to_hour)
    half = None
    if request.weather is not None:
        half = brightest_half(request.weather, grids[0].lux)
    rows: list[str] = []
    for grid in grids:
        message = f"illuminances of grid {grid.name!r} are not finite"
        known = bool(np.isfinite(grid.lux.values).all())
        require(known, f"{message}; finite numbers expected", file=results)
        say(f"{grid.name}: {grid.lux.sizes['sensor']} sensors", quiet=quiet)
        say(*(f"  {line}" for line in _room(grid, hours, half, request)), quiet=quiet)
        rows += _sensors(grid, hours, request.target)
    say(*_room_and_views(request), quiet=quiet)
    say(*_standards(request, grids), quiet=quiet)
    if request.output is not None:
        write_text(request.output, "\n".join([_HEAD, *rows]) + "\n")
    if request.honeybee is not None:
        direct = {
            g.name: g.sun["illuminance"].values for g in grids if g.sun is not None
        }
        honeybee_writer.write_honeybee(
            request.honeybee,
            {g.name: g.lux.values.astype(float) for g in grids},
            times,
            direct=direct,
        )


# Means over a grid, by label
_MEANS = {
    "daylight autonomy": "daylight_autonomy",
    "continuous autonomy": "continuous_autonomy",
    "useful, 100 to 3000 lux": "useful",
}

_HEAD = (
    "grid,sensor,daylight autonomy [%],continuous autonomy [%],"
    + ",".join(f"{band} [%]" for band in climate.USEFUL_RANGES)
    + ",light exposure [lux h]"
)


def _room_and_views(request: Metrics) -> Iterator[str]:
    # Lines of text: sunlight exposure of the room, and glare of each view
    path = request.results
    if path.is_dir() and (path / "grids_info.json").is_file():
        return
    data = read_results(path).data
    if "room_hours_of_sun" in data:
        hours = float(data["room_hours_of_sun"])
        day = np.datetime_as_string(data["moment"].values[0], unit="D")[5:]
        level = level_words(en17037.sunlight_level(hours))
        yield "room"
        yield f"  {'EN 17037 sunlight':28}{level} ({hours:.1f} h of sun on {day})"
    occupied = occupied_hours(
        data["time"].values, from_hour=request.from_hour, to_hour=request.to_hour
    )
    for view in data["view"].values if "glare_dgp" in data else ():
        dgp = data["glare_dgp"].sel(view=view).values
        valid = occupied & ~np.isnan(dgp)
        if not np.any(valid):
            continue
        level = level_words(en17037.glare_level(dgp, valid))
        top = float(np.quantile(dgp[valid], 1 - en17037.GLARE_SHARE))
        yield f"{view}: view"
        yield f"  {'EN 17037 glare':28}{level} (DGP {top:.2f} in 5 % of the hours)"


def _standards(request: Metrics, grids: list[HourlyGrid]) -> Iterator[str]:
    # Assessments of the chosen standards, by default those of the run
    standards = standards_named(request.standard or [])
    path = request.results
    if path.is_dir() and (path / "grids_info.json").is_file():
        data = _as_results(grids)
        yield from assessment_lines(assess(data, standards))
        return
    data = read_results(path).data
    found = assess(data, standards) if standards else assessments_of(data)
    yield from assessment_lines(found)


def _as_results(grids: list[HourlyGrid]) -> xr.Dataset:
    # Grids of a honeybee folder as results of a run
    total = [grid.hourly["illuminance"] for grid in grids]
    sun = [grid.sun["illuminance"] for grid in grids if grid.sun is not None]
    names = np.repeat([g.name for g in grids], [len(lux) for lux in total])
    lux = xr.concat(total, "sensor").drop_vars("sensor", errors="ignore")
    data = xr.Dataset({"illuminance": lux, "grid": ("sensor", names)})
    hours = occupied_hours(data["time"].values)
    data = data.assign(occupied=("time", hours)).set_coords("grid")
    if len(sun) == len(total):
        direct = xr.concat(sun, "sensor").drop_vars("sensor", errors="ignore")
        above = hours_above(direct, hours)
        data = data.assign(direct_open=direct, sun_hours=above)
    return data


def _room(
    grid: HourlyGrid, hours: np.ndarray, half: np.ndarray | None, request: Metrics
) -> Iterator[str]:
    target, leed = request.target, request.leed
    means = sensor_metrics(grid.hourly, hours, target_lux=target)
    for label, name in _MEANS.items():
        error = error_of_group_mean(means[f"{name}_components"].values)
        yield f"{label:28}{_percent(float(means[name].mean()), error)}"
    reached = spatial_autonomy(grid.lux, hours, **errors_of(grid.hourly))
    by_rule = " (not by LM-83)" if grid.departures else ""
    yield f"{'sDA300/50':28}{_percent(reached.value, reached.error)}{by_rule}"
    yield from _exposed_area(grid, hours, reached, leed)
    if half is not None:
        found = en17037.daylight_provision(grid.lux, half, **errors_of(grid.hourly))
        yield f"{'EN 17037 provision':28}{provision_words(found)}"
    exposed, *varied = map(_exposure, (grid.lux, *hourly_replicates(grid.hourly)))
    stated = f" ± {metric_error(varied):.0f}" if any(varied) else ""
    yield f"{'light exposure':28}{exposed:.0f}{stated} lux h"


def _exposed_area(
    grid: HourlyGrid, hours: np.ndarray, reached: RoomShare, leed: Version
) -> Iterator[str]:
    # Annual sunlight exposure, and LEED points with the given sDA
    if grid.sun is None:
        yield f"{'ASE1000,250':28}unknown; a run with the five-phase method expected"
        if grid.departures:
            yield f"{'not by LM-83':28}{'; '.join(grid.departures)}"
        return
    direct, step = grid.sun["illuminance"], grid.step_hours
    found = sunlight_exposure(direct, hours, step_hours=step, **errors_of(grid.sun))
    most = float(hours_above(direct, hours, step_hours=step).max())
    share = _percent(found.value, found.error)
    yield f"{'ASE1000,250':28}{share}, {most:.0f} h at most{_part_of_year(grid)}"
    credit = simulated_daylight(
        reached.value, found.value, version=leed, departures=grid.departures
    )
    error = points_error(reached, found, version=leed)
    points = f"{credit.points} ± {error:.1f}" if error else f"{credit.points}"
    note = f" ({credit.note})" if credit.note else ""
    yield f"{'LEED ' + leed + ' option 1':28}{points} points{note}"


def _exposure(lux: xr.DataArray) -> float:
    every = np.ones(lux.sizes["time"], bool)
    return float(climate.light_exposure(lux, every).mean())


def _part_of_year(grid: HourlyGrid) -> str:
    # Note if results cover less than the year for which the ASE limit is defined
    hours = grid.lux.sizes["time"] * grid.step_hours
    short = hours < HOURS_A_YEAR - 24
    return f" (of {hours / 24:.0f} days only)" if short else ""


def _sensors(grid: HourlyGrid, hours: np.ndarray, target: float) -> Iterator[str]:
    shares = [
        climate.daylight_autonomy(grid.lux, hours, target_lux=target).values,
        climate.continuous_autonomy(grid.lux, hours, target_lux=target).values,
        *climate.useful_illuminance(grid.lux, hours).values,
    ]
    exposure = climate.light_exposure(
        grid.lux, np.ones(grid.lux.sizes["time"], bool)
    ).values
    columns = np.stack([*(100 * share for share in shares), exposure], axis=1)
    for number, row in enumerate(columns, start=1):
        yield f"{csv_line([grid.name])},{number}," + ",".join(
            f"{value:.6g}" for value in row
        )


def _percent(value: float, error: float) -> str:
    return str(Figure(100 * value, 100 * error, "%"))
