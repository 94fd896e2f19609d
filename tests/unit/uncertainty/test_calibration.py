"""Calibration against closed forms, and the coverage of its posterior."""

import numpy as np
import pytest
from scipy import stats

from clerestory.errors import InputError
from clerestory.uncertainty.calibration import (
    calibrate,
    prediction_deviations,
    profile,
)
from clerestory.uncertainty.distributions import normal, uniform
from clerestory.uncertainty.draws import Unknown
from clerestory.uncertainty.residual_covariance import SensorErrors, design_effect

PLACES = np.linspace(1.0, 3.0, 200)


def room(theta):
    """Two factors and a curved term, as glass and a reflectance have."""
    glass, floor = theta
    return glass * (100 + 80 * floor * PLACES + 60 * (floor * PLACES) ** 2)


UNKNOWNS = [
    Unknown("glass", normal(0.8, 0.1, low=0.3, high=1.0), 0.8),
    Unknown("floor", normal(0.3, 0.1, low=0.0, high=0.9), 0.3),
]


def test_exact_measurements_give_the_true_values():
    truth = np.array([0.7, 0.42])
    found = calibrate(room, room(truth), UNKNOWNS)
    assert found.values == pytest.approx(truth, rel=1e-3)


def test_a_linear_model_has_the_posterior_of_the_closed_form():
    """Mean of n values with relative error r and a normal prior (Tarantola)."""
    error, count = 0.05, 100
    noise = 1 + error * np.random.default_rng(3).standard_normal(count)
    found = calibrate(
        lambda theta: np.full(count, 1000 * theta[0]),
        800 * noise,
        [Unknown("glass", normal(0.7, 0.01), 0.7)],
        relative_error=error,
    )
    mean = float(np.mean(0.8 * noise))
    data, prior = count / (error * found.values[0]) ** 2, 1 / 0.01**2
    expected = (data * mean + prior * 0.7) / (data + prior)
    assert found.values[0] == pytest.approx(expected, rel=1e-3)
    assert found.deviations[0] == pytest.approx((data + prior) ** -0.5, rel=1e-3)


def test_the_truth_is_within_95_percent_of_the_posterior_in_95_percent_of_repeats():
    rng = np.random.default_rng(5)
    hits = 0
    for _ in range(100):
        # The truth is drawn from the prior
        truth = np.array([rng.normal(0.8, 0.05), rng.normal(0.3, 0.1)]).clip(0.05, 0.99)
        noise = 1 + 0.05 * rng.standard_normal(PLACES.size)
        found = calibrate(room, room(truth) * noise, UNKNOWNS)
        hits += (abs(found.values - truth) < 1.96 * found.deviations).sum()
    # 200 intervals: 190 expected, standard deviation 3.1
    assert 178 <= hits <= 200


def test_what_only_a_product_tells_is_reported_as_alike():
    def product(theta):
        return theta[0] * theta[1] * PLACES

    unknowns = [Unknown(name, uniform(0.5, 1.0), 0.8) for name in ("glass", "dirt")]
    found = calibrate(product, 0.6 * PLACES, unknowns, relative_error=0.02)
    assert [pair[:2] for pair in found.alike()] == [("glass", "dirt")]
    assert found.condition > 1e3
    assert found.values.prod() == pytest.approx(0.6, rel=5e-3)


def test_a_quantity_without_effect_keeps_its_prior():
    found = calibrate(lambda theta: theta[0] * PLACES, 0.7 * PLACES, UNKNOWNS)
    assert found.untold() == ["floor"]
    assert found.deviations[1] == pytest.approx(0.1, rel=0.02)


def test_values_stay_within_their_bounds():
    found = calibrate(room, 2 * room(np.array([1.0, 0.9])), UNKNOWNS)
    assert found.values[0] <= 1.0
    assert "glass" in found.at_bounds()


def test_errors_that_a_time_step_has_in_common_widen_the_posterior():
    rng = np.random.default_rng(7)
    step = np.repeat(np.arange(20), 10)
    common = 1 + 0.1 * rng.standard_normal(20)[step]
    truth = np.array([0.8, 0.3])
    alone = calibrate(room, room(truth) * common, UNKNOWNS)
    found = calibrate(room, room(truth) * common, UNKNOWNS, clusters=[step])
    # Ten equal values tell what one tells
    assert found.design_effect == pytest.approx(10, rel=0.05)
    assert (found.deviations >= alone.deviations).all()


def test_the_error_of_the_simulation_widens_the_posterior_as_in_the_closed_form():
    """Two sensors of 50 values: variance of a mean with an error in common."""
    own, common, count = 0.05, np.array([0.01, 0.04]), 50
    sensors = np.repeat([0, 1], count)
    components = (common[sensors] / np.sqrt(2))[:, None] * np.array([[1.0, -1.0]])
    found = calibrate(
        lambda theta: np.full(2 * count, 1000 * theta[0]),
        np.full(2 * count, 800.0),
        [Unknown("glass", uniform(0.1, 1.0), 0.7)],
        common=SensorErrors(sensors, components),
        relative_error=own,
    )
    variance = 1 / np.sum(1 / (own**2 / count + common**2))
    assert found.values[0] == pytest.approx(0.8, rel=1e-6)
    assert found.deviations[0] / 0.8 == pytest.approx(np.sqrt(variance), rel=1e-3)


def test_the_truth_is_found_with_errors_that_sensors_and_the_simulation_have():
    """Known and unknown errors of 20 sensors; 95 % of regions contain the truth."""
    rng, sensors = np.random.default_rng(11), np.repeat(np.arange(20), 10)
    known = np.linspace(0.005, 0.05, 20)[sensors, None] / np.sqrt(8) * np.ones(8)
    distances, within = [], []
    for _ in range(100):
        truth = np.array([rng.normal(0.8, 0.05), rng.normal(0.3, 0.1)]).clip(0.05, 0.99)
        noise = 1 + 0.03 * rng.standard_normal(20)[sensors]
        noise += (known * rng.standard_normal((20, 8))[sensors]).sum(axis=1)
        noise += 0.05 * rng.standard_normal(PLACES.size)
        measured, error = room(truth) * noise, SensorErrors(sensors, known)
        found = calibrate(room, measured, UNKNOWNS, common=error)
        gap = found.values - truth
        distances.append(gap @ np.linalg.solve(found.covariance, gap))
        deviation = prediction_deviations(room, found, error)
        within.append(np.abs(measured - room(found.values)) < 1.96 * deviation)
    # 95 of 100 expected, standard deviation 2.2
    assert 89 <= np.sum(np.array(distances) < stats.chi2(2).ppf(0.95)) <= 100
    assert np.mean(within) == pytest.approx(0.95, abs=0.015)


def test_a_fit_does_not_hide_the_correlation_of_a_few_clusters():
    """The mean design effect of 6 clusters is the true one, with four unknowns."""
    rng, number = np.random.default_rng(2), np.repeat(np.arange(6), 20)
    sensitivity = np.vander(np.arange(6) / 5, 4)[number]
    basis = np.linalg.qr(sensitivity)[0]
    effects = []
    for _ in range(400):
        error = rng.standard_normal(6)[number] + rng.standard_normal(120)
        residual = error - basis @ (basis.T @ error)
        effects.append(design_effect(residual, basis, number))
    # 1 + 19 · ½; the estimate of ρ from two degrees of freedom scatters
    assert np.median(effects) == pytest.approx(10.5, rel=0.25)


def test_the_profile_rises_by_one_at_a_standard_deviation():
    noise = 1 + 0.05 * np.random.default_rng(1).standard_normal(PLACES.size)
    measured = room(np.array([0.75, 0.35])) * noise
    found = calibrate(room, measured, UNKNOWNS)
    places, loss = profile(room, measured, found, 0, count=11)
    steps = (places - found.values[0]) / found.deviations[0]
    assert loss == pytest.approx(steps**2, abs=0.4)


def test_no_quantity_is_refused():
    with pytest.raises(InputError, match="no quantity to calibrate"):
        calibrate(lambda theta: PLACES, PLACES, [])
