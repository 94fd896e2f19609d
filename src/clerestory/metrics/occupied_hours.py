"""Occupied hours: time steps at which metrics are evaluated."""

from typing import TypeVar

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.checks import require, same_length

Hourly = TypeVar("Hourly", xr.DataArray, xr.Dataset)


def occupied_hours(
    times: np.ndarray, *, from_hour: float = 8.0, to_hour: float = 18.0
) -> Bool[np.ndarray, " time"]:
    """Mask of the time steps whose centres are between two hours, on every day.

    >>> day = np.datetime64("2001-06-21T00:30") + np.arange(24) * np.timedelta64(1, "h")
    >>> int(occupied_hours(day).sum())
    10
    """
    require(
        0 <= from_hour < to_hour <= 24,
        f"schedule from {from_hour:g} to {to_hour:g} h; two increasing hours between 0"
        " and 24 expected",
    )
    moments = np.asarray(times).astype("datetime64[s]")
    hour = (moments - moments.astype("datetime64[D]")) / np.timedelta64(3600, "s")
    return np.asarray((hour >= from_hour) & (hour < to_hour))


def within_hours(data: Hourly, hours: Bool[np.ndarray, " time"]) -> Hourly:
    """Return the data of the time steps selected by a mask."""
    same_length(hours, data["time"], "values of the mask", "time steps")
    require(np.any(hours), "no time step is within the schedule; at least one expected")
    return data if np.all(hours) else data.isel(time=np.flatnonzero(hours))
