"""Occupied hours: time steps at which metrics are evaluated."""

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.errors import InputError


def occupied_hours(
    times: np.ndarray, *, from_hour: float = 8.0, to_hour: float = 18.0
) -> Bool[np.ndarray, " time"]:
    """Mask of the steps with the centre between two hours, on every day of the week.

    >>> day = np.datetime64("2001-06-21T00:30") + np.arange(24) * np.timedelta64(1, "h")
    >>> int(occupied_hours(day).sum())
    10
    """
    if not 0 <= from_hour < to_hour <= 24:
        raise InputError(
            f"schedule from {from_hour:g} to {to_hour:g} h;"
            " two increasing hours between 0 and 24 expected"
        )
    moments = np.asarray(times).astype("datetime64[s]")
    hour = (moments - moments.astype("datetime64[D]")) / np.timedelta64(3600, "s")
    return np.asarray((hour >= from_hour) & (hour < to_hour))


def within_hours(data: xr.DataArray, hours: Bool[np.ndarray, " time"]) -> xr.DataArray:
    """Return the data of the selected time steps."""
    if len(hours) != data.sizes["time"]:
        raise InputError(
            f"a mask of {len(hours)} hours for {data.sizes['time']} time steps;"
            " one value per time step expected"
        )
    if not np.any(hours):
        raise InputError("no time step lies within the schedule; at least one expected")
    return data.isel(time=np.flatnonzero(hours))
