"""Models of buildings read from files of other programs, and names in them.

Readers of honeybee and IFC files return a `BuildingModel`, which
`clerestory.study.model_import` writes as files of a study.
"""

from collections.abc import Container
from dataclasses import dataclass
from itertools import count
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.formats.hbjson_modifiers import Modifier
from clerestory.scene.model import Scene
from clerestory.scene.polygon_grid import inside
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import area_vector
from clerestory.scene.view import View

# Largest number of characters of a name, before its number, and of equal names
_LONGEST, _MOST_ALIKE = 90, 1000

# Tolerance of heights of sensors above the floor [m]
_LEVEL = 1e-6


@final
@dataclass(frozen=True, eq=False)
class ApertureGroup:
    """Apertures that form one window group.

    Attributes
    ----------
    polygons : outline of each aperture, counter-clockwise as seen from the room [m]
    up : up vector of the BSDF; None for the default
    states : name and modifier of each dynamic state; one entry for a static window
    """

    name: str
    polygons: tuple[Float[np.ndarray, "_ 3"], ...]
    up: Float[np.ndarray, "3"] | None
    states: tuple[tuple[str, Modifier], ...]


@final
@dataclass(frozen=True)
class GridLabel:
    """Identifier of a sensor grid, of its room, and of the group of grids."""

    identifier: str
    room: str = ""
    group: str = ""


@final
@dataclass(frozen=True, eq=False)
class RoomFloor:
    """The floor of a room: an outline per face, joined with its holes [m].

    `top` is the height of the highest corner of the room [m], `program` the name of
    its use in the model.
    """

    identifier: str
    name: str
    outlines: tuple[Float[np.ndarray, "_ 3"], ...]
    top: float
    program: str = ""

    def contains(self, points: Float[np.ndarray, "point 3"]) -> bool:
        """Whether at least one of the points is above the floor and in the room."""
        for outline in self.outlines:
            height = points[:, 2]
            level = (height >= outline[:, 2].min() - _LEVEL) & (height <= self.top)
            if np.any(level & inside(points[:, :2], outline[:, :2])):
                return True
        return False


@final
@dataclass(frozen=True)
class SitePosition:
    """Latitude, positive north, and longitude, positive east, of a site [°]."""

    latitude_deg: float
    longitude_deg: float


@final
@dataclass(frozen=True, eq=False)
class BuildingModel:
    """A model of a building: scene without windows, window groups, sensors and views.

    Attributes
    ----------
    grids, labels : sensors and identifiers of each sensor grid, by name
    rooms : floors of the rooms
    unsupported : descriptions of the content of the file that is ignored
    assumptions : descriptions of values that the file lacks, and of those used instead
    north_deg : angle from +y of the model to north, counter-clockwise [deg]
    site : position of the site; None if the file has none
    """

    name: str
    scene: Scene
    windows: tuple[ApertureGroup, ...]
    grids: dict[str, Sensors]
    labels: dict[str, GridLabel]
    rooms: tuple[RoomFloor, ...]
    views: dict[str, View]
    unsupported: tuple[str, ...]
    assumptions: tuple[str, ...] = ()
    north_deg: float = 0.0
    site: SitePosition | None = None

    __repr__ = brief


def unique_name(name: str, taken: Container[str]) -> str:
    """Return a name for a study file: hyphens replace special characters.

    A name that is taken is numbered; it has at most 100 characters.
    """
    known = (c if c.isalpha() or c.isdecimal() or c in " .-_" else "-" for c in name)
    label = plain = "".join(known)[:_LONGEST].strip() or "grid"
    for number in count(2):
        if label not in taken:
            break
        message = f"more than {_MOST_ALIKE:,} names like {plain!r}"
        require(number <= _MOST_ALIKE, f"{message}; different names expected")
        label = f"{plain} {number}"
    return label


def seamed(loops: list[Float[np.ndarray, "_ 3"]]) -> Float[np.ndarray, "point 3"]:
    """Join an outline and its holes to one polygon, by seams from the first corner.

    Holes are oriented opposite to the outline, so that they reduce the signed area.
    """
    first = loops[0]
    outward = area_vector(first)
    outline = [first]
    for hole in loops[1:]:
        turned = hole[::-1] if area_vector(hole) @ outward > 0 else hole
        outline += [first[:1], turned, turned[:1]]
    return np.concatenate(outline)
