"""Daylight autonomy: how often daylight alone is enough.

References: C. F. Reinhart, O. Walkenhorst, Energy and Buildings 33 (7), 2001
(daylight autonomy); Z. Rogers, Architectural Energy Corporation, 2006
(continuous daylight autonomy).
"""

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.metrics.occupied_hours import within_hours

TARGET_LUX = 300.0


def daylight_autonomy(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    target_lux: float = TARGET_LUX,
) -> xr.DataArray:
    """Share of the hours, 0…1, in which each sensor reaches the target.

    Parameters
    ----------
    illuminance : [lux], over (sensor, time)
    hours : which time steps count

    Examples
    --------
    >>> lux = xr.DataArray([[100.0, 300.0, 500.0, 900.0]], dims=("sensor", "time"))
    >>> float(daylight_autonomy(lux, np.ones(4, bool))[0])
    0.75
    """
    counted = within_hours(illuminance, hours)
    return (counted >= target_lux).mean("time").assign_attrs(units="1")


def continuous_autonomy(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    target_lux: float = TARGET_LUX,
) -> xr.DataArray:
    """Share of the target, 0…1, that daylight gives on average; a full hour counts 1.

    Examples
    --------
    >>> lux = xr.DataArray([[150.0, 900.0]], dims=("sensor", "time"))
    >>> float(continuous_autonomy(lux, np.ones(2, bool))[0])
    0.75
    """
    counted = within_hours(illuminance, hours).astype(float)

    # Differences of traced matrices may fall below zero: that noise averages out
    return (counted / target_lux).clip(max=1).mean("time").assign_attrs(units="1")
