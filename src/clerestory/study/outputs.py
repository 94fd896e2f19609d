"""Result tables for spreadsheets and other programs.

`.ill` is the Daysim format: a line per time step with month, day and hour of its
centre, then the illuminance of every sensor [lux].
"""

import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from clerestory.control.schedule import StateSchedule, write_schedule
from clerestory.escaping import csv_line, file_stems, table_cell
from clerestory.files import replace_file, write_text
from clerestory.metrics.compliance import Quantity
from clerestory.study.compliance_table import assessments_of
from clerestory.study.config import Study
from clerestory.study.results import Results
from clerestory.study.spectral_table import write_spectra
from clerestory.study.view_grid_outputs import (
    view_grids,
    write_grid_dgp,
    write_grid_views,
)

# Number of time steps that are read at a time
_BLOCK = 730

_LABELS = ("sensor", "grid")

# Quantity in the line of a verdict that has none
_NOTHING = Quantity("", np.nan, "", "")

# Columns of metrics.csv: result variable, heading, conversion factor to the unit
_METRICS = (
    ("mean_illuminance", "mean [lux]", 1),
    ("mean_illuminance_error", "mean, standard error [lux]", 1),
    ("median_illuminance", "median [lux]", 1),
    ("median_illuminance_error", "median, standard error [lux]", 1),
    ("maximum_illuminance", "maximum [lux]", 1),
    ("maximum_illuminance_error", "maximum, standard error [lux]", 1),
    ("daylight_autonomy", "daylight autonomy [%]", 100),
    ("daylight_autonomy_error", "daylight autonomy, standard error [%]", 100),
    ("continuous_autonomy", "continuous autonomy [%]", 100),
    ("continuous_autonomy_error", "continuous autonomy, standard error [%]", 100),
    ("useful", "useful illuminance [%]", 100),
    ("useful_error", "useful illuminance, standard error [%]", 100),
)

# Columns of metrics.csv for melanopic light
_MELANOPIC = (
    ("mean_melanopic_edi", "mean melanopic EDI [lux]", 1),
    ("mean_melanopic_edi_error", "mean melanopic EDI, standard error [lux]", 1),
    ("melanopic_autonomy", "melanopic autonomy [%]", 100),
    ("melanopic_autonomy_error", "melanopic autonomy, standard error [%]", 100),
    ("low_melanopic_days", "days of 136 lux melanopic by noon [%]", 100),
    ("low_melanopic_days_error", "days of 136 lux, standard error [%]", 100),
    ("melanopic_days", "days of melanopic light by noon [%]", 100),
    ("melanopic_days_error", "days of melanopic light, standard error [%]", 100),
    ("total_melanopic_days", "days of melanopic light with electric light [%]", 100),
    ("total_low_melanopic_days", "days of 136 lux with electric light [%]", 100),
)

# Columns of metrics.csv for standards
_OF_STANDARDS = {
    "space": "space",
    "floor_area": "floor area [m2]",
    "sun_hours": "direct sun [h]",
    "daylight_factor": "daylight factor",
    "daylight_factor_error": "daylight factor, standard error",
    "view_width": "width of the view [deg]",
    "view_distance": "distance of the view [m]",
}


def write_tables(study: Study, results: Results, out: Path) -> None:
    """Write the tables selected in the study file into a folder."""
    if study.output.csv:
        write_metrics(results, out / "metrics.csv")
        if "state" in results.data:
            write_states(results, out / "states.csv")
        if "verdict_standard" in results.data:
            write_compliance(results, out / "compliance.csv")
            write_requirements(results, out / "requirements.csv")
        if "dimming" in results.data:
            write_lighting(results, out / "lighting.csv")
        if "sensitivity" in results.data:
            write_sensitivity(results, out / "sensitivity.csv")
        if "energy" in results.data:
            write_energy(results, out / "energy.csv")
        for grid, stem in file_stems(view_grids(results)).items():
            write_grid_views(results, out / f"glare_{stem}.csv", grid=grid)
            write_grid_dgp(results, out / f"dgp_{stem}.csv", grid=grid)
    if study.output.csv and "edi" in results.data:
        write_spectra(results, out / "spectral.csv")
    for grid, stem in file_stems(results.grids()).items():
        if study.output.csv:
            write_hourly(results, out / f"illuminance_{stem}.csv", grid=grid)
        if study.output.ill:
            write_ill(results, out / f"{stem}.ill", grid=grid)


def write_states(results: Results, path: str | Path) -> None:
    """Write the shade states of all window groups, in the format of rule "schedule"."""
    data = results.data
    states = {
        str(name): data["state"].values[number].astype(int)
        for number, name in enumerate(data["window"].values)
    }
    write_schedule(path, StateSchedule(data["time"].values, states))


def write_lighting(results: Results, path: str | Path) -> None:
    """Write dimming level and power [W] of each lighting zone, a line per time step."""
    data = results.data
    zones = [str(name) or "lighting" for name in data["zone"].values]
    figures = np.concatenate([data["dimming"].values, data["lighting_power"].values])
    heads = [*(f"{zone} output" for zone in zones), *(f"{zone} [W]" for zone in zones)]
    _write_over_time(path, data, figures, heads)


def write_energy(results: Results, path: str | Path) -> None:
    """Write energy by use, temperatures and solar radiation, a line per time step."""
    data = results.data
    solar = data["window_solar"].values
    figures = [data["energy"].values, data["operative_temperature"].values, *solar]
    heads = [f"{name} [kWh]" for name in data["energy_use"].values]
    heads += [f"{name} operative [C]" for name in data["thermal_zone"].values]
    heads += [
        f"{window} {part} [W]"
        for part in data["solar_part"].values
        for window in data["energy_window"].values
    ]
    _write_over_time(path, data, np.concatenate(figures), heads)


def _write_over_time(
    path: str | Path, data: xr.Dataset, figures: np.ndarray, heads: list[str]
) -> None:
    # Table with a line per time step and a column for each row of figures
    head = [table_cell(text) for text in heads]
    times = pd.Index(data["time"].values, name="time").strftime("%Y-%m-%d %H:%M")
    table = pd.DataFrame(figures.T, times, head)
    write_text(path, table.to_csv(float_format="%.4g", lineterminator="\n"))


def write_metrics(results: Results, path: str | Path) -> None:
    """Write position, direction and metrics of each sensor, a line per sensor."""
    data = results.data
    table = pd.DataFrame(
        {name: [table_cell(str(x)) for x in data[name].values] for name in _LABELS}
    )
    table[["x [m]", "y [m]", "z [m]"]] = data["position"]
    table[["dx", "dy", "dz"]] = data["direction"]
    for name, heading, factor in _METRICS:
        table[heading] = factor * data[name]
    for name, heading, factor in _MELANOPIC:
        if name not in data:
            continue
        table[heading] = factor * data[name]
    for name, heading in _OF_STANDARDS.items():
        if name in data and data[name].dims == ("sensor",):
            values = data[name].values
            words = values.dtype.kind in "OU"
            table[heading] = [table_cell(str(x)) for x in values] if words else values
    for band in data["useful_bands"]:
        table[f"{band['band'].item()} [%]"] = 100 * band
    text = table.to_csv(index=False, float_format="%.6g", lineterminator="\n")
    write_text(path, text)


def write_compliance(results: Results, path: str | Path) -> None:
    """Write verdicts and quantities of standards, a line per quantity."""
    rows = [
        [
            *(one.standard, one.space, f"{one.area:.6g}", verdict.criterion),
            *(verdict.words, str(verdict.level), f"{verdict.error:.3g}"),
            *(quantity.name, f"{quantity.value:.6g}", f"{quantity.error:.3g}"),
            *(quantity.unit, quantity.limits),
        ]
        for one in assessments_of(results.data)
        for verdict in one.verdicts
        for quantity in verdict.quantities or (_NOTHING,)
    ]
    head = "standard,space,area [m2],criterion,verdict,level,level standard error"
    head += ",quantity,value,standard error,unit,limits"
    _write_lines(path, [head, *(csv_line(row) for row in rows)])


def write_sensitivity(results: Results, path: str | Path) -> None:
    """Write the change of each metric for a change of each material, line by line."""
    rows = _sensitivity_rows(results.data, "sensitivity", ("place", "figure"))
    if "glare_sensitivity" in results.data:
        of = "view", "glare_figure"
        rows += _sensitivity_rows(results.data, "glare_sensitivity", of)
    head = "material,quantity,grid,metric,unit,value,step,metric now,change"
    head += ",standard error of the change"
    _write_lines(path, [head, *(csv_line(row) for row in rows)])


def _sensitivity_rows(
    data: xr.Dataset, name: str, of: tuple[str, str]
) -> list[list[str]]:
    # Lines of all changes of a variable; `of` are the axes of places and metrics
    sizes = data[name].sizes
    rows = []
    for index in np.ndindex(*sizes.values()):
        at = dict(zip(sizes, index, strict=True))
        one = data.isel(at)
        numbers = (
            float(one[name])
            for name in (
                "sensitivity_value",
                f"{name}_step",
                f"{name}_base",
                name,
                f"{name}_error",
            )
        )
        names = (one["parameter"], one["sensitivity_quantity"])
        words = (*(one[axis] for axis in of), one[f"{name}_unit"])
        rows.append(
            [
                *(str(each.values) for each in (*names, *words)),
                *(f"{number:.6g}" for number in numbers),
            ]
        )
    return rows


def write_requirements(results: Results, path: str | Path) -> None:
    """Write the requirements of standards, a line for each space and requirement."""
    rows = [
        [one.standard, one.space, *line]
        for one in assessments_of(results.data)
        for line in one.requirements
    ]
    head = "standard,space,requirement,status,found,expected,to do"
    _write_lines(path, [head, *(csv_line(row) for row in rows)])


def write_hourly(results: Results, path: str | Path, *, grid: str) -> None:
    """Write the illuminance of one grid [lux], a line per time step."""
    chosen = _grid(results, grid)
    names = [str(name) for name in chosen["sensor"].values]
    head = csv_line(["time", *names])
    stamps = np.datetime_as_string(chosen["time"].values, unit="m").tolist()
    rows = zip(stamps, _steps(chosen, ",%.1f"), strict=True)
    lines = (f"{stamp.replace('T', ' ')}{row}" for stamp, row in rows)
    _write_lines(path, itertools.chain([head], lines))


def write_ill(results: Results, path: str | Path, *, grid: str) -> None:
    """Write the illuminance of one grid [lux] in Daysim format."""
    times = pd.DatetimeIndex(results.data["time"].values)
    hours = times.hour + times.minute / 60 + times.second / 3600
    stamps = zip(times.month, times.day, hours, strict=True)
    rows = _steps(_grid(results, grid), " %.1f")
    _write_lines(
        path,
        (
            f"{month} {day} {hour:.3f} {row}"
            for (month, day, hour), row in zip(stamps, rows, strict=True)
        ),
    )


def _steps(chosen: xr.Dataset, form: str) -> Iterator[str]:
    # Row of sensor illuminances as text for each time step; read in blocks
    count, steps = chosen.sizes["sensor"], chosen.sizes["time"]
    line, dark = form * count, (form % 0.0) * count
    for first in range(0, steps, _BLOCK):
        block = slice(first, first + _BLOCK)
        part = chosen["illuminance"].isel(time=block).values.T
        for row, light in zip(part.tolist(), np.any(part, axis=1), strict=True):
            yield line % tuple(row) if light else dark


def _write_lines(path: str | Path, lines: Iterable[str]) -> None:
    with replace_file(path) as stream:
        stream.writelines(f"{line}\n".encode() for line in lines)


def _grid(results: Results, grid: str) -> xr.Dataset:
    members = np.flatnonzero(results.data["grid"].values == grid)
    # The sensors of a grid are contiguous
    return results.data.isel(sensor=slice(members[0], members[-1] + 1))
