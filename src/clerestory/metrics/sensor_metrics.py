"""Climate-based metrics of every sensor, with upper limits of their standard errors.

The illuminances of all hours are computed from the same traced matrices, so their
errors are assumed to be fully correlated. The error of a metric is half of the
difference between the metric for E + σ and the metric for E − σ, where σ is the
standard error of the illuminance E.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.metrics.climate_based_metrics import (
    TARGET_LUX,
    USEFUL_LIMITS_LUX,
    USEFUL_RANGES,
    annual_statistic,
    continuous_autonomy,
    daylight_autonomy,
    useful_illuminance,
)


def sensor_metrics(
    hourly: xr.Dataset,
    hours: Bool[np.ndarray, " time"],
    *,
    target_lux: float = TARGET_LUX,
) -> xr.Dataset:
    """Return the metrics of each sensor over the selected hours.

    Statistics of illuminance are in lux; all other metrics are fractions of the hours,
    0…1. `useful` is the fraction with 100…3000 lux, `useful_bands` the fraction in each
    of the four ranges, over (band, sensor).
    """
    lux = hourly["illuminance"]
    autonomy = partial(daylight_autonomy, hours=hours, target_lux=target_lux)
    continuous = partial(continuous_autonomy, hours=hours, target_lux=target_lux)
    bands = useful_illuminance(lux, hours)
    result = xr.Dataset(
        {
            "mean_illuminance": annual_statistic(lux, hours, "mean"),
            "mean_illuminance_error": _mean_error(hourly, hours),
            "median_illuminance": annual_statistic(lux, hours, "median"),
            "maximum_illuminance": annual_statistic(lux, hours, "max"),
            "daylight_autonomy": autonomy(lux),
            "daylight_autonomy_error": metric_error(autonomy, hourly),
            "continuous_autonomy": continuous(lux),
            "continuous_autonomy_error": metric_error(continuous, hourly),
            "useful": bands.sel(band=list(USEFUL_RANGES[1:3])).sum("band"),
            "useful_error": _useful_error(hourly, hours),
            "useful_bands": bands,
        }
    )
    attrs = {
        "target_lux": target_lux,
        "useful_limits_lux": list(USEFUL_LIMITS_LUX),
        "hours": int(np.count_nonzero(hours)),
    }
    return result.assign_attrs(attrs)


def error_of_group_mean(
    errors: Float[np.ndarray, " sensor"],
    components: Float[np.ndarray, "component sensor"] | None = None,
) -> float:
    """Standard error of the mean over a group of sensors.

    Without error components, the errors of all sensors are assumed to be fully
    correlated, which gives an upper limit.

    >>> error_of_group_mean(np.array([3.0, 5.0]))
    4.0
    """
    if components is None:
        return float(errors.mean())
    return float(np.linalg.norm(components.mean(axis=1)))


def _mean_error(hourly: xr.Dataset, hours: Bool[np.ndarray, " time"]) -> xr.DataArray:
    # Error of the mean illuminance, from its error components or, without components,
    # for fully correlated hourly errors
    if "mean_components" not in hourly:
        return annual_statistic(hourly["standard_error"], hours, "mean")
    variance = (hourly["mean_components"].astype(float) ** 2).sum("component")
    error: xr.DataArray = variance**0.5
    return error.assign_attrs(units="lux")


def metric_error(
    metric: Callable[[xr.DataArray], xr.DataArray], hourly: xr.Dataset
) -> xr.DataArray:
    """Standard error of a metric that increases with the illuminance."""
    lux, error = hourly["illuminance"], hourly["standard_error"]
    return (metric(lux + error) - metric(lux - error)) / 2


def _useful_error(hourly: xr.Dataset, hours: Bool[np.ndarray, " time"]) -> xr.DataArray:
    # Sum of the errors at the lower and at the upper limit of the useful range
    low, high = (
        metric_error(partial(daylight_autonomy, hours=hours, target_lux=lux), hourly)
        for lux in USEFUL_LIMITS_LUX[::2]
    )
    return low + high
