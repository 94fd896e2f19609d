"""Annual light exposure: what museums count, lux times hours.

Reference: CIE 157:2004, Control of damage to museum objects by optical radiation,
table 3.4: limits by the sensitivity of materials.
"""

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.metrics.occupied_hours import within_hours

# Lux hours a year; materials that do not respond to light have no limit.
LIMITS_LUX_HOURS = {"high": 15_000.0, "medium": 150_000.0, "low": 600_000.0}


def light_exposure(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    step_hours: float = 1.0,
) -> xr.DataArray:
    """Light that each sensor receives over the hours that count [lux h].

    Parameters
    ----------
    illuminance : [lux], over (sensor, time)
    step_hours : length of a time step [h]

    Examples
    --------
    >>> lux = xr.DataArray([[100.0, 50.0]], dims=("sensor", "time"))
    >>> float(light_exposure(lux, np.ones(2, bool))[0])
    150.0
    """
    received = within_hours(illuminance, hours).astype(float).sum("time") * step_hours
    return received.assign_attrs(units="lux h")
