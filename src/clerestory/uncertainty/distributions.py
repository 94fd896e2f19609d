"""Probability distributions of quantities that are not known exactly.

Normal, uniform and triangular distributions, cut to the physical range of a quantity,
and choices of equal probability. Draws are made from quantiles, so that quasi-random
numbers can be used.
"""

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import scipy
from jaxtyping import Float

from clerestory.checks import one_of, positive, require

Shape = Literal["normal", "uniform", "triangular", "choice"]


@dataclass(frozen=True)
class Distribution:
    """Distribution of a number.

    Attributes
    ----------
    shape : "normal", "uniform", "triangular" or "choice"
    low, high : ends of the range; values outside do not occur
    centre : mean of a normal distribution before it is cut; mode of a triangular one
    deviation : standard deviation of a normal distribution before it is cut

    Examples
    --------
    >>> floor = normal(0.3, 0.05, low=0.0, high=1.0)
    >>> floor.quantiles(np.array([0.5])).round(6).tolist(), round(floor.deviation, 3)
    ([0.3], 0.05)
    """

    shape: Shape
    low: float
    high: float
    centre: float = np.nan
    deviation: float = np.nan

    def __post_init__(self) -> None:
        one_of(self.shape, "shape of a distribution", choices=get_args(Shape))
        ends = f"range from {self.low:g} to {self.high:g}"
        require(self.low < self.high, f"{ends}; a smaller low end expected")
        if self.shape == "normal":
            positive(self.deviation, "standard deviation")
        if self.shape in ("normal", "triangular"):
            inside = self.low <= self.centre <= self.high
            found = f"{self.centre:g} is outside the {ends}"
            require(inside, f"{found}; a value inside expected")

    def quantiles(self, share: Float[np.ndarray, "*any"]) -> Float[np.ndarray, "*any"]:
        """Return the values below which the given shares 0…1 of all draws are."""
        if self.shape == "choice":
            number = np.floor(self.low + share * (self.high - self.low))
            return np.asarray(np.minimum(number, self.high - 1))
        return np.asarray(self._scipy().ppf(share))

    @property
    def mean(self) -> float:
        """Mean; the middle of the numbers of a choice."""
        if self.shape == "choice":
            return (self.low + self.high - 1) / 2
        return float(self._scipy().mean())

    @property
    def standard_deviation(self) -> float:
        """Standard deviation, also of a distribution that is cut."""
        if self.shape == "choice":
            return float(np.sqrt(((self.high - self.low) ** 2 - 1) / 12))
        return float(self._scipy().std())

    def _scipy(self) -> Any:
        width = self.high - self.low
        if self.shape == "uniform":
            return scipy.stats.uniform(self.low, width)
        if self.shape == "triangular":
            return scipy.stats.triang((self.centre - self.low) / width, self.low, width)
        ends = [(end - self.centre) / self.deviation for end in (self.low, self.high)]
        return scipy.stats.truncnorm(*ends, self.centre, self.deviation)


def normal(
    mean: float, deviation: float, *, low: float = -np.inf, high: float = np.inf
) -> Distribution:
    """Return a normal distribution, cut to the range from `low` to `high`."""
    return Distribution("normal", low, high, mean, deviation)


def uniform(low: float, high: float) -> Distribution:
    """Return the distribution in which all values of a range are equally probable.

    >>> uniform(0.2, 0.4).quantiles(np.array([0.25])).round(6).tolist()
    [0.25]
    """
    return Distribution("uniform", low, high)


def triangular(low: float, mode: float, high: float) -> Distribution:
    """Return a triangular distribution with its maximum at `mode`."""
    return Distribution("triangular", low, high, mode)


def choice(count: int) -> Distribution:
    """Return the distribution of the numbers 0 to `count` − 1, equally probable.

    >>> choice(3).quantiles(np.array([0.1, 0.5, 0.99])).tolist()
    [0.0, 1.0, 2.0]
    """
    return Distribution("choice", 0.0, float(count))
