"""Departures of a simulation from the conditions of IES LM-83.

sDA, ASE and the LEED points that follow from them are defined for a horizontal grid of
sensors at most 2 ft apart, for 8 to 18 h on every day of a year in steps of an hour or
less, and for blinds that close whenever more than 2 % of the sensors receive 1000 lux
or more of direct sunlight.

Reference: IES LM-83-12, Approved Method: spatial daylight autonomy and
annual sunlight exposure; USGBC, LEED v4 and v4.1, EQ credit Daylight.
"""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Float
from scipy.spatial import cKDTree

from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.spatial_metrics import SUN_LUX

FROM_HOUR, TO_HOUR = 8.0, 18.0
MOST_SENSORS = 0.02

# Largest spacing, 2 ft, with a tolerance for rounded coordinates [m]
LARGEST_SPACING = 0.61

_HOURS_A_YEAR = 8760
_LOWEST_UP = 0.999


def departures(
    data: xr.Dataset, *, from_hour: float = FROM_HOUR, to_hour: float = TO_HOUR
) -> tuple[str, ...]:
    """Return the departures from LM-83 of the results of one grid, in words.

    `data` are results of a run, see `Results.data`, for the sensors of one grid.
    """
    found = [*hour_departures(data["time"].values, _step(data), from_hour, to_hour)]
    found += _grid(data)
    found += _shades(data, occupied_hours(data["time"].values))
    return tuple(found)


def hour_departures(
    times: np.ndarray, step_hours: float, from_hour: float, to_hour: float
) -> Iterator[str]:
    """Return the departures of the evaluated hours from LM-83."""
    if (from_hour, to_hour) != (FROM_HOUR, TO_HOUR):
        yield f"hours from {from_hour:g} to {to_hour:g}; 8 to 18 expected"
    if len(times) * step_hours < _HOURS_A_YEAR - 24:
        yield f"{len(times) * step_hours / 24:.0f} days; a whole year expected"
    if step_hours > 1:
        yield f"time steps of {step_hours:g} h; 1 h or less expected"


def grid_spacing(position: Float[np.ndarray, "sensor 3"]) -> float:
    """Return the larger spacing of a grid of sensors in its two directions [m].

    The result is the median over the sensors, and infinite for a single sensor.

    >>> x, y = np.meshgrid(np.arange(4) * 0.5, np.arange(3) * 1.2)
    >>> float(grid_spacing(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)))
    1.2
    """
    places = np.unique(position.round(4), axis=0)
    if len(places) < 2:
        return np.inf
    near = cKDTree(places).query(places, k=range(2, min(len(places), 26) + 1))[1]
    across = places[near] - places[:, None]
    length = np.linalg.norm(across, axis=2)
    nearest = across[:, 0] / length[:, :1]
    beside = np.linalg.norm(np.cross(across, nearest[:, None]), axis=2)

    # Neighbours in the other direction deviate from the nearest one's by 30° or more
    beside = np.where(beside >= 0.5 * length, beside, np.inf).min(axis=1)
    beside = np.where(np.isfinite(beside), beside, length[:, 0])
    return float(np.median(np.maximum(length[:, 0], beside)))


def _step(data: xr.Dataset) -> float:
    return float(data.attrs.get("step_minutes", 60)) / 60


def _grid(data: xr.Dataset) -> Iterator[str]:
    if "position" in data:
        spacing = grid_spacing(data["position"].values)
        if spacing > LARGEST_SPACING:
            wide = f"a spacing of {spacing:.2f} m" if spacing < np.inf else "one sensor"
            yield f"{wide}; a grid of at most 0.6 m (2 ft) expected"
    if "direction" in data and data["direction"].values[:, 2].min() < _LOWEST_UP:
        yield "sensors that do not face up; a horizontal grid expected"


def _shades(data: xr.Dataset, hours: np.ndarray) -> Iterator[str]:
    rules = (
        dict.fromkeys(data["window"].values.tolist(), "") if "window" in data else {}
    )
    if "control" in data:
        several = (data["state_name"].values != "").sum(axis=1) > 1
        names = np.where(several, data["control"].values, "")
        rules = dict(zip(data["window"].values.tolist(), names.tolist(), strict=True))
    for window, rule in rules.items():
        if rule not in ("", "LM-83"):
            yield f'shades of window "{window}" by rule "{rule}"; rule "LM-83" expected'
    tables = _control_tables(data)
    for table in tables:
        limit = table.get("sun_lux", SUN_LUX), table.get("most_sensors", MOST_SENSORS)
        if limit != (SUN_LUX, MOST_SENSORS):
            yield (
                f"blinds that close for more than {limit[1]:.3g} of the sensors above"
                f" {limit[0]:g} lux; 0.02 above 1000 lux expected"
            )
    if any(table.get("when_empty") is not None for table in tables):
        empty = hours & ~data["occupied"].values
        if empty.any():
            yield f'{empty.sum()} of the hours with "when_empty"; none expected'

    # Without shades, no more than 2 % of the sensors may ever be in direct sunlight
    if rules and not any(rules.values()) and "direct_open" in data:
        sunny = (data["direct_open"].values >= SUN_LUX).mean(axis=0) > MOST_SENSORS
        if np.any(sunny & hours):
            yield (
                f"no shades in {np.sum(sunny & hours)} hours with more than 2 % of the"
                " sensors in direct sunlight; blinds expected"
            )


def _control_tables(data: xr.Dataset) -> list[dict[str, Any]]:
    # Tables [window.control] of rule "LM-83" in the study
    study = json.loads(data.attrs.get("study", "{}"))
    tables = [window.get("control") or {} for window in study.get("window", ())]
    return [table for table in tables if table.get("rule") == "LM-83"]
