"""Search for a glare source around a pixel, in the order of evalglare.

The source found, and hence the number of sources, depends on the search order: row by
row downwards from the central pixel, then upwards; in each row to the left and then to
the right of the middle of the previous row, up to the first pixel beyond the angle. A
few pixels below and above the central pixel are never visited.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int

from clerestory.glare.glare_view import GlareView

_Labels = Int[np.ndarray, "row column"]


class Window(NamedTuple):
    """Pixels near one pixel.

    Attributes
    ----------
    top, left : picture row and column of the window's first pixel
    near : whether a pixel is within the angle
    blind : whether rounding excludes the row of the central pixel
    """

    top: int
    left: int
    near: Bool[np.ndarray, "height width"]
    blind: bool


class Neighbourhood:
    """Pixels within an angle of a pixel.

    Attributes
    ----------
    direction : unit vectors of all pixels
    angle : largest angle [rad]
    chord : distance of unit vectors at this angle
    reach : search radius: upper limit of the rows or columns between two pixels within
        the angle
    sure_reach : for each pixel, distance in pixels that is within the angle in any
        direction
    """

    def __init__(self, eye: GlareView, angle: float) -> None:
        self.direction = eye.direction
        self.angle = angle
        self.chord = 2 * np.sin(angle / 2)
        self._cosine = np.cos(angle)
        self.reach = eye.farthest_within(angle)
        self.sure_reach = eye.surely_within(angle)

    def window(self, row: int, column: int) -> Window:
        """Return the pixels around one pixel, and whether they are within the angle."""
        rows, columns, _ = self.direction.shape
        top, left = max(row - self.reach, 0), max(column - self.reach, 0)
        bottom = min(row + self.reach + 1, rows)
        right = min(column + self.reach + 1, columns)
        here = self.direction[row, column]
        near = self.direction[top:bottom, left:right] @ here >= self._cosine
        return Window(
            top, left, near, bool(self.blind(np.array([row]), np.array([column]))[0])
        )

    def blind(
        self, row: Int[np.ndarray, "*shape"], column: Int[np.ndarray, "*shape"]
    ) -> Bool[np.ndarray, "*shape"]:
        """Whether a direction's product with itself exceeds one by rounding.

        The angle is then NaN in evalglare, which does not search the row of the pixel.
        """
        x, y, z = np.moveaxis(self.direction[row, column], -1, 0)
        over: np.ndarray = x * x + y * y + z * z > 1
        return over


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
    """Return the first wanted label in one half of the search; 0 if there is none.

    Parameters
    ----------
    labels : label of each pixel of the picture, 0 for none
    wanted : for each label, whether it ends the search
    row, column : central pixel
    upwards : search the rows above the central pixel; otherwise its row and the rows
        below
    last_column : limit of the search
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

        # Search to the left, from the middle of the previous row
        start = (west + east) // 2
        if begin <= start <= end:
            if hits[step]:
                at = np.flatnonzero(found[step, : start - left + 1])
                if at.size:
                    return int(labels[top + step, left + at[-1]])
            west = begin if begin > 0 else west
        else:
            west = start + 1

        # Search to the right, from the middle updated with the new left end
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
