"""Metrics of the sensors and their means over grids, with standard errors.

The error of a mean over a grid is calculated from the error components of the metric at
each sensor, which include the correlations between sensors.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX, USEFUL_RANGES
from clerestory.metrics.replicates import error_of_group_mean
from clerestory.report.uncertain_value import Figure

# Keys of the maps of melanopic light
MELANOPIC_KEYS = ("melanopic-mean", "melanopic-hours", "melanopic-days")


@dataclass(frozen=True, eq=False)
class MetricMap:
    """Values of one metric at all sensors, with title and description.

    Attributes
    ----------
    key : HTML identifier of the metric
    title, note : title and description
    values, errors : value and standard error per sensor, in `unit`
    unit : lux or %
    components : error components
    """

    key: str
    title: str
    note: str
    values: Float[np.ndarray, " sensor"]
    errors: Float[np.ndarray, " sensor"]
    unit: str
    components: Float[np.ndarray, "component sensor"]

    def mean(self, members: Int[np.ndarray, " member"]) -> Figure:
        """Mean over the given sensors, with its standard error."""
        error = error_of_group_mean(self.components[:, members])
        return Figure(float(self.values[members].mean()), error, self.unit)


def metric_maps(metrics: xr.Dataset) -> tuple[MetricMap, ...]:
    """Return maps of mean illuminance, daylight autonomy and the four UDI bands."""
    target = float(metrics.attrs.get("target_lux", 300.0))
    low, middle, high = (f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX)
    ranges = (f"below {low} lux", f"{low}–{middle} lux", f"{middle}–{high} lux")
    mean = _with_error(metrics, "mean_illuminance", "lux")
    autonomy = _with_error(metrics, "daylight_autonomy", "%")
    hours = f"hours with {target:,.0f} lux or more"
    note = "over the occupied hours"
    maps = [
        MetricMap("mean", "Mean illuminance", note, *mean),
        MetricMap("autonomy", "Daylight autonomy", hours, *autonomy),
    ]
    for band, note in zip(USEFUL_RANGES, (*ranges, f"{high} lux or more"), strict=True):
        shares = _with_error(metrics.sel(band=band), "useful_bands", "%")
        title = f"Useful illuminance: {band}"
        maps.append(MetricMap(band.replace(" ", "-"), title, note, *shares))
    if "melanopic_autonomy" in metrics:
        maps += _melanopic_maps(metrics)
    return tuple(maps)


def _melanopic_maps(metrics: xr.Dataset) -> list[MetricMap]:
    target = f"{metrics.attrs['melanopic_target_lux']:,.0f} lux"
    hours = f"hours with a melanopic EDI of {target} or more, from daylight"
    days = f"days with {target} or more for four hours that begin by noon"
    shares = [
        _with_error(metrics, f"melanopic_{name}", "%") for name in ("autonomy", "days")
    ]
    mean = _with_error(metrics, "mean_melanopic_edi", "lux")
    note = "equivalent daylight illuminance over the occupied hours"
    titles = ("Mean melanopic EDI", "Melanopic light: hours", "Melanopic light: days")
    values = zip((note, hours, days), (mean, *shares), strict=True)
    return [
        MetricMap(key, title, words, *found)
        for key, title, (words, found) in zip(
            MELANOPIC_KEYS, titles, values, strict=True
        )
    ]


def useful_share(metrics: xr.Dataset, members: Int[np.ndarray, " member"]) -> Figure:
    """Return the percentage of hours in the useful UDI range, mean over sensors."""
    title, note = "Useful illuminance", "hours in the useful range"
    found = MetricMap("useful", title, note, *_with_error(metrics, "useful", "%"))
    return found.mean(members)


def _with_error(
    metrics: xr.Dataset, name: str, unit: str
) -> tuple[np.ndarray, np.ndarray, str, np.ndarray]:
    # Values, standard errors, unit and error components of a metric
    factor = 100 if unit == "%" else 1
    value, error, components = (
        factor * metrics[name + end].values.astype(float)
        for end in ("", "_error", "_components")
    )
    return value, error, unit, components
