"""Heat maps of classes over the days and hours of a year.

Examples are glare categories, window states and dimming levels of luminaires. The page
shows the class of the cell under the mouse pointer.
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
    """Class of every time step, with labels and colours of the classes.

    Attributes
    ----------
    identifier : HTML identifier of the drawing
    label : description of the map
    codes : class of each time step, -1 for none; if several steps share a cell, such as
        steps of different years, the highest class is shown
    texts : label of each class
    colours : red, green and blue of each class
    """

    identifier: str
    label: str
    codes: Int[np.ndarray, " time"]
    texts: tuple[str, ...]
    colours: UInt8[np.ndarray, "kind 3"]

    def __post_init__(self) -> None:
        known = min(len(self.texts), len(self.colours), _NO_DATA)
        highest = int(self.codes.max(initial=-1))
        require(highest < known, f"class {highest} in a map; 0 to {known - 1} expected")

    def cells(self, grid: DayHourGrid) -> UInt8[np.ndarray, " cell"]:
        """Class of each cell, in the order of days; 255 without data."""
        found = np.full(grid.days * grid.bins, -1)
        np.maximum.at(found, grid.cell, self.codes)
        return np.where(found < 0, _NO_DATA, found).astype(np.uint8)

    def image(self, grid: DayHourGrid) -> str:
        """Return the coloured cells as a data URL."""
        cells = self.cells(grid).reshape(grid.days, grid.bins).T[::-1]
        known = cells != _NO_DATA
        return png(self.colours[np.where(known, cells, 0)], known)

    def drawing(
        self, grid: DayHourGrid, *, occupied: Bool[np.ndarray, " time"]
    ) -> Markup:
        """Return the drawing of a map, with occupied hours as dashed lines."""
        shown = heat_map(
            grid,
            image=self.image(grid),
            occupied=occupied,
            label=self.label,
            identifier=self.identifier,
        )
        return element("div", shown, class_="year-scroll class-map")

    def data(self, grid: DayHourGrid) -> dict[str, Any]:
        """Return classes and labels as JSON values."""
        return {"cells": packed(self.cells(grid)), "texts": list(self.texts)}


def keys(
    texts: Sequence[str], colours: UInt8[np.ndarray, "kind 3"]
) -> list[tuple[str, str]]:
    """Return the colour `#rrggbb` and the label of each class."""
    return list(zip(hexadecimal(colours), texts, strict=True))
