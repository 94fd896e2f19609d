"""First scan of glare source detection: grouping of glare pixels.

The picture is scanned column by column from the left, each column from the bottom up.
Consecutive glare pixels in a column (a run) belong to one source. If a previously
scanned pixel within half the merging angle of the first pixel of the run belongs to a
source, the run is added to that source; otherwise it begins a new source.

Several pictures of one view are scanned together, as one picture.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Int
from scipy import ndimage

from clerestory.array_types import ImageMask
from clerestory.glare.mask_stack import MaskStack
from clerestory.glare.neighbour_search import Neighbourhood
from clerestory.glare.scan_search import previous_pixels

# Fraction of the search radius within which the search always finds a previous pixel
_SURE = 0.6

_AROUND = np.ones((3, 3), dtype=bool)

# Number of cells per search radius, in the coarse grid of `islands`
_CELLS = 4


class ScannedPixels(NamedTuple):
    """Glare pixels in the order of the scan, each with the index of its island."""

    row: Int[np.ndarray, " pixel"]
    column: Int[np.ndarray, " pixel"]
    island: Int[np.ndarray, " pixel"]


def scan_order(mask: ImageMask, reach: int) -> ScannedPixels:
    """Return the pixels of a mask column by column, each column from the bottom up."""
    # Restrict the scan to the bounding box of the mask
    used_rows = np.flatnonzero(mask.any(axis=1))
    if not used_rows.size:
        none = np.zeros(0, dtype=np.int64)
        return ScannedPixels(none, none, none)
    used_columns = np.flatnonzero(mask.any(axis=0))
    top, bottom = used_rows[0], used_rows[-1] + 1
    left, right = used_columns[0], used_columns[-1] + 1
    turned = np.ascontiguousarray(mask[top:bottom, left:right][::-1].T)
    across, up = np.nonzero(turned)
    return ScannedPixels(bottom - 1 - up, across + left, islands(turned, reach))


def islands(mask: ImageMask, reach: int) -> Int[np.ndarray, " pixel"]:
    """Return the island index, from 0, of each pixel of the mask, in row-major order.

    Islands are groups of pixels more than `reach` rows or columns apart, and are
    processed separately. They are found on a coarse grid, which may join close islands.

    >>> mask = np.zeros((40, 40), bool)
    >>> mask[2, [2, 5, 38]] = True
    >>> islands(mask, 8).tolist()
    [0, 0, 1]
    """
    size = max(reach // _CELLS, 1)
    row, column = np.nonzero(mask)
    row, column = row // size, column // size
    cells = np.zeros((row.max(initial=0) + 1, column.max(initial=0) + 1), dtype=bool)
    cells[row, column] = True
    # Dilate the cells by half the search radius, so that islands within the radius join
    grow = (reach // size + 2) // 2
    grown = np.pad(cells, grow)
    grown = ndimage.maximum_filter(grown, size=2 * grow + 1)
    labels, _ = ndimage.label(grown, structure=_AROUND)
    return np.asarray(labels[row + grow, column + grow] - 1)


def first_scan(
    pixels: ScannedPixels,
    stack: MaskStack,
    near: Neighbourhood,
    *,
    single: bool,
) -> Int[np.ndarray, " pixel"]:
    """Return the source label of each pixel after the first scan, from 1 in a picture.

    With `single`, every pixel is a run of its own.
    """
    row, column, island = pixels
    begins = np.ones(row.size, dtype=bool)
    if not single:
        begins[1:] = (np.diff(column) != 0) | (np.diff(row) != -1)
    run = np.cumsum(begins) - 1
    start = np.flatnonzero(begins)
    alone = _may_be_first(pixels, start, stack, near)

    # An island in which at most one run can begin a source is one source
    tips = np.bincount(island[start], weights=alone, minlength=island.max() + 1)
    first_run = np.full(tips.size, start.size)
    np.minimum.at(first_run, island[start], np.arange(start.size))
    birth = first_run[island[start]]  # first run of the source of each run
    several = np.flatnonzero(tips[island[start]] > 1)
    if several.size:
        birth[several] = _births(several, start, run, pixels, stack, near)

    births, number = np.unique(birth, return_inverse=True)
    rank = _ranks(row[start[births]] // stack.pitch)
    return np.asarray(rank[number[run]] + 1)


def _ranks(picture: Int[np.ndarray, " source"]) -> Int[np.ndarray, " source"]:
    # Number of previous sources of the same picture
    order, counts = np.argsort(picture, kind="stable"), np.bincount(picture)
    rank = np.empty_like(order)
    rank[order] = np.arange(order.size) - np.repeat(np.cumsum(counts) - counts, counts)
    return rank


def _may_be_first(
    pixels: ScannedPixels,
    start: np.ndarray,
    stack: MaskStack,
    near: Neighbourhood,
) -> np.ndarray:
    # Whether a run may begin a source: no previous glare pixel is in the region that is
    # always searched, a rectangle to the upper left and the column below
    row, column = pixels.row[start], pixels.column[start]
    side = np.floor(_SURE * near.sure_reach[stack.seen(row, column)]).astype(np.int64)
    # Numbers of glare pixels above and to the left, in the bounding box of the mask
    (top, bottom), (left, right) = (
        (part.min(), part.max() + 1) for part in (pixels.row, pixels.column)
    )
    box = stack.mask[top:bottom, left:right]
    total = np.zeros((box.shape[0] + 1, box.shape[1] + 1), dtype=np.int32)
    np.cumsum(box, axis=0, out=total[1:, 1:])
    np.cumsum(total[1:, 1:], axis=1, out=total[1:, 1:])
    row, column, last = row - top, column - left, len(box)

    def count(top: np.ndarray, bottom: np.ndarray, right: np.ndarray) -> np.ndarray:
        # Number of glare pixels in rows top…bottom − 1 and columns left…right − 1
        strip = total[bottom, right] - total[top, right]
        return np.asarray(strip - total[bottom, left] + total[top, left])

    left = np.maximum(column - side, 0)
    above = count(np.maximum(row - side, 0), row, column)
    under = count(row + 1, np.minimum(row + 1 + side, last), column + 1)
    return np.asarray((side < 1) | ((above == 0) & (under == 0)))


def _births(
    several: np.ndarray,
    start: np.ndarray,
    run: np.ndarray,
    pixels: ScannedPixels,
    stack: MaskStack,
    near: Neighbourhood,
) -> np.ndarray:
    # For each of several runs, index of the first run of its source
    number = np.zeros(stack.mask.shape, dtype=np.int32)
    number[pixels.row, pixels.column] = run
    first = start[several]
    row, column = previous_pixels(pixels.row[first], pixels.column[first], stack, near)
    joined = np.arange(start.size)
    joined[several] = np.where(row < 0, several, number[row, column])
    # Follow the runs that each run joins to the run that begins the source
    while True:
        further = joined[joined]
        if np.array_equal(further, joined):
            return np.asarray(joined[several])
        joined = further
