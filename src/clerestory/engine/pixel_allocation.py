"""Allocation of paths to pixels in proportion to their estimated errors.

The number of paths of a pixel is chosen from the variances of its neighbours alone, and
of a pilot run in which all pixels have equally many paths. Since the random numbers of
pixels are independent, the number is independent of the pixel's own samples. Chosen
from its own variance, pixels that miss a rare bright path would keep few paths, and the
picture would be too dark.

The variance of a mean decreases as n^-p. Minimising Σ c n^-p for a given Σ n gives
n ∝ c^(1/(1+p)), the allocation of J. Neyman (Journal of the Royal Statistical Society
97 (4), 1934) for p = 1. Bias of adaptive sampling by own samples: D. Kirk and J. Arvo,
"Unbiased sampling techniques for image synthesis", SIGGRAPH 1991.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.ndimage import convolve1d

from clerestory.engine.batch_lengths import CONVERGENCE

# Exponent of the variance
_POWER = 2 / CONVERGENCE

# Edges of the squares of neighbours [pixels], and weights of their mean variances.
# The smaller one follows edges, the larger one contains more samples
_NEIGHBOURS = ((3, 0.75), (7, 0.25))

# Least variance, relative to the mean of all pixels: a pixel that is noisy among pixels
# without noise has paths too
_LEAST = 0.01

# Steps of the search for the scale of an allocation, and range of its logarithm
_HALVINGS, _RANGE = 30, 64.0

# Resolution of the logarithms of ideal numbers of paths
_STEPS = 16


@dataclass(frozen=True, eq=False)
class Allocation:
    """Ideal distribution of paths over pixels, after a pilot run.

    Attributes
    ----------
    share : contribution of each pixel to the squared error; the sum is 1
    ideal : binary logarithm of the ideal number of paths, up to a constant
    """

    share: Float[np.ndarray, " pixel"]
    ideal: Float[np.ndarray, " pixel"]

    @classmethod
    def of(cls, contributions: Float[np.ndarray, "row column"]) -> "Allocation":
        """Return the allocation for the contributions of pixels in the pilot run."""
        total = float(contributions.sum())
        equal = np.full(contributions.shape, 1 / contributions.size)
        share = contributions / total if total > 0 else equal
        near = np.maximum(mean_of_neighbours(share), _LEAST / share.size)
        return cls(share.ravel(), (np.log2(near) / (1 + _POWER)).ravel())

    def doublings(self, factor: float, most: int) -> Int[np.ndarray, " pixel"]:
        """Return how many times the paths of each pixel are doubled, at most `most`.

        The doublings are the fewest that are predicted to divide the error of the pilot
        run by `factor`.
        """
        # Group pixels of equal ideal numbers
        levels, group = np.unique(np.round(self.ideal * _STEPS), return_inverse=True)
        share = np.bincount(group, self.share, len(levels))

        # Search the smallest scale, by its logarithm
        low, high = 0.0, _RANGE
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            steps = _rounded(levels, middle, most)
            enough = float(share @ np.exp2(-_POWER * steps)) <= factor**-2
            low, high = (low, middle) if enough else (middle, high)
        chosen: np.ndarray = _rounded(levels, high, most)[group]
        return chosen


def mean_of_neighbours(
    values: Float[np.ndarray, "row column"],
) -> Float[np.ndarray, "row column"]:
    """Return the weighted mean of the neighbours of each pixel, without the pixel.

    Neighbours within one pixel have a weight of 3/4, those within three pixels of 1/4.

    >>> mean_of_neighbours(np.array([[1.0, 0.0, 0.0]])).round(3).tolist()
    [[0.0, 0.5, 0.125]]
    """
    total, one = np.zeros(values.shape), np.ones(values.shape)
    for edge, weight in _NEIGHBOURS:
        around = _sum_around(values, edge) - values
        number = _sum_around(one, edge) - 1
        # A picture of one pixel has no neighbours
        total += weight * np.maximum(around, 0) / np.maximum(number, 1)
    return total


def _sum_around(
    values: Float[np.ndarray, "row column"], edge: int
) -> Float[np.ndarray, "row column"]:
    ones = np.ones(edge)
    along = convolve1d(values, ones, axis=0, mode="constant")
    both: np.ndarray = convolve1d(along, ones, axis=1, mode="constant")
    return both


def _rounded(
    levels: Float[np.ndarray, " level"], scale: float, most: int
) -> Int[np.ndarray, " level"]:
    steps = np.round((levels - levels[-1]) / _STEPS + scale)
    return np.asarray(np.clip(steps, 0, most).astype(np.int64))
