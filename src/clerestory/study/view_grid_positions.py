"""Positions of the eyes of a view grid: from sensors, a file, a list or a floor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import located
from clerestory.glare.point_glare import view_along, views_around
from clerestory.scene.eye_places import free_eyes, require_free_eyes
from clerestory.scene.floor_grid import floor_grid, floor_level, polygon_grid
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors, read_positions
from clerestory.scene.view import View
from clerestory.scene.window import Window
from clerestory.study.view_grid_tables import MOST_POSITIONS, SEATED, ViewGridTable

# Height of tables [m]; people sit at them, not at or on higher furniture
_TABLE = 0.8


@dataclass(frozen=True, eq=False)
class ViewGrid:
    """View grid of a study: its table, and the positions of the eyes [m].

    `directions` are the lines of sight of each position; default: those of the table.
    """

    table: ViewGridTable
    position: Float[np.ndarray, "position 3"]
    directions: tuple[Float[np.ndarray, "direction 3"], ...] | None = None

    __repr__ = brief

    @property
    def name(self) -> str:
        """Name of the view grid."""
        return self.table.name

    def __len__(self) -> int:
        return len(self.position)

    @cached_property
    def azimuths_deg(self) -> Float[np.ndarray, " direction"]:
        """Azimuths of the view directions, clockwise from the scene's +y [°]."""
        table = self.table
        turns = np.arange(table.directions) * (360 / table.directions)
        return np.asarray((table.first_azimuth_deg + turns) % 360)

    def views(self, position: int) -> list[View]:
        """Return the views of one position, one for each direction."""
        where = self.position[position]
        if self.directions is not None:
            lines = self.directions[position]
            return [view_along(line, position=where) for line in lines]
        first = np.radians(self.table.first_azimuth_deg)
        return views_around(self.table.directions, position=where, first=first)


def read_view_grid(
    table: ViewGridTable,
    *,
    scene: Scene,
    windows: Sequence[Window],
    grids: Mapping[str, Sensors],
    metres: float,
) -> ViewGrid:
    """Return a view grid; its positions are checked against the scene [m].

    `metres` is the length of the unit of the file, of the places and of the floor.
    Positions of `spacing` that are in furniture are left out; all others must be free.

    Raises
    ------
    InputError : a position is outside the room, in a wall or in furniture, or there are
        none, or too many
    """
    what = f'[[view_grid]] "{table.name}"'
    with located(file=None, subject=what):
        found = _positions(table, scene, windows, grids, metres)
        position = _at_eye_heights(table, scene, found)
    require(
        len(position) <= MOST_POSITIONS,
        f"{what} has {len(position):,} positions; at most {MOST_POSITIONS:,} expected",
        file=table.file,
    )
    if table.spacing:
        position = position[free_eyes(scene, windows, position)]
        require(len(position), f"{what} has no free position; a free floor expected")
    else:
        require_free_eyes(scene, windows, position, what=what)
    return ViewGrid(table, position)


def _positions(
    table: ViewGridTable,
    scene: Scene,
    windows: Sequence[Window],
    grids: Mapping[str, Sensors],
    metres: float,
) -> Float[np.ndarray, "position 3"]:
    if table.grid:
        return grids[table.grid].position
    if table.file:
        return metres * read_positions(table.file)
    if table.places:
        return metres * np.array(table.places, dtype=float)
    spacing = table.spacing or 0.0
    if table.floor:
        corners = metres * np.array(table.floor, dtype=float)
        return polygon_grid(corners, spacing=spacing, most=MOST_POSITIONS)
    require(
        windows, 'no window to find the floor from; the corners of "floor" expected'
    )
    first, *others = windows
    found = floor_grid(scene, first, others=others, spacing=spacing, height=_TABLE)
    return found.position - [0, 0, _TABLE]


def _at_eye_heights(
    table: ViewGridTable, scene: Scene, found: Float[np.ndarray, "place 3"]
) -> Float[np.ndarray, "position 3"]:
    # Positions at each eye height above the floor; those of files and lists are eyes
    heights = table.eye_heights
    if not heights and (table.file or table.places):
        return found
    floor = found[0, 2] if table.spacing else floor_level(scene, found)
    levels = []
    for height in heights or [SEATED]:
        level = found.copy()
        level[:, 2] = floor + height
        levels.append(level)
    return np.concatenate(levels)
