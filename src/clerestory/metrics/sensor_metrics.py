"""Climate-based metrics of every sensor, with their error components.

The variance of a metric, or of its mean over sensors, is the sum of the squares of its
error components (`metrics.replicates`).
"""

from collections.abc import Mapping
from functools import partial
from typing import Any, Literal

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.metrics.climate_based_metrics import (
    TARGET_LUX,
    USEFUL_LIMITS_LUX,
    USEFUL_RANGES,
    continuous_share,
    share_at,
    statistic_over_time,
    useful_shares,
)
from clerestory.metrics.occupied_hours import within_hours
from clerestory.metrics.replicates import with_errors

# Attributes of fractions
_SHARE = {"units": "1"}


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
    units = counted["illuminance"].attrs
    result = with_errors(counted, partial(_metrics, target_lux=target_lux, units=units))
    result = result.assign_coords(band=list(USEFUL_RANGES))
    attrs = {
        "target_lux": target_lux,
        "useful_limits_lux": list(USEFUL_LIMITS_LUX),
        "hours": int(np.count_nonzero(hours)),
    }
    return result.assign_attrs(attrs)


def _metrics(
    lux: Float[np.ndarray, "sensor time"],
    *,
    target_lux: float,
    units: Mapping[str, Any],
) -> dict[str, xr.Variable]:
    # All time steps count
    bands = useful_shares(lux)
    statistics: tuple[Literal["mean", "median", "max"], ...] = "mean", "median", "max"
    mean, median, highest = (statistic_over_time(lux, name) for name in statistics)
    return {
        "mean_illuminance": xr.Variable("sensor", mean, units),
        "median_illuminance": xr.Variable("sensor", median, units),
        "maximum_illuminance": xr.Variable("sensor", highest, units),
        "daylight_autonomy": xr.Variable("sensor", share_at(lux, target_lux), _SHARE),
        "continuous_autonomy": xr.Variable(
            "sensor", continuous_share(lux, target_lux), _SHARE
        ),
        "useful": xr.Variable("sensor", bands[1:3].sum(axis=0), _SHARE),
        "useful_bands": xr.Variable(("band", "sensor"), bands, _SHARE),
    }
