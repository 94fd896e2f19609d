"""Standard errors of glare indices, from the statistical errors of the pixels.

The indices are not linear in luminance, and a pixel near the threshold belongs to a
source or not. Each index is therefore computed for pairs of pictures, the luminance
plus and minus a random draw of its error, including the detection of sources.
The variance of an index is the mean square of half of the differences, plus the
variance of the means of the pairs: a pixel that crosses the threshold in one picture of
one pair, but of no other pair, changes both. Draws are Gaussian; with errors of equal
size, too few pixels would cross the threshold.

Reference: P. J. McCarthy, "Pseudo-replication: half samples", Review of the
International Statistical Institute 37 (3), 1969.
"""

import math
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from statistics import NormalDist

import numpy as np
from jaxtyping import Float

from clerestory.array_types import EachImage, Image
from clerestory.checks import require
from clerestory.image.picture import Picture, same_size

# Number of pairs of pictures
DRAWS = 8


@dataclass(frozen=True, eq=False)
class UncertainLuminance:
    """Luminance of the pixels of a picture, with its statistical error [cd/m²].

    Attributes
    ----------
    value : luminance
    error : standard error of each pixel, independent of those of other pixels
    shared : draws of errors that pixels have in common, such as that of the daylight
        matrix; the mean of their squares is the variance
    blocks : mean luminance of blocks of pixels, if errors are those of blocks
    """

    value: Image
    error: EachImage
    shared: Float[np.ndarray, "draw across down"] | None = None
    blocks: EachImage | None = None

    def __post_init__(self) -> None:
        least = float(self.error.min())
        message = f"smallest standard error of a pixel is {least:g}; 0 or more expected"
        require(least >= 0, message)

    def of_blocks(self) -> "UncertainLuminance":
        """Return the luminance of the blocks, as that of a smaller picture."""
        if self.blocks is None:
            return self
        return UncertainLuminance(self.blocks, self.error, self.shared)

    def pairs(self) -> Iterator[tuple[Image, Image]]:
        """Yield the luminance plus and minus draws of its error.

        The draws of a pixel are stratified samples of the normal distribution, so that
        their mean square is exactly its variance.
        """
        # Seed from the picture, so that equal pictures have equal errors
        seed, shape = zlib.crc32(self.error.tobytes()), self.value.shape
        random = np.random.default_rng(seed)
        shared = np.zeros((DRAWS, 1, 1)) if self.shared is None else self.shared
        size = _half_normal(len(shared))
        first = random.integers(0, len(shared), shape, dtype=np.int8)
        for number, common in enumerate(shared):
            sign = 2 * random.integers(0, 2, shape, dtype=np.int8) - 1
            change = sign * size[(first + number) % len(shared)] * self.error + common
            yield np.maximum(self.value + change, 0), np.maximum(self.value - change, 0)


@cache
def _half_normal(count: int) -> Float[np.ndarray, " draw"]:
    # Medians of intervals of equal probability of |x|, scaled to a mean square of one
    share = 0.5 + (np.arange(count) + 0.5) / (2 * count)
    found = np.array([NormalDist().inv_cdf(p) for p in share])
    return np.asarray(found / np.sqrt(np.mean(np.square(found))), np.float32)


def luminance_error(error: Picture, like: Picture) -> Image:
    """Return the standard error of the luminance of a picture [cd/m²].

    `error` contains the standard error of the radiance in each band. The errors of the
    bands are assumed to be fully correlated, as in grey scenes.
    """
    same_size(error.radiance, like.radiance, "the picture of standard errors")
    return error.luminance()


def index_errors(
    luminance: UncertainLuminance, quantities: Callable[[Image], Mapping[str, float]]
) -> dict[str, float]:
    """Return the standard error of each quantity of a picture.

    >>> picture = UncertainLuminance(np.full((30, 30), 9.0), np.full((30, 30), 0.3))
    >>> found = index_errors(picture, lambda pixels: {"mean": float(pixels.mean())})
    >>> 0.005 < found["mean"] < 0.02  # 0.3/√900
    True
    """
    found: dict[str, list[tuple[float, float]]] = {}
    for plus, minus in luminance.pairs():
        other = quantities(minus)
        for name, value in quantities(plus).items():
            found.setdefault(name, []).append((value, other[name]))
    return {name: _error(np.array(pairs)) for name, pairs in found.items()}


def _error(pairs: Float[np.ndarray, "draw two"]) -> float:
    # Variance of half differences, whose expectation is zero, and of means
    half, mean = np.diff(pairs, axis=1) / 2, pairs.mean(axis=1)
    return math.sqrt(np.mean(np.square(half)) + mean.var(ddof=1))
