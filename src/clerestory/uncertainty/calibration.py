"""Calibration: fit of unknown quantities to measurements, with their posterior.

Bounded nonlinear least squares (Gauss–Newton with a trust region) of relative
deviations, with the distributions of the quantities as priors. Near the optimum the
model is linear, and the posterior is normal: its covariance is the inverse of the
curvature, cut to the bounds. The relative error of the measurements is estimated from
the residuals. Residuals of one time step or one sensor are often alike; the design
effect of such clusters widens the posterior. If few independent values are left, it
has the variance of Student's t.

References: A. Tarantola, Inverse Problem Theory, 2005, chapter 3; L. Kish, Survey
Sampling, 1965 (design effect); A. Gelman et al., Bayesian Data Analysis, 2013, 14.2.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from scipy import optimize

from clerestory.brief_repr import brief
from clerestory.checks import require, same_length
from clerestory.uncertainty.draws import Unknown

# Function of the quantities, in the order of the unknowns, that returns values
Predict = Callable[[Float[np.ndarray, " unknown"]], Float[np.ndarray, " pair"]]

# Values below this share of the median have the absolute error of that share
_LOW = 0.2

# Singular value, in standard deviations of the prior, from which data tell a
# combination of quantities, and correlation from which two cannot be told apart
_TOLD, _ALIKE = 1.0, 0.9

_REWEIGHTED = 20


@dataclass(frozen=True, eq=False)
class Calibration:
    """Fitted quantities and their posterior.

    Attributes
    ----------
    unknowns : quantities with their priors
    values : most probable values
    covariance : covariance of the posterior
    relative_error : relative error of a measured value, estimated from the residuals
    design_effect : factor by which correlation of the residuals raises variances
    information : singular values of the data's sensitivity, in standard deviations of
        the priors; combinations with values below 1 are told by the priors
    combinations : combination of quantities of each singular value, over
        (combination, unknown)
    """

    unknowns: tuple[Unknown, ...]
    values: Float[np.ndarray, " unknown"]
    covariance: Float[np.ndarray, "unknown unknown"]
    relative_error: float
    design_effect: float
    information: Float[np.ndarray, " combination"]
    combinations: Float[np.ndarray, "combination unknown"]

    __repr__ = brief

    @property
    def deviations(self) -> Float[np.ndarray, " unknown"]:
        """Standard deviations of the posterior."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def correlations(self) -> Float[np.ndarray, "unknown unknown"]:
        """Correlations of the posterior."""
        return np.asarray(self.covariance / np.outer(self.deviations, self.deviations))

    @property
    def condition(self) -> float:
        """Ratio of the largest to the smallest singular value."""
        smallest = float(self.information.min())
        return float(self.information.max()) / smallest if smallest > 0 else np.inf

    def untold(self) -> list[str]:
        """Return names of quantities about which the data tell little.

        Their posterior has at least 80 % of the standard deviation of the prior.
        """
        return [
            unknown.name
            for unknown, deviation in zip(self.unknowns, self.deviations, strict=True)
            if deviation > 0.8 * unknown.distribution.standard_deviation
        ]

    def alike(self) -> list[tuple[str, str, float]]:
        """Return pairs that the data cannot tell apart, and their correlation."""
        found, names = self.correlations, [each.name for each in self.unknowns]
        rows, columns = np.nonzero(np.triu(np.abs(found) > _ALIKE, k=1))
        pairs = zip(rows.tolist(), columns.tolist(), strict=True)
        return [(names[k], names[m], float(found[k, m])) for k, m in pairs]

    def at_bounds(self) -> list[str]:
        """Return names of quantities whose value is at an end of its range."""
        found = []
        for unknown, value in zip(self.unknowns, self.values, strict=True):
            own = unknown.distribution
            near = 0.01 * own.standard_deviation
            if min(value - own.low, own.high - value) < near:
                found.append(unknown.name)
        return found


def calibrate(
    predict: Predict,
    measured: Float[np.ndarray, " pair"],
    unknowns: Sequence[Unknown],
    *,
    clusters: Sequence[Int[np.ndarray, " pair"]] = (),
    relative_error: float | None = None,
) -> Calibration:
    """Return the quantities with which a model agrees best with measurements.

    Parameters
    ----------
    predict : model
    measured : measured values
    unknowns : quantities and their priors
    clusters : for each way in which errors may be alike, such as by time step or by
        sensor, the number of the cluster of each value
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
        weight = 1 / (before[1] * _scale(predict(values)))
        values = _solve(predict, measured, unknowns, weight, start=values)
        residual = (measured - predict(values)) / _scale(predict(values))
        if relative_error is None:
            told = max(len(measured) - len(unknowns), 1)
            error = max(float(np.sqrt(np.sum(residual**2) / told)), 1e-6)
        effect = max([1.0, *(_design_effect(residual, own) for own in clusters)])
        same = np.allclose(before[0], values, rtol=1e-6)
        if same and abs(before[1] / (error * np.sqrt(effect)) - 1) < 1e-4:
            break
    found = _posterior(predict, unknowns, values, error, effect)
    if relative_error is not None:
        return found
    wider = _unknown_error(len(measured), effect, len(unknowns))
    return replace(found, covariance=_cut(found.covariance * wider, unknowns))


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
    error = found.relative_error * np.sqrt(found.design_effect)
    weight = 1 / (error * _scale(predict(found.values)))
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
            theta = _solve(of, measured, rest, weight, start=theta)
        whole = np.full(len(found.unknowns), place)
        whole[others] = theta
        gap = (measured - predict(whole)) * weight
        losses.append(float(gap @ gap + np.sum(_prior(found.unknowns, whole) ** 2)))
    return places, np.array(losses[1:]) - losses[0]


def _solve(
    predict: Predict,
    measured: np.ndarray,
    unknowns: Sequence[Unknown],
    weight: np.ndarray,
    *,
    start: np.ndarray,
) -> np.ndarray:
    def residuals(theta: np.ndarray) -> np.ndarray:
        gap = (predict(theta) - measured) * weight
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


def _posterior(
    predict: Predict,
    unknowns: Sequence[Unknown],
    values: np.ndarray,
    error: float,
    effect: float,
) -> Calibration:
    spread = np.array([u.distribution.standard_deviation for u in unknowns])
    weight = 1 / (error * np.sqrt(effect) * _scale(predict(values)))
    columns = []
    for number, step in enumerate(1e-3 * spread):
        own = np.zeros(len(values))
        own[number] = step
        columns.append((predict(values + own) - predict(values - own)) / (2 * step))
    scaled = weight[:, None] * np.stack(columns, axis=1) * spread
    _, singular, combinations = np.linalg.svd(scaled, full_matrices=False)
    # Uniform distributions give no information but their bounds
    informed = np.array([float(u.distribution.shape != "uniform") for u in unknowns])
    curvature = scaled.T @ scaled + np.diag(np.maximum(informed, 1e-6))
    covariance = np.linalg.inv(curvature) * np.outer(spread, spread)
    covariance = _cut(covariance, unknowns)
    return Calibration(
        tuple(unknowns), values, covariance, error, effect, singular, combinations
    )


def _cut(covariance: np.ndarray, unknowns: Sequence[Unknown]) -> np.ndarray:
    # No deviation above that of the prior
    spread = np.array([u.distribution.standard_deviation for u in unknowns])
    limit = np.minimum(1.0, spread / np.sqrt(np.diag(covariance)))
    return np.asarray(covariance * np.outer(limit, limit))


def _unknown_error(count: int, effect: float, unknowns: int) -> float:
    # Variance of Student's t, as the error is estimated from few independent values
    freedom = max(count / effect - unknowns, 3.0)
    return (freedom + unknowns) / freedom * freedom / (freedom - 2)


def _scale(predicted: np.ndarray) -> np.ndarray:
    # Values to which errors are relative
    size = np.abs(predicted)
    return np.asarray(np.maximum(size, _LOW * float(np.median(size))))


def _inside(unknowns: Sequence[Unknown], values: np.ndarray) -> np.ndarray:
    low, high = np.array(
        [(each.distribution.low, each.distribution.high) for each in unknowns]
    ).T
    finite = np.where(np.isfinite(high - low), high - low, 1.0)
    return np.asarray(np.clip(values, low + 1e-6 * finite, high - 1e-6 * finite))


def _design_effect(residual: np.ndarray, cluster: np.ndarray) -> float:
    # 1 + (m − 1) ρ, with the correlation ρ of residuals within clusters of m values
    _, number, count = np.unique(cluster, return_inverse=True, return_counts=True)
    size, groups = len(residual), len(count)
    if groups < 2 or size == groups:
        return 1.0
    mean = np.bincount(number, residual) / count
    typical = (size - np.sum(count**2) / size) / (groups - 1)
    between = float(np.sum(count * (mean - residual.mean()) ** 2)) / (groups - 1)
    within = float(np.sum((residual - mean[number]) ** 2)) / (size - groups)
    shared = (between - within) / (between + (typical - 1) * within)
    return 1 + (typical - 1) * max(shared, 0.0)
