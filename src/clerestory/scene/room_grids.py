"""Sensor grids of all rooms that a set of windows belongs to.

Rooms are found by flood fills between the surfaces around them, one for each window
that is not in a room already: a partition up to the ceiling separates two rooms, a
lower one or an open door does not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.scene.floor_grid import filled_room, grid_below, sees, start_in_room
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window


@dataclass(frozen=True, eq=False)
class RoomGrid:
    """Windows of a room, and the sensors above its floor."""

    windows: tuple[Window, ...]
    sensors: Sensors


def room_grids(
    scene: Scene, windows: Sequence[Window], *, spacing: float, height: float
) -> list[RoomGrid]:
    """Return the sensor grid of each room, in the order of the windows.

    `scene` has no windows. `spacing` and `height` above the floor are in metres.

    Raises
    ------
    InputError : a room is open, or has no free floor
    """
    found, waiting = [], list(windows)
    while waiting:
        first = waiting[0]
        inside = filled_room(
            scene, first, others=[w for w in windows if w is not first], spacing=spacing
        )
        own = tuple(
            window
            for window in waiting
            if window is first or _reaches(inside, scene, window, spacing)
        )
        found.append(RoomGrid(own, grid_below(scene, windows, inside, height=height)))
        waiting = [window for window in waiting if window not in own]
    return found


def _reaches(
    inside: Float[np.ndarray, "point 3"], scene: Scene, window: Window, spacing: float
) -> bool:
    # Whether the place before a window is seen from the nearest point of a room
    start = start_in_room(scene, window)
    nearest = inside[int(np.argmin(np.linalg.norm(inside - start, axis=1)))]
    apart = np.hypot(*(nearest - start)[:2])
    return bool(apart < spacing) and sees(scene, start, nearest)
