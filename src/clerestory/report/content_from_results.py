"""Content of a report from the results of a run."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.metrics.climate_based_metrics import TARGET_LUX
from clerestory.metrics.sensor_metrics import sensor_metrics
from clerestory.phases.methods import METHODS
from clerestory.report.content import (
    FactTable,
    ReportContent,
    Room,
    SensorPoints,
    WindowSurface,
)
from clerestory.report.uncertain_value import setting_label, setting_rows
from clerestory.report.window_states import rule_words
from clerestory.study.results import Results
from clerestory.study.title_block import title_block_of

_SHOWN_ELSEWHERE = (
    *("title", "study", "seconds", "warnings", "selection"),
    *("matrices", "output", "report"),
)
_STUDY_ORDER = ("scene", "window", "sensors", "weather", "sky", "trace", "schedule")
# Largest number of sensors on a page
_MOST_SENSORS = 5000

_METRICS = ("mean_illuminance", "daylight_autonomy", "useful", "useful_bands")


def from_results(
    results: Results,
    *,
    pictures: str | Path | None = None,
    most_sensors: int = _MOST_SENSORS,
) -> ReportContent:
    """Return the report content of a run; `pictures` is the folder of its pictures.

    If there are more than `most_sensors` sensors, an even selection is contained.
    """
    results = results.thinned(most_sensors)
    data, run = results.data, results.run
    study = json.loads(data.attrs.get("study", "{}"))
    occupied = np.asarray(data["occupied"].values, dtype=bool)
    if not occupied.any():
        occupied = np.ones(len(occupied), dtype=bool)
    return ReportContent(
        title=results.title,
        method=str(data.attrs.get("method", "")),
        place=place_words(data.attrs, study),
        data=data,
        times=data["time"].values,
        illuminance=np.asarray(data["illuminance"].values, dtype=np.float32),
        standard_error=np.asarray(data["standard_error"].values, dtype=np.float32),
        occupied=occupied,
        schedule=schedule_words(study.get("schedule", {}), data["time"].values),
        metrics=_metrics(data, occupied),
        sensors=SensorPoints(
            tuple(map(str, data["sensor"].values)),
            tuple(map(str, data["grid"].values)),
            np.asarray(data["position"].values, dtype=float),
            np.asarray(data["direction"].values, dtype=float),
        ),
        room=_room(data),
        windows=_windows(data),
        north=math.radians(float(study.get("sky", {}).get("rotation_deg", 0.0))),
        tables=study_tables(study) + run_tables(run),
        seconds={str(k): float(v) for k, v in dict(run.get("seconds", {})).items()},
        warnings=tuple(map(str, run.get("warnings", ()))),
        selection=str(run.get("selection", "")),
        picture_folder=None if pictures is None else Path(pictures),
        title_block=title_block_of(run),
    )


def place_words(attrs: Mapping[Any, Any], study: Mapping[str, Any]) -> str:
    """Return name, latitude and longitude of the weather location, if known.

    >>> place_words({"place": "Oslo", "latitude_deg": 59.9, "longitude_deg": 10.6}, {})
    'Oslo (59.90° N, 10.60° E)'
    """
    place = str(attrs.get("place") or study.get("weather", {}).get("file", ""))
    if "latitude_deg" not in attrs or "longitude_deg" not in attrs:
        return place
    latitude, longitude = float(attrs["latitude_deg"]), float(attrs["longitude_deg"])
    north = f"{abs(latitude):.2f}° {'N' if latitude >= 0 else 'S'}"
    east = f"{abs(longitude):.2f}° {'E' if longitude >= 0 else 'W'}"
    return f"{place} ({north}, {east})".strip()


def schedule_words(schedule: Mapping[str, Any], times: np.ndarray) -> str:
    """Return text that states the occupied hours, for the days of some time steps.

    >>> dates = np.array(["2023-03-21T12:30", "2023-03-22T12:30", "2023-06-21T12:30"])
    >>> times, hours = dates.astype("datetime64[s]"), {"from_hour": 8, "to_hour": 17.5}
    >>> schedule_words(hours, times[:2])
    'every day from 08:00 to 17:30'
    >>> schedule_words(hours, times)
    'on 3 days from 08:00 to 17:30'
    """
    if not schedule:
        return "at all hours"
    hours = schedule.get("from_hour", 8), schedule.get("to_hour", 18)
    start, end = (f"{int(hour):02d}:{round(hour % 1 * 60):02d}" for hour in hours)
    days = np.unique(times.astype("datetime64[D]"))
    gaps = len(days) <= (days[-1] - days[0]).astype(int)
    which = f"on {len(days)} days" if gaps else "every day"
    return f"{which} from {start} to {end}"


def study_tables(study: Mapping[str, Any]) -> tuple[FactTable, ...]:
    """Return the parameters of a study, one table per table of the study file."""
    tables = []
    chosen = study.get("method", "")
    methods = chosen if isinstance(chosen, list) else [chosen]
    never = all(METHODS[m].correction == "never" for m in methods if m in METHODS)
    hidden = (*_SHOWN_ELSEWHERE, "sun") if never else _SHOWN_ELSEWHERE
    ordered = dict.fromkeys([*(n for n in _STUDY_ORDER if n in study), *study])
    for name in (name for name in ordered if name not in hidden):
        value = study[name]
        for group in value if isinstance(value, list) else [value]:
            if isinstance(group, dict) and group:
                title = " ".join(filter(None, (name, str(group.get("name") or ""))))
                shown = {_label(k): v for k, v in group.items() if k != "name"}
                if isinstance(group.get("control"), dict):
                    shown["Control"] = rule_words(group["control"])
                tables.append(FactTable(_label(title), setting_rows(shown)))
    return tuple(tables)


def run_tables(run: Mapping[str, Any]) -> tuple[FactTable, ...]:
    """Return versions, seeds, compute device and other records of a run as tables."""
    shown = {k: v for k, v in run.items() if k not in _SHOWN_ELSEWHERE}
    plain = {_label(k): v for k, v in shown.items() if not isinstance(v, dict | list)}
    tables = [FactTable("Run", setting_rows(plain))] if plain else []
    for name, value in shown.items():
        if isinstance(value, dict) and value:
            tables.append(FactTable(_label(name), setting_rows(value)))
    found = [
        bool(dict(facts).get("found")) for facts in run.get("matrices", {}).values()
    ]
    if found:
        counts = {
            "Traced in this run": len(found) - sum(found),
            "Kept from an earlier run": sum(found),
            "Names of their files": "in run.json",
        }
        shown = {key: value for key, value in counts.items() if value}
        tables.append(FactTable("Matrices", setting_rows(shown)))
    return tuple(tables)


def _label(key: str) -> str:
    words = setting_label(key)
    return words[:1].upper() + words[1:]


def _metrics(data: xr.Dataset, occupied: Bool[np.ndarray, " time"]) -> xr.Dataset:
    # Metrics of the run, computed if missing
    if all(f"{name}_components" in data for name in _METRICS):
        return data
    target = float(data.attrs.get("target_lux", TARGET_LUX))
    return sensor_metrics(data, occupied, target_lux=target)


def _room(data: xr.Dataset) -> Room:
    if "triangle" not in data:
        return Room(np.zeros((0, 3, 3)), np.zeros((0, 3)))
    corners = np.asarray(data["triangle"].values, dtype=float)
    if "triangle_colour" not in data:
        return Room(corners, np.full((len(corners), 3), 0.5))
    colour = np.asarray(data["triangle_colour"].values, dtype=float)
    return Room(corners, np.clip(colour, 0, 1))


def _windows(data: xr.Dataset) -> tuple[WindowSurface, ...]:
    if "window_triangle" not in data:
        return ()
    index = data["window_index"].values
    corners, normal, up = (
        data[name].values.astype(float)
        for name in ("window_triangle", "window_normal", "window_up")
    )
    return tuple(
        WindowSurface(str(name), corners[index == k], normal[k], up[k])
        for k, name in enumerate(data["window"].values)
    )
