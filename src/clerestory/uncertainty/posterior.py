"""Fitted quantities of a calibration: posterior, and what the data cannot tell."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.uncertainty.draws import Unknown
from clerestory.uncertainty.residual_covariance import SensorErrors

# Singular value, in standard deviations of the prior, from which data tell a
# combination of quantities, and correlation from which two cannot be told apart
_TOLD, _ALIKE = 1.0, 0.9


@dataclass(frozen=True, eq=False)
class Calibration:
    """Fitted quantities and their posterior.

    Attributes
    ----------
    unknowns : quantities with their priors
    values : most probable values
    covariance : covariance of the posterior
    relative_error : relative error of a single measured value, estimated from the
        residuals
    design_effect : factor by which correlation of the residuals raises variances
    information : singular values of the data's sensitivity, in standard deviations of
        the priors; combinations with values below 1 are told by the priors
    combinations : combination of quantities of each singular value, over
        (combination, unknown)
    common : errors that the values of a sensor have in common
    """

    unknowns: tuple[Unknown, ...]
    values: Float[np.ndarray, " unknown"]
    covariance: Float[np.ndarray, "unknown unknown"]
    relative_error: float
    design_effect: float
    information: Float[np.ndarray, " combination"]
    combinations: Float[np.ndarray, "combination unknown"]
    common: SensorErrors | None = None

    __repr__ = brief

    @property
    def sensor_error(self) -> float:
        """Relative error that all values of a sensor have in common."""
        return self.common.deviation if self.common else 0.0

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
