"""Calibration: fit of unknown quantities to measurements, with their posterior.

Bounded nonlinear least squares (Gauss–Newton with a trust region) of relative
deviations, with the distributions of the quantities as priors. Near the optimum the
model is linear, and the posterior is normal: its covariance is the inverse of the
curvature, cut to the bounds. The relative error of the measurements is estimated from
the residuals. Residuals of one time step are often alike; the design effect of such
clusters widens the posterior. So do errors that the values of a sensor have in common:
its own, and the standard error of the simulation. If few independent values are left,
it has the variance of Student's t.

References: A. Tarantola, Inverse Problem Theory, 2005, chapter 3; L. Kish, Survey
Sampling, 1965 (design effect); A. Gelman et al., Bayesian Data Analysis, 2013, 14.2.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int
from scipy import optimize

from clerestory.checks import require, same_length
from clerestory.uncertainty.draws import Unknown
from clerestory.uncertainty.posterior import Calibration
from clerestory.uncertainty.residual_covariance import (
    SensorErrors,
    Whitening,
    design_effect,
    freedom_of_errors,
    scale_of,
    sensor_deviation,
    whitening,
)

# Function of the quantities, in the order of the unknowns, that returns values
Predict = Callable[[Float[np.ndarray, " unknown"]], Float[np.ndarray, " pair"]]

_REWEIGHTED = 20


def calibrate(
    predict: Predict,
    measured: Float[np.ndarray, " pair"],
    unknowns: Sequence[Unknown],
    *,
    clusters: Sequence[Int[np.ndarray, " pair"]] = (),
    common: SensorErrors | None = None,
    relative_error: float | None = None,
) -> Calibration:
    """Return the quantities with which a model agrees best with measurements.

    Parameters
    ----------
    predict : model
    measured : measured values
    unknowns : quantities and their priors
    clusters : for each way in which errors may be alike, such as by time step, the
        number of the cluster of each value
    common : errors that values of a sensor have in common; the deviation of sensors is
        estimated, if `relative_error` is. None by default
    relative_error : relative error of a measured value; by default it is estimated

    Examples
    --------
    >>> from clerestory.uncertainty.distributions import uniform
    >>> at = np.linspace(1.0, 2.0, 50)
    >>> noise = 1 + 0.01 * np.resize([1.0, -1.0], 50)
    >>> glass = Unknown("glass", uniform(0.5, 1.0), 0.8)
    >>> found = calibrate(lambda theta: theta[0] * at, 0.7 * at * noise, [glass])
    >>> found.values.round(2).tolist(), bool(found.deviations[0] < 0.002)
    ([0.7], True)
    """
    require(unknowns, "no quantity to calibrate; one or more expected")
    start = _inside(unknowns, np.array([each.reference for each in unknowns]))
    same_length(measured, predict(start), "measured values", "predicted values")
    values, error, effect = start, relative_error or 0.1, 1.0
    for _ in range(_REWEIGHTED):
        before = values, error * np.sqrt(effect)
        whiten = whitening(predict(values), before[1], common)
        values = _solve(predict, measured, unknowns, whiten, start=values)
        projection = _projection(predict, unknowns, values, whiten)
        predicted = predict(values)
        gap = measured - predicted
        same = True
        # Residuals in units of the independent error
        residual = whitening(predicted, error, common)(gap)
        if relative_error is None:
            told = max(len(measured) - float(np.sum(projection**2)), 1.0)
            error = max(error * float(np.sqrt(np.sum(residual**2) / told)), 1e-6)
        effect = max(
            [1.0, *(design_effect(residual, projection, own) for own in clusters)]
        )
        if common is not None and relative_error is None:
            scale, own = scale_of(predicted), error * float(np.sqrt(effect))
            sensor = sensor_deviation(
                gap / scale, projection, own, common, predicted / scale
            )
            same = abs(sensor - common.deviation) < 1e-3 * error
            common = replace(common, deviation=sensor)
        same = same and np.allclose(before[0], values, rtol=1e-6)
        if same and abs(before[1] / (error * np.sqrt(effect)) - 1) < 1e-4:
            break
    found = _posterior(predict, unknowns, values, error, effect, common)
    if relative_error is not None:
        return found
    freedom = max(freedom_of_errors(projection, effect, common), 3.0)
    wider = found.covariance * freedom / (freedom - 2)
    return replace(found, covariance=_cut(wider, unknowns))


def prediction_deviations(
    predict: Predict, found: Calibration, common: SensorErrors | None = None
) -> Float[np.ndarray, " pair"]:
    """Return standard deviations of measured values about predicted ones.

    They are due to the error of a measured value and of a sensor, the posterior of the
    quantities, and the error of the simulation in `common`. `predict` may be of values
    that were not fitted.
    """
    predicted = predict(found.values)
    spread = np.array([u.distribution.standard_deviation for u in found.unknowns])
    slopes = _sensitivity(predict, found.unknowns, found.values) / spread
    own = found.relative_error * scale_of(predicted)
    variance = own**2 + np.einsum("pi,ij,pj->p", slopes, found.covariance, slopes)
    if common is not None:
        scale = scale_of(predicted)
        parts = replace(common, deviation=found.sensor_error).scaled(predicted / scale)
        variance += scale**2 * np.sum(parts**2, axis=1)
    return np.asarray(np.sqrt(variance))


def profile(
    predict: Predict,
    measured: Float[np.ndarray, " pair"],
    found: Calibration,
    number: int,
    *,
    count: int = 9,
) -> tuple[Float[np.ndarray, " point"], Float[np.ndarray, " point"]]:
    """Return values of one quantity, and the loss with all others fitted.

    The loss is that of the posterior, −2 ln p, above its minimum: 1 at one standard
    deviation if the posterior is normal.
    """
    own = found.unknowns[number].distribution
    reach = 2.5 * found.deviations[number]
    ends = np.clip(
        [found.values[number] - reach, found.values[number] + reach], own.low, own.high
    )
    places = np.linspace(float(ends[0]), float(ends[1]), count)
    whiten = _whitening_of(found, predict)
    others = [k for k in range(len(found.unknowns)) if k != number]
    rest = [found.unknowns[k] for k in others]
    losses = []
    for place in [found.values[number], *places]:

        def of(theta: np.ndarray, place: float = place) -> np.ndarray:
            whole = np.full(len(found.unknowns), place)
            whole[others] = theta
            return predict(whole)

        theta = found.values[others]
        if rest:
            theta = _solve(of, measured, rest, whiten, start=theta)
        whole = np.full(len(found.unknowns), place)
        whole[others] = theta
        gap = whiten(measured - predict(whole))
        losses.append(float(gap @ gap + np.sum(_prior(found.unknowns, whole) ** 2)))
    return places, np.array(losses[1:]) - losses[0]


def _solve(
    predict: Predict,
    measured: np.ndarray,
    unknowns: Sequence[Unknown],
    whiten: Whitening,
    *,
    start: np.ndarray,
) -> np.ndarray:
    def residuals(theta: np.ndarray) -> np.ndarray:
        gap = whiten(predict(theta) - measured)
        return np.concatenate([gap, _prior(unknowns, theta)])

    ends = [(u.distribution.low, u.distribution.high) for u in unknowns]
    scale = [u.distribution.standard_deviation for u in unknowns]
    found = optimize.least_squares(
        residuals,
        _inside(unknowns, start),
        bounds=tuple(np.array(ends).T),
        x_scale=scale,
        jac="3-point",
    )
    return np.asarray(found.x)


def _prior(unknowns: Sequence[Unknown], theta: np.ndarray) -> np.ndarray:
    # Distance from the mean in standard deviations; flat for uniform distributions
    found = np.zeros(len(unknowns))
    for number, unknown in enumerate(unknowns):
        own = unknown.distribution
        if own.shape == "normal":
            found[number] = (theta[number] - own.centre) / own.deviation
        elif own.shape == "triangular":
            found[number] = (theta[number] - own.mean) / own.standard_deviation
    return found


def _whitening_of(found: Calibration, predict: Predict) -> Whitening:
    deviation = found.relative_error * float(np.sqrt(found.design_effect))
    return whitening(predict(found.values), deviation, found.common)


def _sensitivity(
    predict: Predict, unknowns: Sequence[Unknown], values: np.ndarray
) -> np.ndarray:
    # Change of the predicted values by one standard deviation of each prior
    spread = np.array([u.distribution.standard_deviation for u in unknowns])
    columns = []
    for number, step in enumerate(1e-3 * spread):
        own = np.zeros(len(values))
        own[number] = step
        columns.append((predict(values + own) - predict(values - own)) / 2e-3)
    return np.stack(columns, axis=1)


def _informed(unknowns: Sequence[Unknown]) -> np.ndarray:
    # Uniform distributions give no information but their bounds
    known = [float(u.distribution.shape != "uniform") for u in unknowns]
    return np.maximum(known, 1e-6)


def _projection(
    predict: Predict,
    unknowns: Sequence[Unknown],
    values: np.ndarray,
    whiten: Whitening,
) -> np.ndarray:
    # Q, where Q Qᵀ takes measured to fitted values; the rows of the priors are left out
    scaled = whiten(_sensitivity(predict, unknowns, values))
    rows = np.concatenate([scaled, np.diag(np.sqrt(_informed(unknowns)))])
    return np.asarray(np.linalg.qr(rows)[0][: len(scaled)])


def _posterior(
    predict: Predict,
    unknowns: Sequence[Unknown],
    values: np.ndarray,
    error: float,
    effect: float,
    common: SensorErrors | None,
) -> Calibration:
    spread = np.array([u.distribution.standard_deviation for u in unknowns])
    whiten = whitening(predict(values), error * float(np.sqrt(effect)), common)
    scaled = whiten(_sensitivity(predict, unknowns, values))
    _, singular, combinations = np.linalg.svd(scaled, full_matrices=False)
    curvature = scaled.T @ scaled + np.diag(_informed(unknowns))
    covariance = _cut(np.linalg.inv(curvature) * np.outer(spread, spread), unknowns)
    return Calibration(
        tuple(unknowns), values, covariance, error, effect, singular, combinations,
        common,
    )  # fmt: skip


def _cut(covariance: np.ndarray, unknowns: Sequence[Unknown]) -> np.ndarray:
    # No deviation above that of the prior
    spread = np.array([u.distribution.standard_deviation for u in unknowns])
    limit = np.minimum(1.0, spread / np.sqrt(np.diag(covariance)))
    return np.asarray(covariance * np.outer(limit, limit))


def _inside(unknowns: Sequence[Unknown], values: np.ndarray) -> np.ndarray:
    low, high = np.array(
        [(each.distribution.low, each.distribution.high) for each in unknowns]
    ).T
    finite = np.where(np.isfinite(high - low), high - low, 1.0)
    return np.asarray(np.clip(values, low + 1e-6 * finite, high - 1e-6 * finite))
