"""Standard errors of metrics are the scatter of many runs with other random numbers."""

import numpy as np
import pytest
import xarray as xr

from clerestory.matrix.error_components import COUNT, add_components, compressed
from clerestory.metrics.leed import points_error, simulated_daylight
from clerestory.metrics.lighting_energy import LightingZone, lighting_use
from clerestory.metrics.replicates import (
    error_of_group_mean,
    errors_of,
    hourly_replicates,
    metric_error,
)
from clerestory.metrics.sensor_metrics import sensor_metrics
from clerestory.metrics.spatial_metrics import spatial_autonomy, sunlight_exposure

RUNS, BATCHES, SENSORS, STEPS = 120, 16, 40, 200
ALL = np.ones(STEPS, bool)
ZONE = LightingZone(power=100, full_lux=500, least_output=0, least_power=0)


def a_year(rng):
    """Illuminance that falls with the distance from a window, under changing skies."""
    sky = rng.gamma(2.0, 12_000.0, STEPS)
    return np.geomspace(0.06, 0.004, SENSORS)[:, None] * sky


def a_run(truth, rng):
    """Estimate of two matrices in 16 batches each: of every sensor, and of the sky.

    Errors of a sensor are shared by all its steps, those of the sky by all sensors in
    the steps with that kind of sky.
    """
    own = 0.12 * rng.standard_normal((BATCHES, SENSORS, 1))
    kind = np.arange(STEPS) % 5
    sky = 0.06 * rng.standard_normal((BATCHES, 1, 5))[..., kind]
    parts = np.zeros((COUNT, SENSORS, STEPS), np.float32)
    lux, variance = truth.copy(), 0.0
    for batches in (own * truth, sky * truth):
        lux += batches.mean(axis=0)
        components = (batches - batches.mean(axis=0)) / np.sqrt(BATCHES * (BATCHES - 1))
        add_components(parts, components.astype(np.float32))
        variance += np.square(components).sum(axis=0)
    axes = ("sensor", "time")
    return xr.Dataset(
        {
            "illuminance": (axes, lux),
            "standard_error": (axes, np.sqrt(variance)),
            "error_components": (("sensor", "component", "time"), compressed(parts)),
        }
    )


def figures(hourly):
    """Values and standard errors of all results of one run."""
    metrics = sensor_metrics(hourly, ALL)
    found = {}
    for name in metrics:
        if f"{name}_error" in metrics:
            value, parts = metrics[name], metrics[f"{name}_components"]
            if "band" in value.dims:
                value, parts = value[{"band": 3}], parts.isel(band=3)
            error = error_of_group_mean(parts.values)
            found[f"{name}, mean"] = float(value.mean()), error
            found[name] = value.values, np.linalg.norm(parts.values, axis=0)
    lux, errors = hourly["illuminance"], errors_of(hourly)
    reached = spatial_autonomy(lux, ALL, **errors)
    exposed = sunlight_exposure(lux, ALL, **errors, most_hours=50)
    found["sDA"] = reached.value, reached.error
    found["ASE"] = exposed.value, exposed.error
    # Close to the 55 % that the second point requires
    reached = spatial_autonomy(lux, ALL, **errors, target_lux=270.0)
    points = simulated_daylight(reached.value, exposed.value).points
    found["LEED"] = points, points_error(reached, exposed)
    energy = [
        lighting_use(ZONE, light.mean("sensor").values, ALL).energy
        for light in (lux / 10, *(each / 10 for each in hourly_replicates(hourly)))
    ]
    found["lighting energy"] = energy[0], metric_error(energy[1:])
    return found


@pytest.fixture(scope="module")
def runs():
    truth = a_year(np.random.default_rng(1))
    rng = np.random.default_rng(2)
    return [figures(a_run(truth, rng)) for _ in range(RUNS)]


RESULTS = [
    f"{name}{of}"
    for name in (
        "mean_illuminance",
        "median_illuminance",
        "maximum_illuminance",
        "daylight_autonomy",
        "continuous_autonomy",
        "useful",
        "useful_bands",
    )
    for of in ("", ", mean")
]


@pytest.mark.parametrize("name", [*RESULTS, "sDA", "ASE", "LEED", "lighting energy"])
def test_the_error_of_a_result_is_its_scatter_over_runs(runs, name):
    values, errors = (np.array([run[name][k] for run in runs]) for k in (0, 1))
    scatter = np.sqrt(values.var(axis=0, ddof=1).mean())
    assert 0.8 < np.sqrt(np.mean(np.square(errors))) / scatter < 1.25


def test_without_components_all_errors_are_fully_correlated():
    lux = xr.DataArray([[90.0, 310.0]], dims=("sensor", "time"))
    hourly = xr.Dataset({"illuminance": lux, "standard_error": 0 * lux + 20.0})
    found = sensor_metrics(hourly, np.ones(2, bool))
    assert float(found["mean_illuminance_error"][0]) == pytest.approx(20.0)
    assert float(found["daylight_autonomy_error"][0]) == pytest.approx(0.25)


def test_without_errors_there_are_no_replicates():
    lux = xr.DataArray([[90.0, 310.0]], dims=("sensor", "time"))
    found = sensor_metrics(xr.Dataset({"illuminance": lux}), np.ones(2, bool))
    assert float(found["mean_illuminance_error"][0]) == 0.0
    assert error_of_group_mean(found["mean_illuminance_components"].values) == 0.0
