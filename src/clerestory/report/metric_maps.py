"""Metrics of the sensors and their means over grids, with standard errors.

The standard error of the mean illuminance follows from error components, which include
the correlation between sensors. Errors of other metrics are assumed fully correlated,
so that the error of a grid mean is the mean of the errors.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX, USEFUL_RANGES
from clerestory.metrics.sensor_metrics import error_of_group_mean
from clerestory.report.content import ReportContent
from clerestory.report.uncertain_value import Figure


@dataclass(frozen=True, eq=False)
class MetricMap:
    """One metric of all sensors, for display.

    Attributes
    ----------
    key : identifier of the metric in the page
    title, note : title and description
    values, errors : value and standard error per sensor, in `unit`
    unit : lux or %
    components : error components of the values, if known
    """

    key: str
    title: str
    note: str
    values: Float[np.ndarray, " sensor"]
    errors: Float[np.ndarray, " sensor"]
    unit: str
    components: Float[np.ndarray, "component sensor"] | None = None

    def mean(self, members: Int[np.ndarray, " member"]) -> Figure:
        """Mean over sensors; errors without components count as fully correlated."""
        known = None if self.components is None else self.components[:, members]
        error = error_of_group_mean(self.errors[members], known)
        return Figure(float(self.values[members].mean()), error, self.unit)


def metric_maps(metrics: xr.Dataset) -> tuple[MetricMap, ...]:
    """Return mean illuminance, daylight autonomy and the four UDI bands of sensors."""
    target = float(metrics.attrs.get("target_lux", 300.0))
    low, middle, high = (f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX)
    notes = (f"below {low} lux", f"{low}–{middle} lux", f"{middle}–{high} lux")
    maps = [
        MetricMap(
            "mean",
            "Mean illuminance",
            "over the occupied hours",
            _values(metrics, "mean_illuminance"),
            _values(metrics, "mean_illuminance_error"),
            "lux",
            _values(metrics, "mean_components")
            if "mean_components" in metrics
            else None,
        ),
        MetricMap(
            "autonomy",
            "Daylight autonomy",
            f"hours with {target:,.0f} lux or more",
            100 * _values(metrics, "daylight_autonomy"),
            100 * _values(metrics, "daylight_autonomy_error"),
            "%",
        ),
    ]
    for band, note in zip(USEFUL_RANGES, (*notes, f"{high} lux or more"), strict=True):
        shares, errors = (
            100 * np.asarray(metrics[name].sel(band=band).values, dtype=float)
            for name in ("useful_bands", "useful_bands_error")
        )
        title = f"Useful illuminance: {band}"
        maps.append(MetricMap(band.replace(" ", "-"), title, note, shares, errors, "%"))
    return tuple(maps)


def useful_share(metrics: xr.Dataset, members: Int[np.ndarray, " member"]) -> Figure:
    """Return the mean fraction of hours in the useful range of UDI [%]."""
    value = 100 * _values(metrics, "useful")[members].mean()
    error = 100 * _values(metrics, "useful_error")[members].mean()
    return Figure(float(value), float(error), "%")


def relative_errors(content: ReportContent, *, above: float) -> Float[np.ndarray, " n"]:
    """Relative standard errors [%] of all hourly values above a limit [lux]."""
    counted = content.illuminance > above
    lux, error = content.illuminance[counted], content.standard_error[counted]
    return np.asarray(100 * error / lux)


def _values(metrics: xr.Dataset, name: str) -> Float[np.ndarray, "*axes sensor"]:
    return np.asarray(metrics[name].values, dtype=float)
