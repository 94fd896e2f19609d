"""Outlines, floors, sensor grids and views of honeybee models."""

from collections.abc import Container
from dataclasses import dataclass
from itertools import count
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.errors import located
from clerestory.formats.hbjson_schema import Radiance, Room
from clerestory.scene.polygon_grid import inside
from clerestory.scene.projection import LETTERS
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import area_vector
from clerestory.scene.view import View

# Largest number of characters of a name, before its number, and of equal names
_LONGEST, _MOST_ALIKE = 90, 1000

# Tolerance of heights of sensors above the floor [m]
_LEVEL = 1e-6


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

    `top` is the height of the highest corner of the room [m].
    """

    identifier: str
    name: str
    outlines: tuple[Float[np.ndarray, "_ 3"], ...]
    top: float

    def contains(self, points: Float[np.ndarray, "point 3"]) -> bool:
        """Whether at least one of the points is above the floor and in the room."""
        for outline in self.outlines:
            height = points[:, 2]
            level = (height >= outline[:, 2].min() - _LEVEL) & (height <= self.top)
            if np.any(level & inside(points[:, :2], outline[:, :2])):
                return True
        return False


def room_floor(room: Room, scale: float) -> RoomFloor:
    """Return the floor of a room, in metres."""
    tops = [point[2] * scale for face in room.faces for point in face.boundary]
    floors = [face for face in room.faces if face.face_type == "Floor"]
    return RoomFloor(
        room.identifier,
        room.display_name or room.identifier,
        tuple(seamed(face.loops()) * scale for face in floors),
        max(tops, default=0.0),
    )


def read_grids(
    radiance: Radiance, scale: float
) -> tuple[dict[str, Sensors], dict[str, GridLabel]]:
    """Return the sensor grids and their labels by name, with positions in metres.

    Empty grids are omitted.
    """
    found: dict[str, Sensors] = {}
    labels: dict[str, GridLabel] = {}
    for grid in radiance.sensor_grids:
        if grid.sensors:
            places = np.array([sensor.pos for sensor in grid.sensors]) * scale
            facing = np.array([sensor.dir for sensor in grid.sensors])
            with located(file=None, subject=f'sensor grid "{grid.identifier}"'):
                sensors = Sensors(places, facing)
            name = unique_name(grid.display_name or grid.identifier, found)
            found[name] = sensors
            labels[name] = GridLabel(
                grid.identifier, grid.room_identifier, grid.group_identifier
            )
    return found, labels


def read_views(radiance: Radiance, scale: float) -> dict[str, View]:
    """Return the views by name, with positions in metres."""
    found: dict[str, View] = {}
    for item in radiance.views:
        with located(file=None, subject=f'view "{item.identifier}"'):
            view = View(
                kind=LETTERS[item.view_type],
                position=np.array(item.position) * scale,
                direction=np.array(item.direction),
                up=np.array(item.up_vector),
                horizontal=item.h_size,
                vertical=item.v_size,
                shift=item.shift,
                lift=item.lift,
                fore=item.fore_clip * scale,
                aft=item.aft_clip * scale,
            )
        found[unique_name(item.display_name or item.identifier, found)] = view
    return found


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


def plane_of(outline: Float[np.ndarray, "point 3"]) -> tuple[float, ...]:
    """Return the plane of a polygon: rounded normal and distance from origin [m]."""
    normal = area_vector(outline)
    normal /= max(float(np.linalg.norm(normal)), 1e-12)
    distance = float(normal @ outline.mean(axis=0))
    return (*(round(float(x), 3) + 0.0 for x in normal), round(distance, 2) + 0.0)
