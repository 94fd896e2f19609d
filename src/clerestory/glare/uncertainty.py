"""Standard errors of glare indices, from the statistical errors of the pixels.

The indices are not linear in luminance, and a pixel near the threshold belongs to a
source or not. Each index is therefore computed for pairs of pictures, the luminance
plus and minus a random draw of its error, each with the source pixels of its own.
The variance of an index is the mean square of half of the differences, plus the
variance of the means of the pairs: a pixel that crosses the threshold in one picture of
one pair, but of no other pair, changes both. Draws are Gaussian; with errors of equal
size, too few pixels would cross the threshold.

Reference: P. J. McCarthy, "Pseudo-replication: half samples", Review of the
International Statistical Institute 37 (3), 1969.
"""

import zlib
from dataclasses import dataclass
from functools import cache
from statistics import NormalDist

import numpy as np
from jaxtyping import Float, Float32

from clerestory.array_types import EachImage, Image, Pictures
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

    def pairs(self) -> Pictures:
        """Return the luminance plus draws of its error, then minus the same draws.

        The draws of a pixel are stratified samples of the normal distribution, so that
        their mean square is exactly its variance.
        """
        # Seed from the picture, so that equal pictures have equal errors
        random = np.random.default_rng(zlib.crc32(self.error.tobytes()))
        count = DRAWS if self.shared is None else len(self.shared)
        shape = self.value.shape
        first = random.integers(0, count, shape, dtype=np.uint16)
        change = np.take(_rotations(count), first, axis=1)
        change *= _signs(random, change.size).reshape(change.shape)
        change = change * self.error
        if self.shared is not None:
            change += self.shared
        pictures = np.concatenate([self.value + change, self.value - change])
        return np.asarray(np.maximum(pictures, 0, out=pictures))


@cache
def _rotations(count: int) -> Float32[np.ndarray, "draw draw"]:
    # Medians of intervals of equal probability of |x|, scaled to a mean square of one;
    # a column begins with each of them
    share = 0.5 + (np.arange(count) + 0.5) / (2 * count)
    size = np.array([NormalDist().inv_cdf(p) for p in share])
    size /= np.sqrt(np.mean(np.square(size)))
    draw = np.arange(count)
    return np.asarray(size[np.add.outer(draw, draw) % count], np.float32)


def _signs(random: np.random.Generator, count: int) -> Float32[np.ndarray, " count"]:
    # Random signs, eight from each random byte
    bits = np.unpackbits(np.frombuffer(random.bytes(-(-count // 8)), np.uint8))
    return 1 - 2 * bits[:count].astype(np.float32)


def luminance_error(error: Picture, like: Picture) -> Image:
    """Return the standard error of the luminance of a picture [cd/m²].

    `error` contains the standard error of the radiance in each band. The errors of the
    bands are assumed to be fully correlated, as in grey scenes.
    """
    same_size(error.radiance, like.radiance, "the picture of standard errors")
    return error.luminance()


def index_errors(
    values: Float[np.ndarray, "quantity picture"],
) -> Float[np.ndarray, " quantity"]:
    """Return the standard error of quantities, from their values in pairs of pictures.

    >>> picture = UncertainLuminance(np.full((30, 30), 9.0), np.full((30, 30), 0.3))
    >>> [error] = index_errors(picture.pairs().mean(axis=(1, 2))[None])
    >>> bool(0.005 < error < 0.02)  # 0.3/√900
    True
    """
    plus, minus = np.split(values, 2, axis=1)
    # Variance of half differences, whose expectation is zero, and of means
    variance = np.square((plus - minus) / 2).mean(axis=1)
    means = (plus + minus) / 2
    variance += (means - means[:, :1]).var(axis=1, ddof=1)
    return np.asarray(np.sqrt(variance))
