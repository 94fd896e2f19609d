"""Heat maps of classes over the days and hours of a year.

They show glare, the states of windows and the dimming of luminaires; the class of a
cell appears at the pointer.
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
    """The class of every step, and what classes look like.

    Attributes
    ----------
    identifier : of the drawing in the page
    label : what it shows, in words
    codes : class of each step, -1 where there is none; where steps share a cell, as
        those of several years do, the highest class shows
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
            raise InputError(f"class {highest} of a map; 0 to {known - 1} expected")

    def cells(self, grid: DayHourGrid) -> UInt8[np.ndarray, " cell"]:
        """Class of each cell, day by day; 255 without data."""
        found = np.full(grid.days * grid.bins, -1)
        np.maximum.at(found, grid.cell, self.codes)
        return np.where(found < 0, _NO_DATA, found).astype(np.uint8)

    def image(self, grid: DayHourGrid) -> str:
        """Return the cells in their colours as a data address."""
        cells = self.cells(grid).reshape(grid.days, grid.bins).T[::-1]
        rgba = np.zeros((*cells.shape, 4), dtype=np.uint8)
        known = cells != _NO_DATA
        rgba[known, :3] = self.colours[cells[known]]
        rgba[known, 3] = 255
        return png(rgba)


def day_map(
    shown: DayMap, times: np.ndarray, *, occupied: Bool[np.ndarray, " time"]
) -> Markup:
    """Return the drawing of a map, with the schedule as dashed lines."""
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
    """Return classes and labels as plain values for JSON."""
    return {
        "cells": packed(shown.cells(day_hour_grid(times))),
        "texts": list(shown.texts),
    }


def keys(
    texts: Sequence[str], colours: UInt8[np.ndarray, "kind 3"]
) -> list[tuple[str, str]]:
    """Return the colour `#rrggbb` of each class with its text."""
    shades = ["#{:02x}{:02x}{:02x}".format(*rgb) for rgb in colours.tolist()]
    return list(zip(shades, texts, strict=True))
