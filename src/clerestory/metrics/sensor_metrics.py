"""Climate-based metrics of every sensor, with their error components.

The variance of a metric, or of its mean over sensors, is the sum of the squares of its
error components (`metrics.replicates`).
"""

from functools import partial

import numpy as np
import xarray as xr
from jaxtyping import Bool

from clerestory.metrics.climate_based_metrics import (
    TARGET_LUX,
    USEFUL_LIMITS_LUX,
    USEFUL_RANGES,
    annual_statistic,
    continuous_autonomy,
    daylight_autonomy,
    useful_illuminance,
)
from clerestory.metrics.occupied_hours import within_hours
from clerestory.metrics.replicates import with_errors


def sensor_metrics(
    hourly: xr.Dataset,
    hours: Bool[np.ndarray, " time"],
    *,
    target_lux: float = TARGET_LUX,
) -> xr.Dataset:
    """Return the metrics of each sensor over the selected hours.

    Statistics of illuminance are in lux; all other metrics are fractions of the hours,
    0…1. `useful` is the fraction with 100…3000 lux, `useful_bands` the fraction in each
    of the four ranges, over (band, sensor). `…_error` is the standard error of a metric
    and `…_components` its error components, over (replicate, sensor).
    """
    names = ("illuminance", "standard_error", "error_components")
    part = hourly[[name for name in names if name in hourly]]
    counted = within_hours(part.transpose("sensor", ..., "time"), hours).load()
    # Selected time steps are not contiguous in memory, which makes sums slow
    for name, values in dict(counted).items():
        rows = np.ascontiguousarray(values.values)
        counted[name] = values.dims, rows, values.attrs
    result = with_errors(counted, partial(_metrics, target_lux=target_lux))
    attrs = {
        "target_lux": target_lux,
        "useful_limits_lux": list(USEFUL_LIMITS_LUX),
        "hours": int(np.count_nonzero(hours)),
    }
    return result.assign_attrs(attrs)


def _metrics(lux: xr.DataArray, target_lux: float) -> xr.Dataset:
    # All time steps count
    hours = np.full(lux.sizes["time"], fill_value=True)
    bands = useful_illuminance(lux, hours)
    return xr.Dataset(
        {
            "mean_illuminance": annual_statistic(lux, hours, "mean"),
            "median_illuminance": annual_statistic(lux, hours, "median"),
            "maximum_illuminance": annual_statistic(lux, hours, "max"),
            "daylight_autonomy": daylight_autonomy(lux, hours, target_lux=target_lux),
            "continuous_autonomy": continuous_autonomy(
                lux, hours, target_lux=target_lux
            ),
            "useful": bands.sel(band=list(USEFUL_RANGES[1:3])).sum("band"),
            "useful_bands": bands,
        }
    )
