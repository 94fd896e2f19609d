"""Views of people at desks: proposals, and views that look into a partition.

Eyes are 1.2 m above the floor. A view is blocked if nine tenths of the rays within 30°
of its line of sight meet a surface within a metre: a partition or a wall does, a screen
on a desk does not.
"""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import RayVectors, Vector
from clerestory.directions import unit
from clerestory.scene.model import Scene
from clerestory.scene.proximity import Triangulation, first_hits
from clerestory.scene.room_grids import RoomGrid
from clerestory.scene.tessellate import meshes
from clerestory.scene.view import View

# Height of the eyes above the floor, distance of the first desk from the windows [m]
EYE_HEIGHT, _FROM_WINDOW = 1.2, 1.5

# Number of views of a desk if none is blocked
DESK_VIEWS = 2

# A blocked view: distance [m] and share of the rays within an angle [°]
_NEAR, _SHARE, _CONE_DEG = 1.0, 0.9, 30.0

_UP = np.array([0.0, 0.0, 1.0])


def desk_views(scene: Scene, room: RoomGrid, *, height: float) -> list[View]:
    """Return a view along the window and one towards it, of the desk nearest to it.

    The desk is the sensor of the grid that is nearest to a place 1.5 m in front of the
    middle of the first window; `height` is that of the sensors above the floor [m].
    Views into a wall or a partition are turned round or omitted.
    """
    window = room.windows[0]
    corners = np.concatenate([polygon.vertices for polygon in window.polygons])
    middle, floor = corners.mean(axis=0), room.sensors.position.copy()
    floor[:, 2] += EYE_HEIGHT - height
    outwards = middle - floor.mean(axis=0)
    outwards = unit(np.array([*outwards[:2], 0.0]))
    normal = window.frame.normal
    towards = normal if normal @ outwards > 0 else -normal
    wanted = middle - _FROM_WINDOW * towards
    eye = floor[int(np.argmin(np.hypot(*(floor - wanted)[:, :2].T)))]
    along = np.cross(_UP, towards)
    views, solid = [], _solid(scene)
    for choices in ((along, -along), (towards,)):
        given = [_fisheye(eye, unit(choice)) for choice in choices]
        free = [view for view in given if not is_blocked(solid, view)]
        views += free[:1]
    return views


def _fisheye(eye: Vector, direction: Vector) -> View:
    return View("angular", eye, direction, horizontal=180, vertical=180)


def is_blocked(solid: Triangulation, view: View) -> bool:
    """Whether a view looks into a partition or a wall that is less than 1 m away.

    `solid` has the triangles of the opaque surfaces.
    """
    near = solid.near(view.position, _NEAR).corner
    distance = first_hits(view.position, _around(view.direction), near)
    return bool(np.mean(distance < _NEAR) >= _SHARE)


def _solid(scene: Scene) -> Triangulation:
    opaque = [mesh for mesh in meshes(scene) if mesh.material.opaque]
    parts = [mesh.vertices[mesh.faces] for mesh in opaque]
    corner = np.concatenate(parts) if parts else np.zeros((0, 3, 3))
    return Triangulation(corner, np.zeros(len(corner), dtype=int))


def _around(direction: Vector) -> Float[np.ndarray, "ray 3"]:
    # Rays of equal solid angle within the cone, on a spiral
    count = 200
    step = np.arange(count) + 0.5
    cosine = 1 - (1 - np.cos(np.radians(_CONE_DEG))) * step / count
    turn = np.pi * (1 + np.sqrt(5)) * step
    side = unit(np.cross(direction, _UP if abs(direction[2]) < 0.9 else np.eye(3)[0]))
    other = np.cross(direction, side)
    sine = np.sqrt(1 - cosine**2)[:, None]
    rays: RayVectors = cosine[:, None] * direction + sine * (
        np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * other
    )
    return rays
