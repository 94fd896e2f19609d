"""Climate-based daylight metrics of sensors over occupied hours.

Annual statistics of illuminance, daylight autonomy, continuous daylight autonomy,
useful daylight illuminance and annual light exposure.

References: C. F. Reinhart, O. Walkenhorst, Energy and Buildings 33 (7), 2001 (daylight
autonomy); Z. Rogers, Architectural Energy Corporation, 2006 (continuous daylight
autonomy); A. Nabil, J. Mardaljevic, Lighting Research and Technology 37 (1), 2005
(useful daylight illuminance, with the limits 100, 300 and 3000 lux of their later
papers); CIE 157:2004, table 3.4 (light exposure).
"""

from typing import Literal

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.checks import require
from clerestory.metrics.occupied_hours import within_hours

TARGET_LUX = 300.0

USEFUL_LIMITS_LUX = (100.0, 300.0, 3000.0)
USEFUL_RANGES = ("fell short", "supplementary", "autonomous", "exceeded")

# Largest annual light exposure of museum objects by responsivity class [lux h]
EXPOSURE_LIMITS = {"high": 15_000.0, "medium": 150_000.0, "low": 600_000.0}


def annual_statistic(
    data: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    statistic: Literal["mean", "median", "max"],
) -> xr.DataArray:
    """Mean, median or maximum illuminance of each sensor over the selected hours.

    >>> lux = xr.DataArray([[100.0, 300.0, 999.0]], dims=("sensor", "time"))
    >>> float(annual_statistic(lux, np.array([True, True, False]), "mean")[0])
    200.0
    """
    counted = within_hours(data, hours).transpose(..., "time")
    found = statistic_over_time(counted.values, statistic)
    return _over_sensors(counted, found).assign_attrs(data.attrs)


def daylight_autonomy(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    target_lux: float = TARGET_LUX,
) -> xr.DataArray:
    """Fraction of the selected hours in which a sensor reaches the target, 0…1.

    >>> lux = xr.DataArray([[100.0, 300.0, 500.0, 900.0]], dims=("sensor", "time"))
    >>> float(daylight_autonomy(lux, np.ones(4, bool))[0])
    0.75
    """
    counted = within_hours(illuminance, hours).transpose(..., "time")
    share = share_at(counted.values, target_lux)
    return _over_sensors(counted, share).assign_attrs(units="1")


def continuous_autonomy(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    target_lux: float = TARGET_LUX,
) -> xr.DataArray:
    """Continuous daylight autonomy: illuminance E below the target counts E / target.

    >>> lux = xr.DataArray([[150.0, 900.0]], dims=("sensor", "time"))
    >>> float(continuous_autonomy(lux, np.ones(2, bool))[0])
    0.75
    """
    counted = within_hours(illuminance, hours).transpose(..., "time")
    share = continuous_share(counted.values, target_lux)
    return _over_sensors(counted, share).assign_attrs(units="1")


def useful_illuminance(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    limits_lux: tuple[float, float, float] = USEFUL_LIMITS_LUX,
) -> xr.DataArray:
    """Fraction of the selected hours in each range of useful daylight illuminance.

    Ranges include the lower but not the upper limit; the four fractions sum to 1. In
    most standards, useful daylight illuminance is within the two middle ranges. The
    dimensions of the result are `band` (range) and `sensor`.

    >>> lux = xr.DataArray([[50.0, 100.0, 300.0, 4000.0]], dims=("sensor", "time"))
    >>> useful_illuminance(lux, np.ones(4, bool)).sel(sensor=0).values.tolist()
    [0.25, 0.25, 0.25, 0.25]
    """
    increasing = 0 < limits_lux[0] < limits_lux[1] < limits_lux[2]
    message = f"limits are {limits_lux} lux; three increasing numbers expected"
    require(increasing, message)
    counted = within_hours(illuminance, hours).transpose(..., "time")
    shares = useful_shares(counted.values, limits_lux)
    each = _over_sensors(counted, shares[0])
    found = each.expand_dims(band=list(USEFUL_RANGES)).copy(data=shares)
    return found.assign_attrs(units="1")


def statistic_over_time(
    lux: Float[np.ndarray, "... time"], statistic: Literal["mean", "median", "max"]
) -> Float[np.ndarray, "..."]:
    """Mean, median or maximum of each row; see `annual_statistic`."""
    if statistic == "mean":
        return np.asarray(lux.mean(axis=-1, dtype=float))
    found = np.median(lux, axis=-1) if statistic == "median" else lux.max(axis=-1)
    return np.asarray(found, dtype=float)


def share_at(
    lux: Float[np.ndarray, "... time"], limit: float
) -> Float[np.ndarray, "..."]:
    """Fraction of the values of each row at a limit or above it, 0…1."""
    # NumPy counts whole rows faster than it averages
    reached = lux >= limit
    rows = reached.reshape(-1, reached.shape[-1])
    count = np.fromiter(map(np.count_nonzero, rows), float, len(rows))
    return np.asarray(count.reshape(reached.shape[:-1]) / reached.shape[-1])


def continuous_share(
    lux: Float[np.ndarray, "... time"], target_lux: float
) -> Float[np.ndarray, "..."]:
    """Continuous autonomy of each row, 0…1; see `continuous_autonomy`."""
    # To avoid bias, negative illuminance (noise of direct correction) is not clipped
    counted = np.minimum(lux, target_lux)
    return np.asarray(counted.mean(axis=-1, dtype=float) / target_lux)


def useful_shares(
    lux: Float[np.ndarray, "... time"],
    limits_lux: tuple[float, float, float] = USEFUL_LIMITS_LUX,
) -> Float[np.ndarray, "band ..."]:
    """Fraction of each row in each range; see `useful_illuminance`."""
    low, middle, high = (share_at(lux, limit) for limit in limits_lux)
    return np.stack([1 - low, low - middle, middle - high, high])


def _over_sensors(counted: xr.DataArray, values: np.ndarray) -> xr.DataArray:
    # Values of the sensors with the labels of hourly data, of which time is last
    found = counted.isel(time=0, drop=True).copy(data=values)
    found.attrs = {}
    return found


def light_exposure(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    step_hours: float = 1.0,
) -> xr.DataArray:
    """Annual light exposure of each sensor over the selected hours [lux h].

    >>> lux = xr.DataArray([[100.0, 50.0]], dims=("sensor", "time"))
    >>> float(light_exposure(lux, np.ones(2, bool))[0])
    150.0
    """
    received = within_hours(illuminance, hours).astype(float).sum("time") * step_hours
    return received.assign_attrs(units="lux h")
