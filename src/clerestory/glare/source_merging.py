"""Second scan of glare source detection: merging of sources.

Pixels are visited in the order of the first scan. If a source of larger solid angle is
within half the merging angle of a pixel, the source of the pixel is merged into the
larger source. Scans are repeated until no sources are merged; sources of equal solid
angle are not merged.
"""

import importlib
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from clerestory.array_types import Image
from clerestory.glare.neighbour_search import Neighbourhood, first_found
from clerestory.glare.pixel_scan import ScannedPixels

_EIGHT = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]

# Distance from the picture edge within which pixels count as outer pixels [pixels]
_EDGE = 2


def merge_sources(
    pixels: ScannedPixels,
    labels: Int[np.ndarray, " pixel"],
    solid_angle: Image,
    near: Neighbourhood,
    *,
    skip_inner: bool,
) -> Int[np.ndarray, " pixel"]:
    """Return the source label of each pixel after merging.

    An island is in one picture; labels of islands in different pictures may be equal.
    With `skip_inner`, pixels surrounded by pixels of the same source are skipped.
    """
    merged = labels.copy()
    picture = np.zeros(solid_angle.shape, dtype=np.int64)
    # Process only islands with several sources
    lowest = np.full(pixels.island.max(initial=-1) + 1, labels.max(initial=0) + 1)
    highest = np.zeros(lowest.size, dtype=np.int64)
    np.minimum.at(lowest, pixels.island, labels)
    np.maximum.at(highest, pixels.island, labels)
    for island in np.flatnonzero(lowest != highest):
        index = np.flatnonzero(pixels.island == island)
        some = ScannedPixels(*(part[index] for part in pixels))
        picture[some.row, some.column] = labels[index]
        state = _Merging(some, labels[index], picture, solid_angle, near, skip_inner)
        while state.scan():
            pass
        merged[index] = picture[some.row, some.column]
        # The next island may be in another picture
        picture[some.row, some.column] = 0
    return merged


@dataclass
class _Merging:
    # Labels and solid angles of the sources of one island during merging
    pixels: ScannedPixels
    labels: np.ndarray
    picture: np.ndarray
    solid_angle: np.ndarray
    near: Neighbourhood
    skip_inner: bool

    def __post_init__(self) -> None:
        row, column, _ = self.pixels
        self.omega = self.solid_angle[row, column]
        # Sum in the order of the scan, since solid angles are compared exactly
        self.size = np.bincount(self.labels, weights=self.omega)
        self.pixel, self.neighbour = self._meetings()
        # Current label of each source, by initial label
        self.current = np.arange(self.size.size)

    def _meetings(self) -> tuple[np.ndarray, np.ndarray]:
        # Outer pixels, each with the label of another source within the search angle
        outer = np.flatnonzero(self._are_outer())
        row, column = self.pixels.row[outer], self.pixels.column[outer]
        direction, reach = self.near.direction[row, column], self.near.reach
        # Imported here, since scipy.spatial loads slowly
        tree = importlib.import_module("scipy.spatial").cKDTree
        found = []
        for label in np.unique(self.labels):
            mine = self.labels[outer] == label
            # Restrict the search to the bounding box of the source
            about = ~mine
            for place in (row, column):
                least, most = place[mine].min(), place[mine].max()
                about &= (place >= least - reach) & (place <= most + reach)
            distance, _ = tree(direction[mine]).query(
                direction[about], distance_upper_bound=self.near.chord
            )
            pixel = outer[about][np.isfinite(distance)]
            found.append((pixel, np.full(pixel.size, label)))
        pixel, neighbour = (np.concatenate(part) for part in zip(*found, strict=True))
        return pixel, neighbour

    def _are_outer(self) -> np.ndarray:
        # Whether pixels adjoin a pixel of another label, or the edge of the picture
        row, column, _ = self.pixels
        rows, columns = self.picture.shape
        (top, left), (bottom, right) = (
            (pick(row), pick(column)) for pick in (np.min, np.max)
        )
        # Beyond the bounding box, there are no pixels of the island
        box = np.pad(self.picture[top : bottom + 1, left : right + 1], 1)
        height, width = box.shape[0] - 2, box.shape[1] - 2
        own = box[1:-1, 1:-1]
        beside = np.zeros(own.shape, dtype=bool)
        for i, j in _EIGHT:
            beside |= box[1 + i : 1 + i + height, 1 + j : 1 + j + width] != own
        outer: np.ndarray = (np.minimum(row, column) < _EDGE) | (row >= rows - _EDGE)
        outer |= (column >= columns - _EDGE) | beside[row - top, column - left]
        return outer

    def _is_outer(self, index: int) -> bool:
        # The same for one pixel
        row, column = int(self.pixels.row[index]), int(self.pixels.column[index])
        rows, columns = self.picture.shape
        inside = _EDGE <= row < rows - _EDGE and _EDGE <= column < columns - _EDGE
        around = self.picture[row - 1 : row + 2, column - 1 : column + 2]
        return not inside or bool((around != self.picture[row, column]).any())

    def scan(self) -> bool:
        """Merge sources in the order of the scan; return whether any was merged."""
        changed, last = False, -1
        while True:
            own = self.current[self.labels[self.pixel]]
            other = self.current[self.neighbour]
            meets = (self.size[other] > self.size[own]) & (self.pixel > last)
            candidates = self.pixel[meets]
            if not candidates.size:
                return changed
            last = int(candidates.min())
            if self.skip_inner and not self._is_outer(last):
                continue
            changed |= self._search(last)

    def _search(self, index: int) -> bool:
        # Merge the source of a pixel into a larger source near the pixel
        row, column = int(self.pixels.row[index]), int(self.pixels.column[index])
        old = new = int(self.picture[row, column])
        window = self.near.window(row, column)
        for upwards in (False, True):
            label = first_found(
                self.picture,
                self.size > self.size[new],
                window,
                row,
                column,
                upwards=upwards,
                last_column=self.picture.shape[1] - 1,
            )
            new = label or new
        if new == old:
            return False
        mine = self.picture[self.pixels.row, self.pixels.column] == old
        self.picture[self.pixels.row[mine], self.pixels.column[mine]] = new
        self.size[new] = np.add.accumulate([self.size[new], *self.omega[mine]])[-1]
        self.size[old] = 0
        self.current[self.current == old] = new
        return True
