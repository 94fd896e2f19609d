"""Run a study: read, trace, multiply, judge, save.

Whatever kills a run, the next one gives the same results to the bit: traced
matrices are kept as soon as they are whole, all else is computed again, and
results.nc is written last.
"""

import platform
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from clerestory import __version__
from clerestory.engine.device import resolve
from clerestory.errors import ClerestoryWarning
from clerestory.files import make_folder
from clerestory.metrics.hours import occupied_hours
from clerestory.metrics.summary import sensor_metrics
from clerestory.phases.store import MatrixStore
from clerestory.scene.check import check_scene
from clerestory.study.config import Study
from clerestory.study.drawing import room_drawing, window_drawing
from clerestory.study.inputs import Inputs, read_inputs
from clerestory.study.outputs import write_hourly, write_ill, write_metrics
from clerestory.study.results import Results, save_results, sensor_names
from clerestory.study.tracing import (
    Display,
    Tracing,
    study_job,
    study_skies,
    trace_study,
)
from clerestory.study.views import study_views

MATRIX_FOLDER = "matrices"
_PACKAGES = ("mitsuba", "drjit", "numpy", "xarray", "pvlib")


@dataclass
class _Log:
    # What a run notes about itself
    seconds: dict[str, float] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time a phase; note its warnings, and pass them on when it ends."""
        start = time.perf_counter()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", ClerestoryWarning)
            yield
        self.seconds[name] = round(time.perf_counter() - start, 3)
        for item in caught:
            if issubclass(item.category, ClerestoryWarning):
                self.warnings.append(str(item.message))
            warnings.warn_explicit(
                item.message, item.category, item.filename, item.lineno
            )


def run_study(
    study: Study, *, out: str | Path, display: Display | None = None
) -> Results:
    """Run a study and write its results into a folder, made if need be.

    Parameters
    ----------
    study : from `read_study`
    out : gets `results.nc`, `run.json`, the tables asked for, and `matrices/`
    display : starts the display of a long phase, given its name; returns a callable
        (share done 0…1, note)

    Raises
    ------
    InputError : a file of the study is wrong
    DeviceError : no usable compute device
    OutputError : the folder cannot be written
    """
    out, log, display = make_folder(out), _Log(), display or _silent
    with log.phase("read"):
        inputs = read_inputs(study)
    with log.phase("check"):
        _warn_of_doubts(inputs)
    store = MatrixStore(out / MATRIX_FOLDER)
    with log.phase("trace"):
        tracing = trace_study(study, inputs, store=store, display=display)
    with log.phase("sky"):
        skies = study_skies(study, inputs.weather)
    with log.phase("multiply"):
        hourly = tracing.illuminance(skies, display=display)
    with log.phase("pictures"):
        job = study_job(study, inputs, store=store, display=display)
        glare = study_views(
            study, inputs, tracing, skies, job=job, out=out, display=display
        )
    with log.phase("metrics"):
        data = xr.merge(
            [_data(study, inputs, hourly), glare], combine_attrs="drop_conflicts"
        )
    with log.phase("write"):
        results = Results(data, {})
        _write_tables(study, results, out)
    results = Results(data, _facts(study, tracing, data, log))
    save_results(results, out)
    return results


def _silent(_phase: str) -> Any:
    return lambda _share, _note: None


def _warn_of_doubts(inputs: Inputs) -> None:
    sensors = inputs.sensors()
    named = replace(sensors, names=tuple(_sensor_names(inputs)))
    windows = [group.inner for group in inputs.groups]
    for doubt in check_scene(inputs.scene, windows, named):
        warnings.warn(doubt, ClerestoryWarning, stacklevel=2)


def _sensor_names(inputs: Inputs) -> list[str]:
    grids = inputs.grids.items()
    return [name for grid, s in grids for name in sensor_names(grid, len(s))]


def _data(study: Study, inputs: Inputs, hourly: xr.Dataset) -> xr.Dataset:
    # Label the sensors, judge the hours, add what drawings need
    sensors = inputs.sensors()
    grids = np.repeat(list(inputs.grids), [len(s) for s in inputs.grids.values()])
    hours = occupied_hours(
        hourly["time"].values,
        from_hour=study.schedule.from_hour,
        to_hour=study.schedule.to_hour,
    )
    labelled = hourly.assign_coords(
        sensor=np.array(_sensor_names(inputs)),
        grid=("sensor", grids),
        position=(("sensor", "xyz"), sensors.position),
        direction=(("sensor", "xyz"), sensors.direction),
    )
    data = xr.merge(
        [
            labelled.assign(occupied=("time", hours)),
            sensor_metrics(labelled, hours, target_lux=study.metrics.target_lux),
            room_drawing(inputs.scene),
            window_drawing([group.inner for group in inputs.groups]),
        ],
        combine_attrs="drop_conflicts",
    )
    return data.assign_attrs(
        title=study.title,
        method=study.method,
        place=inputs.weather.place,
        latitude_deg=inputs.weather.latitude_deg,
        longitude_deg=inputs.weather.longitude_deg,
        utc_offset_hours=inputs.weather.utc_offset_hours,
        step_minutes=inputs.weather.step_minutes,
        rotation_deg=study.sky.rotation_deg,
        study=study.to_json(),
    )


def _write_tables(study: Study, results: Results, out: Path) -> None:
    if study.output.csv:
        write_metrics(results, out / "metrics.csv")
    for grid in results.grids():
        if study.output.csv:
            write_hourly(results, out / f"illuminance_{grid}.csv", grid=grid)
        if study.output.ill:
            write_ill(results, out / f"{grid}.ill", grid=grid)


def _facts(
    study: Study, tracing: Tracing, data: xr.Dataset, log: _Log
) -> dict[str, Any]:
    # What run.json tells beyond the results themselves
    mean, error = data["mean_illuminance"], data["mean_illuminance_error"]
    relative = (error / mean.where(mean > 0)).groupby("grid").median()
    return {
        "title": study.title,
        "study": study.facts(),
        "versions": {"clerestory": __version__, **_versions()},
        "machine": f"{platform.system()} {platform.machine()}",
        "seed": study.trace.seed,
        "device": resolve(study.trace.device),
        "seconds": log.seconds,
        "median_relative_error_of_mean": {
            str(grid): round(float(value), 5)
            for grid, value in zip(
                relative["grid"].values, relative.values, strict=True
            )
        },
        "matrices": {name: {"found": found} for name, found in tracing.found.items()},
        "warnings": log.warnings,
    }


def _versions() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found
