"""Heat maps of classes over the days and hours of a year.

Examples are glare categories, window states and dimming levels of luminaires. The page
shows the class of the cell under the mouse pointer.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Int, UInt8

from clerestory.errors import InputError
from clerestory.report.embedded_data import packed, png
from clerestory.report.heat_map import DayHourGrid, day_hour_grid, heat_map
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
        if highest >= known:
            raise InputError(f"class {highest} in a map; 0 to {known - 1} expected")

    def cells(self, grid: DayHourGrid) -> UInt8[np.ndarray, " cell"]:
        """Class of each cell, in the order of days; 255 without data."""
        found = np.full(grid.days * grid.bins, -1)
        np.maximum.at(found, grid.cell, self.codes)
        return np.where(found < 0, _NO_DATA, found).astype(np.uint8)

    def image(self, grid: DayHourGrid) -> str:
        """Return the coloured cells as a data URL."""
        cells = self.cells(grid).reshape(grid.days, grid.bins).T[::-1]
        rgba = np.zeros((*cells.shape, 4), dtype=np.uint8)
        known = cells != _NO_DATA
        rgba[known, :3] = self.colours[cells[known]]
        rgba[known, 3] = 255
        return png(rgba)


def day_map(
    shown: DayMap, times: np.ndarray, *, occupied: Bool[np.ndarray, " time"]
) -> Markup:
    """Return the drawing of a map, with occupied hours as dashed lines."""
    grid = day_hour_grid(times)
    drawing = heat_map(
        grid,
        image=shown.image(grid),
        occupied=occupied,
        label=shown.label,
        identifier=shown.identifier,
    )
    return element("div", drawing, class_="year-scroll class-map")


def day_map_data(shown: DayMap, times: np.ndarray) -> dict[str, Any]:
    """Return classes and labels as JSON values."""
    return {
        "cells": packed(shown.cells(day_hour_grid(times))),
        "texts": list(shown.texts),
    }


def keys(
    texts: Sequence[str], colours: UInt8[np.ndarray, "kind 3"]
) -> list[tuple[str, str]]:
    """Return the colour `#rrggbb` and the label of each class."""
    shades = ["#{:02x}{:02x}{:02x}".format(*rgb) for rgb in colours.tolist()]
    return list(zip(shades, texts, strict=True))
