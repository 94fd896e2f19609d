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
from jaxtyping import Bool

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
    counted = within_hours(data, hours)
    if statistic == "mean":
        counted = counted.astype(float)
    reduce = getattr(counted, statistic)
    found: xr.DataArray = reduce("time", skipna=False, keep_attrs=True)
    return found.astype(float)


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
    counted = within_hours(illuminance, hours)
    return _share_at(counted, target_lux).assign_attrs(units="1")


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
    counted = within_hours(illuminance, hours).astype(float)

    # To avoid bias, negative illuminance (noise of direct correction) is not clipped
    return (counted / target_lux).clip(max=1).mean("time").assign_attrs(units="1")


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
    counted = within_hours(illuminance, hours)
    low, middle, high = (_share_at(counted, limit) for limit in limits_lux)
    shares = [1 - low, low - middle, middle - high, high]
    band = xr.DataArray(list(USEFUL_RANGES), dims="band", name="band")
    return xr.concat(shares, dim=band).assign_attrs(units="1")


def _share_at(illuminance: xr.DataArray, limit: float) -> xr.DataArray:
    # Fraction of the hours at a limit or above it: NumPy counts whole rows faster than
    # it averages
    lit = illuminance.transpose(..., "time")
    reached = lit.values >= limit
    rows = reached.reshape(-1, reached.shape[-1])
    count = np.fromiter(map(np.count_nonzero, rows), float, len(rows))
    share = count.reshape(reached.shape[:-1]) / reached.shape[-1]
    return lit.isel(time=0, drop=True).copy(data=share).drop_attrs()


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
