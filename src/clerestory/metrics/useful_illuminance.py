"""Useful daylight illuminance: too little, useful, too much.

Reference: A. Nabil, J. Mardaljevic, Lighting Research and Technology 37 (1),
2005, with the limits 100, 300 and 3000 lux of their later papers.
"""

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.errors import InputError
from clerestory.metrics.occupied_hours import within_hours

LIMITS_LUX = (100.0, 300.0, 3000.0)
BANDS = ("fell short", "supplementary", "autonomous", "exceeded")


def useful_illuminance(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    limits_lux: tuple[float, float, float] = LIMITS_LUX,
) -> xr.DataArray:
    """Share of the hours, 0…1, that each sensor spends in each band.

    A band holds its lower limit and not its upper one; the four shares sum to 1.
    The useful range of most standards is the sum of the two middle bands.

    Parameters
    ----------
    illuminance : [lux], over (sensor, time)
    hours : which time steps count

    Returns
    -------
    shares over (band, sensor)

    Raises
    ------
    InputError : the limits do not grow

    Examples
    --------
    >>> lux = xr.DataArray([[50.0, 100.0, 300.0, 4000.0]], dims=("sensor", "time"))
    >>> useful_illuminance(lux, np.ones(4, bool)).sel(sensor=0).values.tolist()
    [0.25, 0.25, 0.25, 0.25]
    """
    if not 0 < limits_lux[0] < limits_lux[1] < limits_lux[2]:
        raise InputError(f"limits {limits_lux} lux; three growing numbers expected")
    counted = within_hours(illuminance, hours)
    reached = [(counted >= limit).mean("time") for limit in limits_lux]
    shares = [
        1 - reached[0],
        reached[0] - reached[1],
        reached[1] - reached[2],
        reached[2],
    ]
    band = xr.DataArray(list(BANDS), dims="band", name="band")
    return xr.concat(shares, dim=band).assign_attrs(units="1")
