"""Standard errors of metrics by balanced repeated replication.

Each replicate is an illuminance that another run could give: the estimate plus or minus
each of its error components, with signs from a Hadamard matrix. The standard deviation
of a metric over the replicates is its standard error, with all correlations between
hours and sensors. It is exact for means; for metrics with a threshold, it includes the
hours and sensors that may be on either side.

Reference: P. J. McCarthy, "Pseudo-replication: half samples", Review of the
International Statistical Institute 37 (3), 1969.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TypedDict

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.matrix.error_components import COUNT, UNIT, signed_sums


class IlluminanceErrors(TypedDict):
    """Standard errors of hourly illuminance, and their components, if known."""

    standard_error: xr.DataArray | None
    components: xr.DataArray | None


def replicates(
    illuminance: xr.DataArray,
    standard_error: xr.DataArray | None,
    components: xr.DataArray | None = None,
) -> Iterator[xr.DataArray]:
    """Yield replicates of the illuminance, all over (sensor, time) [lux].

    `components` are the error components of a run, over (sensor, component, time), as
    in `clerestory.matrix.error_components`. Without them, all errors are assumed to be
    fully correlated, which gives upper limits. Without standard errors, there are no
    replicates.

    >>> lux = xr.DataArray([[100.0, 300.0]], dims=("sensor", "time"))
    >>> [x.values.tolist() for x in replicates(lux, 0.1 * lux)]
    [[[110.0, 330.0]], [[90.0, 270.0]]]
    """
    if standard_error is None:
        return
    if components is None:
        yield illuminance + standard_error
        yield illuminance - standard_error
        return
    ordered = illuminance.transpose("sensor", "time")
    for values in _array_replicates(ordered, standard_error, components):
        found = ordered.copy(data=values)
        found.attrs = {}
        yield found


def _array_replicates(
    illuminance: xr.DataArray, standard_error: xr.DataArray, components: xr.DataArray
) -> Iterator[Float[np.ndarray, "sensor time"]]:
    sums = signed_sums(components.transpose("sensor", "component", "time").values)
    scale = standard_error.transpose("sensor", "time").values / np.float32(UNIT)
    lux = illuminance.transpose("sensor", "time").values
    for number in range(COUNT):
        deviation = scale * sums[:, number]
        yield lux + deviation
        yield lux - deviation


def hourly_replicates(hourly: xr.Dataset) -> Iterator[xr.DataArray]:
    """Yield replicates of the illuminance of a run, or of a part of its results."""
    return replicates(hourly["illuminance"], **errors_of(hourly))


def with_errors(
    hourly: xr.Dataset,
    metrics: Callable[[Float[np.ndarray, "sensor time"]], Mapping[str, xr.Variable]],
) -> xr.Dataset:
    """Return metrics of the illuminance of a run, with their errors.

    `metrics` returns metrics of each sensor by name, over (…, sensor). `…_error` is the
    standard error of a metric and `…_components` its error components, over
    (replicate, …).
    """
    lux, axes = hourly["illuminance"], ("sensor", "time")
    error, components = hourly.get("standard_error"), hourly.get("error_components")
    found = metrics(lux.transpose(*axes).values)
    if error is None or components is None:
        each = replicates(lux, error, components)
        varied = [metrics(own.transpose(*axes).values) for own in each]
    else:
        arrays = _array_replicates(lux, error, components)
        varied = [metrics(values) for values in arrays]
    result = {}
    for name, metric in found.items():
        parts = metric_components(metric.values, [x[name].values for x in varied])
        dims, attrs = ("replicate", *metric.dims), metric.attrs
        spread, single = np.linalg.norm(parts, axis=0), parts.astype(np.float32)
        result[name] = metric
        result[f"{name}_error"] = xr.Variable(metric.dims, spread, attrs)
        result[f"{name}_components"] = xr.Variable(dims, single, attrs)
    of_sensors = {k: v for k, v in lux.coords.items() if v.dims[:1] == ("sensor",)}
    return xr.Dataset(result, coords=of_sensors)


def errors_of(hourly: xr.Dataset) -> IlluminanceErrors:
    """Return the errors of the illuminance, as arguments of `replicates`."""
    error, parts = hourly.get("standard_error"), hourly.get("error_components")
    return IlluminanceErrors(standard_error=error, components=parts)


def metric_components(
    metric: Float[np.ndarray, "..."], varied: Sequence[Float[np.ndarray, "..."]]
) -> Float[np.ndarray, "replicate ..."]:
    """Return the error components of a metric from its values for all replicates.

    The sum of their squares is the variance of the metric.
    """
    if not varied:
        return np.zeros((0, *metric.shape))
    found = np.stack(varied).astype(float)
    return np.asarray((found - found.mean(axis=0)) / np.sqrt(len(found)))


def metric_error(values: Sequence[float]) -> float:
    """Return the standard error of a number from its values for all replicates.

    >>> metric_error([3.0, 5.0]), metric_error([])
    (1.0, 0.0)
    """
    return float(np.std(values)) if len(values) else 0.0


def error_of_group_mean(components: Float[np.ndarray, "component sensor"]) -> float:
    """Return the standard error of the mean over a group of sensors.

    >>> error_of_group_mean(np.array([[3.0, 5.0], [3.0, -5.0]]))
    4.123105625617661
    """
    return float(np.linalg.norm(components.mean(axis=1)))
