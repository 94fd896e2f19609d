"""Smoothing of glare sources: dark pixels surrounded by a source are added to it."""

import numpy as np
from scipy import fft

from clerestory.array_types import Image, ImageMask

# A dark pixel is added if source pixels fill more than this fraction of the disc
_SHARE = 0.2


def surrounded(mine: ImageMask, solid_angle: Image, radius: float) -> ImageMask:
    """Whether more than a fifth of the disc around each pixel belongs to a source.

    `mine` are the pixels of the source; the radius of the disc is in pixels. The
    fraction is that of the solid angle of the disc. As in evalglare, discs that cross
    the right or upper edge of the picture exclude the rightmost column or the top row.
    """
    rows, columns = mine.shape
    reach = int(np.ceil(radius)) + 1
    top, bottom, left, right = _box(mine, reach)
    wide_top, wide_bottom = max(top - reach, 0), min(bottom + reach, rows)
    wide_left, wide_right = max(left - reach, 0), min(right + reach, columns)
    wide = np.s_[wide_top:wide_bottom, wide_left:wide_right]

    over_right = np.arange(columns) + np.floor(radius) > columns - 1
    over_top = np.arange(rows) - np.floor(radius) < 0
    line = np.arange(-np.floor(radius), np.floor(radius) + 1)
    disc = (np.hypot(*np.meshgrid(line, line)) <= radius).astype(int)
    inside = np.zeros(mine.shape, dtype=bool)
    for past_right in (False, True):
        for past_top in (False, True):
            weight = solid_angle.copy()
            weight[:, -1] *= not past_right
            weight[0] *= not past_top
            here = np.outer(over_top == past_top, over_right == past_right)[wide]
            if not here.any():
                continue
            held = _around((weight * mine)[wide], disc)
            total = _around(weight[wide], disc)
            inside[wide] |= here & (held > _SHARE * total) & (total > 0)
    keep = np.zeros_like(inside)
    keep[top:bottom, left:right] = True
    return inside & keep


def _around(weight: np.ndarray, disc: np.ndarray) -> np.ndarray:
    # Convolution with the disc; scipy.signal is not used, since it loads slowly
    rows, columns = weight.shape
    reach = disc.shape[0] // 2
    size = [fft.next_fast_len(n + 2 * reach, real=True) for n in weight.shape]
    product = fft.rfft2(weight, size) * fft.rfft2(disc, size)
    total = np.asarray(fft.irfft2(product, size))
    return total[reach : reach + rows, reach : reach + columns]


def _box(mine: np.ndarray, reach: int) -> tuple[int, int, int, int]:
    # Bounding box of the source pixels, enlarged by `reach`
    rows, columns = np.flatnonzero(mine.any(axis=1)), np.flatnonzero(mine.any(axis=0))
    return (
        max(int(rows[0]) - reach, 0),
        min(int(rows[-1]) + reach + 1, mine.shape[0]),
        max(int(columns[0]) - reach, 0),
        min(int(columns[-1]) + reach + 1, mine.shape[1]),
    )
