"""First scan of glare source detection: grouping of glare pixels.

The picture is scanned column by column from the left, each column from the bottom up.
Consecutive glare pixels in a column (a run) belong to one source. If a previously
scanned pixel within half the merging angle of the first pixel of the run belongs to a
source, the run is added to that source; otherwise it begins a new source.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Int
from scipy import ndimage

from clerestory.array_types import ImageMask
from clerestory.glare.neighbour_search import Neighbourhood, first_found

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
    pixels: ScannedPixels, mask: ImageMask, near: Neighbourhood, *, single: bool
) -> Int[np.ndarray, " pixel"]:
    """Return the source label of each pixel after the first scan, from 1.

    With `single`, every pixel is a run of its own.
    """
    row, column, island = pixels
    begins = np.ones(row.size, dtype=bool)
    if not single:
        begins[1:] = (np.diff(column) != 0) | (np.diff(row) != -1)
    run = np.cumsum(begins) - 1
    start = np.flatnonzero(begins)
    alone = _may_be_first(row[start], column[start], mask, near)

    # An island in which at most one run can begin a source is one source
    labels = np.zeros(mask.shape, dtype=np.int64)
    tips = np.bincount(island[start], weights=alone, minlength=island.max() + 1)
    birth = np.zeros(start.size, dtype=np.int64)  # first run of the source of each run
    for here in np.flatnonzero(tips > 1):
        members = np.flatnonzero(island[start] == here)
        birth[members] = _scan_runs(
            members, start, begins, pixels, near, labels, alone[members]
        )
    first_run = np.full(tips.size, start.size)
    np.minimum.at(first_run, island[start], np.arange(start.size))
    simple = tips[island[start]] <= 1
    birth[simple] = first_run[island[start][simple]]

    _, number = np.unique(birth, return_inverse=True)
    return np.asarray(number[run] + 1)


def _may_be_first(
    row: np.ndarray, column: np.ndarray, mask: np.ndarray, near: Neighbourhood
) -> np.ndarray:
    # Whether a run may begin a source: no previous glare pixel is in the region that is
    # always searched, a rectangle to the upper left and the column below
    side = np.floor(_SURE * near.sure_reach[row, column]).astype(np.int64)
    total = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1), dtype=np.int32)
    np.cumsum(mask, axis=0, out=total[1:, 1:])
    np.cumsum(total[1:, 1:], axis=1, out=total[1:, 1:])
    last = mask.shape[0]

    def count(top: np.ndarray, bottom: np.ndarray, right: np.ndarray) -> np.ndarray:
        # Number of glare pixels in rows top…bottom − 1 and columns left…right − 1
        strip = total[bottom, right] - total[top, right]
        return np.asarray(strip - total[bottom, left] + total[top, left])

    left = np.maximum(column - side, 0)
    above = count(np.maximum(row - side, 0), row, column)
    under = count(row + 1, np.minimum(row + 1 + side, last), column + 1)
    return np.asarray((side < 1) | ((above == 0) & (under == 0)))


def _scan_runs(
    members: np.ndarray,
    start: np.ndarray,
    begins: np.ndarray,
    pixels: ScannedPixels,
    near: Neighbourhood,
    labels: np.ndarray,
    alone: np.ndarray,
) -> np.ndarray:
    # For each run, index of the first run of its source, by the search of evalglare
    only = 0  # the only label in use, or −1 if several are in use
    ends = np.append(np.flatnonzero(begins)[1:], begins.size)
    birth = np.zeros(members.size, dtype=np.int64)
    wanted = np.ones(start.size + 2, dtype=bool)
    wanted[0] = False
    for place, run in enumerate(members):
        row, column = int(pixels.row[start[run]]), int(pixels.column[start[run]])
        label = only
        if only <= 0 or alone[place]:
            label = _find(labels, wanted, row, column, near, alone=alone[place])
        if not label:
            label = int(run) + 1
            only = -1 if only else label
        birth[place] = label - 1
        labels[row + 1 - (ends[run] - start[run]) : row + 1, column] = label
    return birth


def _find(
    labels: np.ndarray,
    wanted: np.ndarray,
    row: int,
    column: int,
    near: Neighbourhood,
    *,
    alone: bool,
) -> int:
    # The search visits the upper left pixel first, then rows above, then rows below
    if row > 0 and column > 0 and near.sure_reach[row, column] >= 2:
        label = int(labels[row - 1, column - 1])
        if label:
            return label
    # If all labels in the window are equal, the search returns this label
    if not alone:
        top, left = max(row - near.reach, 0), max(column - near.reach, 0)
        around = labels[top : row + near.reach + 1, left : column + 1]
        label = int(around.max())
        if ((around == 0) | (around == label)).all():
            return label
    window = near.window(row, column)
    above, below = (
        first_found(labels, wanted, window, row, column, upwards=up, last_column=column)
        for up in (True, False)
    )
    return above or below
