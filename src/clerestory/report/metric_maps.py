"""Metrics of the sensors and their means over grids, with standard errors.

The error of a grid's mean illuminance is calculated from independent components of the
errors at the sensors. Errors of other metrics are assumed to be fully correlated: the
error of a grid mean is the mean of the errors at the sensors.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX, USEFUL_RANGES
from clerestory.metrics.sensor_metrics import error_of_group_mean
from clerestory.report.uncertain_value import Figure


@dataclass(frozen=True, eq=False)
class MetricMap:
    """Values of one metric at all sensors, with title and description.

    Attributes
    ----------
    key : HTML identifier of the metric
    title, note : title and description
    values, errors : value and standard error per sensor, in `unit`
    unit : lux or %
    components : independent components of the standard errors, if known
    """

    key: str
    title: str
    note: str
    values: Float[np.ndarray, " sensor"]
    errors: Float[np.ndarray, " sensor"]
    unit: str
    components: Float[np.ndarray, "component sensor"] | None = None

    def mean(self, members: Int[np.ndarray, " member"]) -> Figure:
        """Mean over the given sensors, with its standard error."""
        known = None if self.components is None else self.components[:, members]
        error = error_of_group_mean(self.errors[members], known)
        return Figure(float(self.values[members].mean()), error, self.unit)


def metric_maps(metrics: xr.Dataset) -> tuple[MetricMap, ...]:
    """Return maps of mean illuminance, daylight autonomy and the four UDI bands."""
    target = float(metrics.attrs.get("target_lux", 300.0))
    low, middle, high = (f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX)
    ranges = (f"below {low} lux", f"{low}–{middle} lux", f"{middle}–{high} lux")
    known = "mean_components" in metrics
    components = metrics["mean_components"].values.astype(float) if known else None
    mean = _with_error(metrics, "mean_illuminance")
    autonomy = _with_error(metrics, "daylight_autonomy", 100)
    hours = f"hours with {target:,.0f} lux or more"
    note = "over the occupied hours"
    maps = [
        MetricMap("mean", "Mean illuminance", note, *mean, "lux", components),
        MetricMap("autonomy", "Daylight autonomy", hours, *autonomy, "%"),
    ]
    for band, note in zip(USEFUL_RANGES, (*ranges, f"{high} lux or more"), strict=True):
        shares = _with_error(metrics.sel(band=band), "useful_bands", 100)
        title = f"Useful illuminance: {band}"
        maps.append(MetricMap(band.replace(" ", "-"), title, note, *shares, "%"))
    return tuple(maps)


def useful_share(metrics: xr.Dataset, members: Int[np.ndarray, " member"]) -> Figure:
    """Return the percentage of hours in the useful UDI range, mean over sensors."""
    value, error = (x[members].mean() for x in _with_error(metrics, "useful", 100))
    return Figure(float(value), float(error), "%")


def _with_error(
    metrics: xr.Dataset, name: str, factor: float = 1
) -> tuple[Float[np.ndarray, " sensor"], Float[np.ndarray, " sensor"]]:
    value, error = (
        factor * metrics[n].values.astype(float) for n in (name, f"{name}_error")
    )
    return value, error
