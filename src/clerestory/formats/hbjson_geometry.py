"""Floors, sensor grids and views of honeybee models."""

import numpy as np
from jaxtyping import Float

from clerestory.errors import located
from clerestory.formats.building_model import (
    GridLabel,
    RoomFloor,
    seamed,
    unique_name,
)
from clerestory.formats.hbjson_schema import Radiance, Room
from clerestory.scene.projection import LETTERS
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import area_vector
from clerestory.scene.view import View


def room_floor(room: Room, scale: float) -> RoomFloor:
    """Return the floor of a room, in metres."""
    tops = [point[2] * scale for face in room.faces for point in face.boundary]
    floors = [face for face in room.faces if face.face_type == "Floor"]
    return RoomFloor(
        room.identifier,
        room.display_name or room.identifier,
        tuple(seamed(face.loops()) * scale for face in floors),
        max(tops, default=0.0),
        room.program if isinstance(room.program, str) else "",
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


def plane_of(outline: Float[np.ndarray, "point 3"]) -> tuple[float, ...]:
    """Return the plane of a polygon: rounded normal and distance from origin [m]."""
    normal = area_vector(outline)
    normal /= max(float(np.linalg.norm(normal)), 1e-12)
    distance = float(normal @ outline.mean(axis=0))
    return (*(round(float(x), 3) + 0.0 for x in normal), round(distance, 2) + 0.0)
