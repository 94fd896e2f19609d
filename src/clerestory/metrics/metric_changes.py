"""Changes of daylight metrics for changes of reflectances.

Hourly illuminance is expanded to second order in each parameter. The metrics of the
expanded illuminance minus those of the illuminance give the change. Its standard error
is that over the replicates of both, which have the signs of the same batches in common
(see `metrics.replicates`). Shade states are held constant.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Float32

from clerestory.checks import require
from clerestory.matrix.error_components import UNIT, signed_sums
from clerestory.matrix.expansion import (
    FIRST,
    FIRST_ERROR,
    FIRST_PARTS,
    SECOND,
    parameter_steps,
)
from clerestory.metrics.climate_based_metrics import (
    TARGET_LUX,
    share_at,
    statistic_over_time,
    useful_shares,
)
from clerestory.metrics.spatial_metrics import HALF_OF_THE_HOURS

# Metrics of a grid, with their units
FIGURES = {
    "mean illuminance": "lux",
    "daylight autonomy": "%",
    "useful illuminance": "%",
    "spatial autonomy": "%",
}

# Sensors per block
_SENSORS = 64


def metric_changes(
    hourly: xr.Dataset,
    derivatives: xr.Dataset,
    hours: Bool[np.ndarray, " time"],
    grids: Sequence[str],
    *,
    step: float,
    target_lux: float = TARGET_LUX,
) -> xr.Dataset:
    """Return the changes of the metrics of each grid for a step of each parameter.

    Parameters
    ----------
    hourly : illuminance with its standard error and error components
    derivatives : derivatives of the illuminance; see `illuminance_derivatives`
    hours : mask of the occupied hours
    grids : grid of each sensor
    step : change of each parameter; smaller where the value would leave 0…1

    Returns
    -------
    `sensitivity` and `sensitivity_error` over (parameter, change, figure, place),
    `sensitivity_base` over (figure, place), and `sensitivity_step` and
    `sensitivity_value` of the parameters
    """
    require(np.any(hours), "no time step is within the schedule; at least one expected")
    values = derivatives["parameter_value"].values
    steps = parameter_steps(values, derivatives["parameter_quantity"].values, step)
    parts = [
        _block(hourly, derivatives, hours, block, steps, target_lux)
        for block in _blocks(len(grids))
    ]
    figures = np.concatenate(parts, axis=-1)
    places = list(dict.fromkeys(grids))
    of_place = np.array([np.array(grids) == place for place in places])
    weights = of_place / of_place.sum(axis=1, keepdims=True)
    means = figures @ weights.T
    base, changed = means[0, 0], means[1:].reshape(*steps.shape, *means.shape[1:])
    change = changed - means[0]
    return xr.Dataset(
        {
            "sensitivity": (_AXES, change[:, :, 0]),
            "sensitivity_error": (_AXES, change[:, :, 1:].std(axis=2)),
            "sensitivity_base": (_AXES[2:], base),
            "sensitivity_step": (_AXES[:2], steps),
            "sensitivity_value": ("parameter", values),
            "sensitivity_quantity": derivatives["parameter_quantity"].variable,
            "sensitivity_unit": ("figure", list(FIGURES.values())),
        },
        coords={
            "parameter": derivatives["parameter"].values,
            "change": ["less", "more"],
            "figure": list(FIGURES),
            "place": places,
        },
    )


_AXES = "parameter", "change", "figure", "place"


def _blocks(sensors: int) -> Iterator[slice]:
    for first in range(0, sensors, _SENSORS):
        yield slice(first, min(first + _SENSORS, sensors))


def _block(
    hourly: xr.Dataset,
    derivatives: xr.Dataset,
    hours: Bool[np.ndarray, " time"],
    block: slice,
    steps: Float[np.ndarray, "parameter 2"],
    target_lux: float,
) -> Float[np.ndarray, "case replicate figure sensor"]:
    # Metrics without a change, and for the steps of each parameter
    chosen = {"sensor": block, "time": np.flatnonzero(hours)}
    here, slopes = hourly.isel(chosen), derivatives.isel(chosen)
    lux = _varied(here["illuminance"], here["standard_error"], here["error_components"])
    found = [[_figures(each, target_lux) for each in lux]]
    for number, pair in enumerate(steps.tolist()):
        own = slopes.isel(parameter=number)
        slope = _varied(own[FIRST], own[FIRST_ERROR], own[FIRST_PARTS])
        curve = _curvature(slopes, str(own["parameter"].values))
        for step in pair:
            changed = (
                each + (step * by + (0.5 * step**2) * curve)
                for each, by in zip(lux, slope, strict=True)
            )
            found.append([_figures(each, target_lux) for each in changed])
    return np.array(found)


def _curvature(slopes: xr.Dataset, name: str) -> np.ndarray | float:
    if SECOND not in slopes:
        return 0.0
    both = (slopes["pair_first"] == name) & (slopes["pair_second"] == name)
    found: np.ndarray = slopes[SECOND].isel(pair=int(np.argmax(both.values))).values
    return found


def _varied(
    value: xr.DataArray, error: xr.DataArray, components: xr.DataArray
) -> Float32[np.ndarray, "replicate sensor time"]:
    # A value, and its replicates
    lux = value.transpose("sensor", "time").values.astype(np.float32)
    sums = signed_sums(components.transpose("sensor", "component", "time").values)
    scale = error.transpose("sensor", "time").values / np.float32(UNIT)
    deviations = np.moveaxis(scale[:, None] * sums, 1, 0)
    every = np.concatenate([lux + deviations, lux - deviations])
    return np.concatenate([lux[None], every]).astype(np.float32)


def _figures(
    lux: Float32[np.ndarray, "sensor time"], target_lux: float
) -> Float[np.ndarray, "figure sensor"]:
    autonomy = share_at(lux, target_lux)
    useful = useful_shares(lux)[1:3].sum(axis=0)
    reached = autonomy >= HALF_OF_THE_HOURS - 1e-12
    mean = statistic_over_time(lux, "mean")
    return np.stack([mean, 100 * autonomy, 100 * useful, 100 * reached])
