"""Search of the first scan of glare source detection, for many pixels at once.

In the first scan every glare pixel that was scanned before belongs to a source. The
pixel that the search finds therefore depends on the mask of glare pixels only, and the
searches around all pixels can advance together, row by row. The order of the search is
that of `neighbour_search`.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from clerestory.array_types import ImageMask, Indices
from clerestory.glare.mask_stack import MaskStack
from clerestory.glare.neighbour_search import Neighbourhood, Spans


@dataclass(frozen=True, eq=False)
class NearestGlare:
    """Nearest glare pixels to the left and to the right of each pixel of a mask.

    Columns are those of the view, of which the mask begins with the column `first`.
    Without such a neighbour they are −1 or beyond the last column of the mask.
    """

    left: Int[np.ndarray, "row column"]
    right: Int[np.ndarray, "row column"]
    first: int

    @classmethod
    def of(cls, mask: ImageMask, first: int = 0) -> "NearestGlare":
        """Return the nearest glare pixels of a mask.

        >>> near = NearestGlare.of(np.array([[False, True, False]]))
        >>> near.left.tolist(), near.right.tolist()
        ([[-1, 1, 1]], [[1, 1, 3]])
        """
        end = first + mask.shape[1]
        column = np.arange(first, end, dtype=np.int32)
        before = np.where(mask, column, np.int32(-1))
        after = np.where(mask, column, np.int32(end))[:, ::-1]
        return cls(
            np.maximum.accumulate(before, axis=1),
            np.minimum.accumulate(after, axis=1)[:, ::-1],
            first,
        )

    def at(self, column: Indices) -> Indices:
        """Return the index of the mask's column for a column of the view."""
        return np.asarray(np.clip(column - self.first, 0, self.left.shape[1] - 1))


def previous_pixels(
    row: Indices,
    column: Indices,
    stack: MaskStack,
    near: Neighbourhood,
) -> tuple[Indices, Indices]:
    """Return row and column of the scanned pixel that each search finds; −1 if none.

    The searches are around glare pixels. Scanned are the pixels to the left of a pixel
    and those below it. The search visits the pixel to the upper left first, then rows
    above, then rows below. Rows and columns are those of the stack of masks.
    """
    mask, seen = stack.mask, stack.seen(row, column)
    found = np.full((2, row.size), -1, dtype=np.int64)
    corner = (row > 0) & (column > 0) & (near.sure_reach[seen] >= 2)
    corner &= mask[row - 1, column - 1]
    found[:, corner] = row[corner] - 1, column[corner] - 1
    rest = np.flatnonzero(~corner)
    if not rest.size:
        return found[0], found[1]

    used = np.flatnonzero(mask.any(axis=1))
    top, bottom = int(used[0]), int(used[-1]) + 1
    glare = NearestGlare.of(mask[top:bottom], stack.left)
    around = seen[0][rest], seen[1][rest]
    spans, blind = near.spans(*around), near.blind(*around)
    reach = near.reach
    for offsets in (range(-1, -reach - 1, -1), range(reach + 1)):
        some = np.flatnonzero(found[0, rest] < 0)
        search = _Search(
            row[rest[some]] - top, around[1][some], blind[some], glare,
            Spans(spans.begin[some], spans.length[some]),
        )  # fmt: skip
        place = search.through(offsets, reach)
        hit = place[0] >= 0
        found[:, rest[some[hit]]] = place[:, hit] + np.array([[top], [-stack.left]])
    return found[0], found[1]


@dataclass(frozen=True, eq=False)
class _Search:
    # Searches upwards or downwards around pixels; rows are those of `glare`
    row: Indices
    column: Indices
    blind: np.ndarray
    glare: NearestGlare
    spans: Spans

    def through(
        self, offsets: Iterable[int], reach: int
    ) -> Int[np.ndarray, "2 search"]:
        """Return row and column of the first pixel found; −1 if none."""
        found = np.full((2, self.row.size), -1, dtype=np.int64)
        which = np.arange(self.row.size)
        west, east = self.column.copy(), self.column.copy()
        for offset in offsets:
            if not which.size:
                break
            begin, count = (part[which, reach + offset] for part in self.spans)
            skipped = self.blind[which] & (offset == 0)
            hit, west, east = self._row(which, offset, begin, count, west, east)
            middle = self.column[which]
            west = np.where(skipped, middle + 1, west)
            east = np.where(skipped, middle - 1, east)
            met = (hit >= 0) & ~skipped
            found[0, which[met]] = self.row[which[met]] + offset
            found[1, which[met]] = hit[met]
            # A search ends in a row without pixels within the search angle
            more = ~met & (skipped | (count > 0))
            which, west, east = which[more], west[more], east[more]
        return found

    def _row(
        self,
        which: Indices,
        offset: int,
        begin: Indices,
        count: Indices,
        west: Indices,
        east: Indices,
    ) -> tuple[Indices, Indices, Indices]:
        # Column of the pixel found in a row, −1 if none, and limits for the next row
        rows = len(self.glare.left)
        line, column = self.row[which] + offset, self.column[which]
        last = column if offset > 0 else column - 1  # last that was scanned
        end = begin + count - 1
        outside = (line < 0) | (line >= rows)
        line = np.clip(line, 0, rows - 1)

        # Search to the left from the middle of the previous row
        start = (west + east) // 2
        inside = (begin <= start) & (start <= end)
        hit = self.glare.left[line, self.glare.at(np.minimum(start, last))]
        met = inside & (hit >= begin) & (hit <= last) & ~outside
        found = np.where(met, hit, -1)
        west = np.where(inside, np.where(begin > 0, begin, west), start + 1)

        # Search to the right from the middle of the interval with the new left end
        start = (west + east) // 2
        within = start <= column
        inside = (begin <= start) & (start <= end)
        hit = self.glare.right[line, self.glare.at(start)]
        met = ~met & within & inside & (hit <= np.minimum(last, end)) & ~outside
        found = np.where(met, hit, found)
        further = np.where(inside, np.where(end < column, end, east), start - 1)
        return found, west, np.where(within, further, east)
