"""Annual heat maps of classes, such as glare categories or window states.

The page shows the class of the cell under the mouse pointer.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Int, UInt8

from clerestory.checks import require
from clerestory.report.colour import hexadecimal
from clerestory.report.embedded_data import packed, png
from clerestory.report.heat_map import DayHourGrid, heat_map
from clerestory.report.markup import Markup, element

_NO_DATA = 255


@dataclass(frozen=True, eq=False)
class DayMap:
    """Annual map of a class (such as glare category) per time step, with class colours.

    Attributes
    ----------
    identifier : HTML identifier of the drawing
    label : description of the map
    codes : class index of each time step, -1 for none; a cell that contains several
        time steps, such as those of several years, shows their highest class
    texts : label of each class
    colours : sRGB colour of each class
    """

    identifier: str
    label: str
    codes: Int[np.ndarray, " time"]
    texts: tuple[str, ...]
    colours: UInt8[np.ndarray, "kind 3"]

    def __post_init__(self) -> None:
        last = min(len(self.texts), len(self.colours), _NO_DATA) - 1
        found = int(self.codes.max(initial=-1))
        require(found <= last, f"a time step has class {found}; 0 to {last} expected")

    def cells(self, grid: DayHourGrid) -> UInt8[np.ndarray, " cell"]:
        """Class index of each cell, day by day; 255 for cells without data."""
        found = np.full(grid.days * grid.bins, -1)
        np.maximum.at(found, grid.cell, self.codes)
        return np.where(found < 0, _NO_DATA, found).astype(np.uint8)

    def image(self, grid: DayHourGrid) -> str:
        """Return the coloured cells as the data URL of a PNG image."""
        cells = self.cells(grid).reshape(grid.days, grid.bins).T[::-1]
        known = cells != _NO_DATA
        return png(self.colours[np.where(known, cells, 0)], known)

    def drawing(
        self, grid: DayHourGrid, *, occupied: Bool[np.ndarray, " time"]
    ) -> Markup:
        """Return the map with axes; dashed lines bound the occupied hours."""
        shown = heat_map(
            grid,
            image=self.image(grid),
            occupied=occupied,
            label=self.label,
            identifier=self.identifier,
        )
        return element("div", shown, class_="year-scroll class-map")

    def data(self, grid: DayHourGrid) -> dict[str, Any]:
        """Return the class of each cell, and the class labels, as JSON values."""
        return {"cells": packed(self.cells(grid)), "texts": list(self.texts)}


def keys(
    texts: Sequence[str], colours: UInt8[np.ndarray, "kind 3"]
) -> list[tuple[str, str]]:
    """Return the legend of a map: colour `#rrggbb` and label of each class."""
    return list(zip(hexadecimal(colours), texts, strict=True))
