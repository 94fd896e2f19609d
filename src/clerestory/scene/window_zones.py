"""Zones of windows and exit directions, by which paths to windows are recorded.

The zones are rectangles of a grid on each window, numbered window by window. An exit
direction is recorded by its cell in a grid over the square of the Shirley–Chiu map: row
and column have 16 bits each, so that any partition of directions can be applied later.

Reference: P. Shirley, K. Chiu, Journal of Graphics Tools 2 (3), 1997.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import require
from clerestory.constants import R2
from clerestory.scene.surface import Polygon
from clerestory.scene.triangulate import triangulate
from clerestory.scene.window import Window

# Number of bits of the row and of the column of an exit direction
DIRECTION_BITS = 16

# Bit of a zone number that marks a window which is seen directly, and largest number of
# zones of all windows together
STRAIGHT = 1 << 15
_ZONES = STRAIGHT

# Tolerance of lengths and areas of a rectangle, relative to its size
_FLAT = 1e-6

# Usual number of zones of a window
_USUAL = 1024


@dataclass(frozen=True, eq=False)
class WindowZones:
    """Grids of zones on the windows of a scene.

    Attributes
    ----------
    corner, across, upwards : corner and edges of the rectangle around each window [m]
    counts : numbers of zones along both edges
    """

    corner: Float[np.ndarray, "window 3"]
    across: Float[np.ndarray, "window 3"]
    upwards: Float[np.ndarray, "window 3"]
    counts: Int[np.ndarray, "window 2"]

    @classmethod
    def of(cls, windows: Sequence[Window], *, each: int = _USUAL) -> "WindowZones":
        """Return about `each` zones for every window."""
        most = _ZONES // max(1, len(windows))
        require(most, f"{len(windows):,} windows; at most {_ZONES:,} expected")
        grids = [_grid(window, min(each, most)) for window in windows]
        return cls(*(np.array(part) for part in zip(*grids, strict=True)))

    @property
    def first(self) -> Int[np.ndarray, " window"]:
        """Index of the first zone of each window."""
        sizes = self.counts.prod(axis=1)
        return np.asarray(np.cumsum(sizes) - sizes)

    def of_window(self, window: int) -> slice:
        """Return the indices of the zones of a window."""
        first = int(self.first[window])
        return slice(first, first + int(self.counts[window].prod()))

    def points(
        self, window: int, polygons: Sequence[Polygon], each: int
    ) -> Float[np.ndarray, "zone point 3"]:
        """Return sample points in each zone of a window.

        They are repeated in zones with less than `each` points; a zone without any has
        those of the next.
        """
        size = self.counts[window].prod()
        found = spread_points(polygons, 4 * each * int(size))
        place = found - self.corner[window]
        steps = []
        for edge, count in zip(
            (self.across[window], self.upwards[window]),
            self.counts[window],
            strict=True,
        ):
            share = place @ edge / (edge @ edge)
            steps.append(np.clip((share * count).astype(int), 0, count - 1))
        zone = steps[1] * self.counts[window, 0] + steps[0]
        order = np.argsort(zone, kind="stable")
        begin, end = (
            np.searchsorted(zone[order], np.arange(size), s) for s in ("left", "right")
        )
        begin = np.minimum(begin, len(order) - 1)
        number = begin[:, None] + np.arange(each) % np.maximum(end - begin, 1)[:, None]
        return np.asarray(found[order[number]])


def fills_rectangle(number: int, windows: Sequence[Window]) -> bool:
    """Whether one of the windows fills a rectangle, and no other is in front of it."""
    window = windows[number]
    corner, x, y, _ = _grid(window, 1)
    size = float(np.linalg.norm(np.cross(x, y)))
    near = _FLAT * math.sqrt(size)
    heights = [
        np.concatenate([(p.vertices - corner) @ window.frame.normal for p in part])
        for part in (window.polygons, [p for w in windows for p in w.polygons])
    ]
    flat, behind = abs(heights[0]).max() < near, heights[1].max() < near
    return bool(flat and behind and abs(window.area - size) < _FLAT * size)


def _grid(
    window: Window, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[int, int]]:
    # Corner, edges and numbers of zones of the rectangle around the polygons
    frame = window.frame
    points = np.concatenate([polygon.vertices for polygon in window.polygons])
    axes = np.array([frame.right, frame.up, frame.normal])
    local = points @ axes.T
    low, size = local.min(axis=0), np.ptp(local, axis=0)
    edge = float(np.sqrt(size[0] * size[1] / most))
    counts = [max(1, int(length // edge)) for length in size[:2]]
    while counts[0] * counts[1] > most:
        counts[int(counts[1] > counts[0])] -= 1
    x, y = size[0] * frame.right, size[1] * frame.up
    return low @ axes, x, y, (counts[0], counts[1])


def spread_points(
    polygons: Sequence[Polygon], count: int
) -> Float[np.ndarray, "point 3"]:
    """Return points evenly distributed over polygons, by the R2 sequence."""
    corners = np.concatenate(
        [(t := triangulate(p.vertices)).vertices[t.faces] for p in polygons]
    )
    a, b, c = corners.transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    ends = np.cumsum(areas) / areas.sum()
    face = np.minimum(
        np.searchsorted(ends, (np.arange(count) + 0.5) / count), len(a) - 1
    )
    u, v = ((np.arange(count)[:, None] * R2 + 0.5) % 1).T
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    return np.asarray(a[face] + u[:, None] * (b - a)[face] + v[:, None] * (c - a)[face])
