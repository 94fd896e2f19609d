"""Mean and spread of the illuminance over the hours that count."""

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.metrics.occupied_hours import within_hours


def annual_mean(data: xr.DataArray, hours: Bool[np.ndarray, " time"]) -> xr.DataArray:
    """Mean of each sensor over the hours that count, in the unit of the data.

    The mean of the hourly standard errors is an upper limit of the standard
    error of the mean: the hours share the same traced matrices, so their errors
    do not average out.

    Examples
    --------
    >>> lux = xr.DataArray([[100.0, 300.0, 999.0]], dims=("sensor", "time"))
    >>> float(annual_mean(lux, np.array([True, True, False]))[0])
    200.0
    """
    return within_hours(data, hours).astype(float).mean("time", keep_attrs=True)


def annual_median(data: xr.DataArray, hours: Bool[np.ndarray, " time"]) -> xr.DataArray:
    """Median of each sensor over the hours that count, in the unit of the data."""
    return within_hours(data, hours).astype(float).median("time", keep_attrs=True)


def annual_maximum(
    data: xr.DataArray, hours: Bool[np.ndarray, " time"]
) -> xr.DataArray:
    """Maximum of each sensor over the hours that count, in the unit of the data."""
    return within_hours(data, hours).astype(float).max("time", keep_attrs=True)
