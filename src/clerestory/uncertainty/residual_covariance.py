"""Covariance of residuals: errors of measured values, and of the simulation.

The errors of a simulation are alike over the hours of a sensor. They are known from the
error components of the trace; those of different sensors are taken as independent,
as each sensor has its own random numbers. The error of a sensor itself, such as of its
calibration, and the errors of single values are estimated from the residuals. In units
of the scale of each value, the covariance is

    Σ = σ² D I + τ² 1 1ᵀ + C Cᵀ for values of the same sensor, 0 for others,

with the error components C and the design effect D of times. Residuals are multiplied
by the symmetric Σ^(-1/2), which keeps the order of the values.

References: G. H. Golub, C. F. Van Loan, Matrix Computations, 2013, 6.1.2 (generalised
least squares); L. Kish, Survey Sampling, 1965 (design effect); R. C. Paule, J. Mandel,
Journal of Research of the National Bureau of Standards 87 (5), 1982 (τ); F. E.
Satterthwaite, Biometrics Bulletin 2 (6), 1946 (degrees of freedom).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import optimize, sparse

from clerestory.brief_repr import brief
from clerestory.checks import same_length

# Values below this share of the median have the absolute error of that share
_LOW = 0.2


@dataclass(frozen=True, eq=False)
class SensorErrors:
    """Errors that values of a sensor have in common.

    Attributes
    ----------
    sensors : number of the sensor of each value
    components : independent parts of the error of each simulated value, relative to the
        value; the sum of their squares is the variance
    deviation : relative standard deviation of the error of a sensor itself
    """

    sensors: Int[np.ndarray, " pair"]
    components: Float[np.ndarray, "pair component"]
    deviation: float = 0.0

    __repr__ = brief

    def __post_init__(self) -> None:
        same_length(self.components, self.sensors, "error components", "sensors")

    def where(self, rows: np.ndarray) -> "SensorErrors":
        """Return the errors of some values."""
        return SensorErrors(self.sensors[rows], self.components[rows], self.deviation)

    def scaled(self, share: Float[np.ndarray, " pair"]) -> np.ndarray:
        """Return all parts, over (pair, part); `share` is value over scale."""
        own = np.full((len(share), 1), self.deviation)
        return np.concatenate([own, self.components * share[:, None]], axis=1)


@dataclass(frozen=True, eq=False)
class Whitening:
    """Multiplication by the inverse square root of the covariance.

    Attributes
    ----------
    scale : value to which the error of each value is relative
    deviation : relative standard deviation of the independent errors
    directions : orthonormal directions of the errors of sensors, over (pair, direction)
    factors : factor of each direction
    """

    scale: Float[np.ndarray, " pair"]
    deviation: float
    directions: sparse.csr_array
    factors: Float[np.ndarray, " direction"]

    __repr__ = brief

    def __call__(self, values: Float[np.ndarray, "pair ..."]) -> np.ndarray:
        """Return values, or columns of them, with unit covariance."""
        found = (values.T / (self.deviation * self.scale)).T
        if not self.factors.size:
            return np.asarray(found)
        shares = self.directions.T @ found
        return np.asarray(found + self.directions @ (shares.T * (self.factors - 1)).T)


def whitening(
    predicted: Float[np.ndarray, " pair"],
    deviation: float,
    common: SensorErrors | None = None,
) -> Whitening:
    """Return the whitening of residuals.

    Parameters
    ----------
    predicted : predicted values
    deviation : relative standard deviation of the independent errors
    common : errors that values of a sensor have in common

    Examples
    --------
    Two values of one sensor, with an error of the simulation as large as their own:

    >>> error = SensorErrors(np.zeros(2, int), np.full((2, 1), 0.1))
    >>> whiten = whitening(np.full(2, 100.0), 0.1, error)
    >>> np.linalg.inv(whiten(np.eye(2)) @ whiten(np.eye(2))).round(3).tolist()
    [[200.0, 100.0], [100.0, 200.0]]
    """
    scale = scale_of(predicted)
    if common is None:
        nothing = sparse.csr_array((len(scale), 0))
        return Whitening(scale, deviation, nothing, np.zeros(0))
    parts = common.scaled(predicted / scale) / deviation
    order = np.argsort(common.sensors, kind="stable")
    ends = np.flatnonzero(np.diff(common.sensors[order])) + 1
    blocks, factors = [], []
    for rows in np.split(order, ends):
        directions, sizes, _ = np.linalg.svd(parts[rows], full_matrices=False)
        blocks.append(directions)
        factors.append(1 / np.sqrt(1 + sizes**2))
    sorted_rows = sparse.block_diag(blocks, format="csr")
    found = sparse.csr_array(sorted_rows[np.argsort(order)])
    return Whitening(scale, deviation, found, np.concatenate(factors))


def scale_of(predicted: Float[np.ndarray, " pair"]) -> Float[np.ndarray, " pair"]:
    """Return the values to which errors are relative."""
    size = np.abs(predicted)
    return np.asarray(np.maximum(size, _LOW * float(np.median(size))))


def design_effect(
    residual: Float[np.ndarray, " pair"],
    sensitivity: Float[np.ndarray, "pair unknown"],
    cluster: Int[np.ndarray, " pair"],
) -> float:
    """Return the factor by which correlation within clusters raises variances.

    1 + (m − 1) ρ, with the correlation ρ of errors within clusters of m values. A fit
    takes up part of the differences between clusters, and ρ would be too small without
    its degrees of freedom.

    Parameters
    ----------
    residual : residuals of a least-squares fit
    sensitivity : Q, where Q Qᵀ takes a change of the values to that of fitted values
    cluster : number of the cluster of each value
    """
    _, number, count = np.unique(cluster, return_inverse=True, return_counts=True)
    size, groups = len(residual), len(count)
    if groups < 2 or size == groups:
        return 1.0
    fitted = float(np.sum(sensitivity**2))
    about = sensitivity - sensitivity.mean(axis=0)
    taken = float(np.sum(_cluster_means(about, number) ** 2))
    mean = np.bincount(number, residual) / count
    typical = (size - np.sum(count**2) / size) / (groups - 1)
    free = max(groups - 1 - taken, 1.0), max(size - groups - (fitted - taken), 1.0)
    between = float(np.sum(count * (mean - residual.mean()) ** 2)) / free[0]
    within = float(np.sum((residual - mean[number]) ** 2)) / free[1]
    shared = (between - within) / (between + (typical - 1) * within)
    return 1 + (typical - 1) * max(shared, 0.0)


def sensor_deviation(
    residual: Float[np.ndarray, " pair"],
    sensitivity: Float[np.ndarray, "pair unknown"],
    deviation: float,
    common: SensorErrors,
    share: Float[np.ndarray, " pair"],
) -> float:
    """Return the relative standard deviation τ of the errors of sensors.

    The mean residuals of k sensors have the variances v = τ² + σ² / n + c²; τ is where
    Σ mean² / v is its expectation, k less the degrees of freedom that the fit takes up
    (Paule and Mandel).

    Parameters
    ----------
    residual : residuals of a least-squares fit in units of their scale
    sensitivity : Q, as in `design_effect`
    deviation : σ, relative standard deviation of the errors of values
    common : error components of the simulation
    share : predicted values over their scale
    """
    _, number, count = np.unique(
        common.sensors, return_inverse=True, return_counts=True
    )
    free = len(count) - float(np.sum(_cluster_means(sensitivity, number) ** 2))
    mean = np.bincount(number, residual) / count
    scaled = common.components * share[:, None]
    parts = [np.bincount(number, own) / count for own in scaled.T]
    least = deviation**2 / count + np.sum(np.square(parts), axis=0)

    def excess(variance: float) -> float:
        return float(np.sum(mean**2 / (variance + least))) - max(free, 1.0)

    if excess(0.0) <= 0:
        return 0.0
    high = float(np.sum(mean**2)) / max(free, 1.0)
    return float(np.sqrt(optimize.brentq(excess, 0.0, high)))


def freedom_of_errors(
    sensitivity: Float[np.ndarray, "pair unknown"],
    effect: float,
    common: SensorErrors | None,
) -> float:
    """Return the degrees of freedom from which the errors of a fit are estimated.

    What means of sensors tell has the error of sensors, estimated from their number;
    the rest has the error of values. Satterthwaite's formula joins both.

    Parameters
    ----------
    sensitivity : Q, as in `design_effect`
    effect : number of values that count as one
    common : errors that values of a sensor have in common
    """
    fitted = float(np.sum(sensitivity**2))
    within = max(len(sensitivity) / effect - fitted, 1.0)
    if common is None or fitted == 0:
        return within
    _, number = np.unique(common.sensors, return_inverse=True)
    taken = float(np.sum(_cluster_means(sensitivity, number) ** 2))
    between, share = max(number.max() + 1 - taken, 1.0), taken / fitted
    return float(1 / (share**2 / between + (1 - share) ** 2 / within))


def _cluster_means(values: np.ndarray, number: np.ndarray) -> np.ndarray:
    # Means over clusters times the root of their sizes, over (cluster, column)
    root = np.sqrt(np.bincount(number))
    return np.stack([np.bincount(number, own) / root for own in values.T], axis=1)
