"""Peak extraction: the brightest pixels of a glare source become separate sources.

Without peak extraction, the luminance of the sun or its specular reflection would be
averaged with that of a bright sky.
"""

import numpy as np
from jaxtyping import Bool, Int

from clerestory.array_types import Image
from clerestory.glare.neighbour_search import Neighbourhood
from clerestory.glare.pixel_scan import ScannedPixels, islands
from clerestory.glare.source_merging import merge_sources

# Row and column offsets of the adjacent pixels that are scanned before a pixel
_BEFORE = ((1, 0), (1, -1), (0, -1), (-1, -1))


def split_peaks(
    peaks: ScannedPixels, solid_angle: Image, near: Neighbourhood, nearer: Neighbourhood
) -> Int[np.ndarray, " pixel"]:
    """Group the peak pixels of one source; return a label per pixel, from 1.

    The search angles `near` and `nearer` are half and a quarter of the merging angle.
    """
    place = np.full(solid_angle.shape, -1, dtype=np.int64)
    row, column = peaks.row, peaks.column
    place[row, column] = np.arange(row.size)
    turned = np.ascontiguousarray((place >= 0)[::-1].T)
    peaks = peaks._replace(island=islands(turned, nearer.reach))

    # `birth` is, for each pixel, the index of the first pixel of its group
    alone = _is_alone(row, column, place, nearer)
    tips = np.bincount(peaks.island, weights=alone)
    begin = np.full(tips.size, row.size)
    np.minimum.at(begin, peaks.island, np.arange(row.size))
    birth = begin[peaks.island]
    picture = np.zeros(solid_angle.shape, dtype=np.int64)
    for pixel in np.flatnonzero(tips[peaks.island] > 1):
        label = _last_found(picture, int(row[pixel]), int(column[pixel]), nearer)
        picture[row[pixel], column[pixel]] = label or pixel + 1
        birth[pixel] = picture[row[pixel], column[pixel]] - 1
    _, labels = np.unique(birth, return_inverse=True)

    wide = peaks._replace(island=islands(turned, near.reach))
    return merge_sources(wide, labels + 1, solid_angle, near, skip_inner=False)


def _is_alone(
    row: np.ndarray, column: np.ndarray, place: np.ndarray, nearer: Neighbourhood
) -> np.ndarray:
    # Whether none of the adjacent pixels scanned before a pixel is a peak pixel; if one
    # is, the search always finds it
    rows, _ = place.shape
    alone = np.ones(row.size, dtype=bool)
    close = nearer.sure_reach[row, column] >= np.sqrt(2)
    sees_row = ~nearer.blind(row, column)
    for down, right in _BEFORE:
        there_row, there_column = row + down, column + right
        inside = (there_row >= 0) & (there_row < rows) & (there_column >= 0)
        inside &= close if down else close & sees_row
        alone[inside] &= place[there_row[inside], there_column[inside]] < 0
    return alone


def _last_found(
    picture: np.ndarray, row: int, column: int, nearer: Neighbourhood
) -> int:
    # Source label found last if entire rows are searched downwards, then upwards
    window = nearer.window(row, column)
    height, width = window.near.shape
    part = picture[window.top : window.top + height, window.left : window.left + width]
    found: Bool[np.ndarray, "height width"] = (part > 0) & window.near
    if window.blind:
        found[row - window.top, : column - window.left] = False
    rows = np.flatnonzero(found.any(axis=1))
    if not rows.size:
        return 0
    above = rows[rows < row - window.top]
    last = above[0] if above.size else rows[-1]
    columns = np.flatnonzero(found[last])
    at = columns[-1] if columns[-1] > column - window.left else columns[0]
    return int(part[last, at])
