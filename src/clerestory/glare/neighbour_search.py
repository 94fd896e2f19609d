"""Search for a glare source around a pixel, in the order of evalglare.

The search order affects the number of sources. Rows are searched downwards from the
central pixel, then upwards; each row to the left and then to the right from the middle
of the interval searched in the previous row, up to the first pixel beyond the search
angle. A few pixels below and above the central pixel are never visited.
"""

import threading
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int

from clerestory.array_types import Indices, Mask
from clerestory.glare.glare_view import GlareView

# Memory for the spans of the pixels of a view [bytes]
_KEPT = 1 << 26

_Labels = Int[np.ndarray, "row column"]


class Window(NamedTuple):
    """Rectangular window around a central pixel; `top` and `left` are its first pixel.

    `near` tells whether a pixel is within the search angle of the central pixel,
    `blind` tells whether rounding excludes the row of the central pixel.
    """

    top: int
    left: int
    near: Bool[np.ndarray, "height width"]
    blind: bool


class Spans(NamedTuple):
    """Pixels within the search angle of central pixels, by row of the window.

    Rows are numbered from `reach` rows above the central pixel. `begin` is the column
    of the first pixel within the search angle, `length` their number.
    """

    begin: Int[np.ndarray, "pixel row"]
    length: Int[np.ndarray, "pixel row"]


class Neighbourhood:
    """Pixels within a search angle [rad] of a pixel.

    `chord` is the distance of unit vectors that span the search angle. Pixels within
    the angle are at most `reach` rows or columns apart; pixels up to `sure_reach`
    pixels apart are always within the angle.
    """

    def __init__(self, eye: GlareView, angle: float) -> None:
        self.direction = eye.direction
        self.angle = angle
        self.chord = 2 * np.sin(angle / 2)
        self._cosine = np.cos(angle)
        self.reach = eye.farthest_within(angle)
        self.sure_reach = eye.surely_within(angle)
        # Spans that are kept, how many are in use, and the number of each pixel
        self._spans = np.zeros((2, 0, 2 * self.reach + 1), dtype=np.int32)
        self._used = 0
        self._number = np.full(eye.shape, -1, dtype=np.int32)
        self._lock = threading.Lock()

    def window(self, row: int, column: int) -> Window:
        """Return the window around a pixel."""
        near, top, left = self._near(row, column)
        blind = self.blind(np.array([row]), np.array([column]))[0]
        return Window(top, left, near, bool(blind))

    def _near(self, row: int, column: int) -> tuple[np.ndarray, int, int]:
        # Whether pixels of the window around a pixel are within the search angle, and
        # the first row and column of the window
        rows, columns, _ = self.direction.shape
        top, left = max(row - self.reach, 0), max(column - self.reach, 0)
        bottom = min(row + self.reach + 1, rows)
        right = min(column + self.reach + 1, columns)
        here = self.direction[row, column]
        near = self.direction[top:bottom, left:right] @ here >= self._cosine
        return near, top, left

    def spans(self, row: Indices, column: Indices) -> Spans:
        """Return the spans of the windows around pixels; they are kept."""
        with self._lock:
            new = np.flatnonzero(self._number[row, column] < 0)
            if new.size and self._full(new.size):
                self._used = 0
                self._number[:] = -1
                new = np.arange(row.size)
            if new.size:
                self._keep(np.unique(np.stack([row[new], column[new]]), axis=1))
            begin, count = self._spans[:, self._number[row, column]]
        return Spans(begin, count)

    def _full(self, more: int) -> bool:
        # Whether there is no memory for the spans of further pixels
        return 8 * (2 * self.reach + 1) * (self._used + more) > _KEPT

    def _keep(self, pixels: Int[np.ndarray, "2 pixel"]) -> None:
        # Add the spans of pixels to those that are kept
        first, held = self._used, self._spans.shape[1]
        self._used += pixels.shape[1]
        if self._used > held:
            more = np.zeros((2, max(held, self._used - held), 2 * self.reach + 1), "i4")
            self._spans = np.concatenate([self._spans, more], axis=1)
        self._number[*pixels] = np.arange(first, self._used)
        self._spans[:, first : self._used] = 0
        for number, (row, column) in enumerate(pixels.T.tolist(), start=first):
            near, top, left = self._near(row, column)
            above = top - row + self.reach
            rows = slice(above, above + len(near))
            self._spans[0, number, rows] = near.argmax(axis=1) + left
            self._spans[1, number, rows] = np.count_nonzero(near, axis=1)

    def blind(self, row: Indices, column: Indices) -> Mask:
        """Whether rounding makes the squared length of a direction exceed one.

        In evalglare, the angle is then NaN and the row of the pixel is not searched.
        """
        x, y, z = np.moveaxis(self.direction[row, column], -1, 0)
        return np.asarray(x * x + y * y + z * z > 1)


@lru_cache(maxsize=8)
def neighbourhood(eye: GlareView, angle: float) -> Neighbourhood:
    """Return the pixels within a search angle [rad]; recent results are cached."""
    return Neighbourhood(eye, angle)


def first_found(
    labels: _Labels,
    wanted: Bool[np.ndarray, " labels"],
    window: Window,
    row: int,
    column: int,
    *,
    upwards: bool,
    last_column: int,
) -> int:
    """Return the first wanted source label above or below a pixel; 0 if none.

    Pixels outside of sources have the label 0. The search is `upwards` from the row
    above the central pixel, or downwards from the central row, up to `last_column`.
    """
    top, left, near, blind = window
    height, width = near.shape
    found = wanted[labels[top : top + height, left : left + width]] & near
    hits = found.any(axis=1).tolist()
    if not any(hits):
        return 0
    counts = near.sum(axis=1).tolist()
    begins = (near.argmax(axis=1) + left).tolist()
    west = east = column
    steps: Iterable[int] = (
        range(row - 1 - top, -1, -1) if upwards else range(row - top, height)
    )
    for step in steps:
        if blind and step == row - top:
            west, east = column + 1, column - 1
            continue
        if not counts[step]:
            break
        begin, end = begins[step], begins[step] + counts[step] - 1

        # Search to the left from the middle of the previous row
        start = (west + east) // 2
        if begin <= start <= end:
            if hits[step]:
                at = np.flatnonzero(found[step, : start - left + 1])
                if at.size:
                    return int(labels[top + step, left + at[-1]])
            west = begin if begin > 0 else west
        else:
            west = start + 1

        # Search to the right from the middle of the interval with the new left end
        start = (west + east) // 2
        if start > last_column:
            continue
        if begin <= start <= end:
            if hits[step]:
                at = np.flatnonzero(found[step, start - left : last_column - left + 1])
                if at.size:
                    return int(labels[top + step, start + at[0]])
            east = end if end < last_column else east
        else:
            east = start - 1
    return 0
