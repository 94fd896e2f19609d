"""Automatic sensor grid over the floor of the room behind a window.

The room is found by a flood fill at the height of the window's centre, from a point in
the room to the surrounding surfaces. The floor height is the most frequent height of
the surfaces below the filled points. No sensors are placed inside or below furniture.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.path import Path

from clerestory.array_types import Vector
from clerestory.checks import require
from clerestory.scene.model import Scene
from clerestory.scene.proximity import Triangulation, first_hits
from clerestory.scene.sensors import Sensors
from clerestory.scene.tessellate import meshes
from clerestory.scene.window import Window

# Distance from the window to the start of the flood fill; maximum room extent [m]
_START, _LARGEST = 0.3, 60.0

# Difference of heights up to which surfaces belong to the same floor [m]
_SAME = 0.02

# Number of surfaces below a point that may be the floor; share of the points that have
# the floor below them
_LEVELS, _COMMON = 6, 0.9

_UP = np.array([0.0, 0.0, 1.0])
_SIDEWAYS = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])


def floor_grid(
    scene: Scene,
    window: Window,
    *,
    others: Sequence[Window] = (),
    spacing: float = 0.5,
    height: float = 0.76,
) -> Sensors:
    """Return a regular grid of upward-facing sensors in the room behind a window.

    `scene` has no windows; `others` are further windows of the room. The normal of
    `window` may point inwards or outwards. `spacing` and `height` above the floor are
    in metres.
    """
    inside = filled_room(scene, window, others=others, spacing=spacing)
    return grid_below(scene, [window, *others], inside, height=height)


def filled_room(
    scene: Scene, window: Window, *, others: Sequence[Window], spacing: float
) -> Float[np.ndarray, "point 3"]:
    """Return points in the room behind a window, at the height of its centre [m].

    They are `spacing` apart and end at the surfaces and windows around the room.
    """
    walls = _walls(scene, [window, *others])
    start = start_in_room(scene, window)
    return _filled(walls, _centred(walls, start, spacing), spacing)


def start_in_room(scene: Scene, window: Window) -> Vector:
    """Return a point in the room, 0.3 m from the centre of a window [m]."""
    inwards = room_side(scene, window) * window.frame.normal
    return np.asarray(_centre(window) + _START * inwards)


def sees(scene: Scene, start: Vector, end: Vector) -> bool:
    """Whether no surface is between two points."""
    distance = float(np.linalg.norm(end - start))
    if distance == 0:
        return True
    ray = ((end - start) / distance)[None]
    return bool(first_hits(start, ray, _walls(scene, []).corner)[0] >= distance)


def grid_below(
    scene: Scene,
    windows: Sequence[Window],
    inside: Float[np.ndarray, "point 3"],
    *,
    height: float,
) -> Sensors:
    """Return upward-facing sensors above the floor below points of a room."""
    walls = _walls(scene, windows)
    drop = np.array([first_hits(p, -_UP[None], walls.corner)[0] for p in inside])
    floor = _most_frequent(inside[:, 2] - drop)

    # Sensors inside or below furniture are omitted
    free = inside[:, 2] - drop < floor + height - _SAME
    position = inside[np.isfinite(drop) & free & (inside[:, 2] > floor + height)]
    require(
        len(position),
        f'no free floor was found behind "{windows[0].name}"; a sensor file expected',
    )
    position[:, 2] = floor + height
    order = np.lexsort((position[:, 0], position[:, 1]))
    return Sensors(position[order], np.tile(_UP, (len(position), 1)))


def floor_level(scene: Scene, position: Float[np.ndarray, "point 3"]) -> float:
    """Return the height of the floor below points [m].

    This is the highest level at which surfaces are below nearly all points; furniture
    is below some of them. Points may be on the floor itself.
    """
    solid, levels = _walls(scene, []), []
    for point in position:
        start = point + _SAME * _UP
        corner = solid.beneath(start).corner
        for _ in range(_LEVELS):
            drop = first_hits(start, -_UP[None], corner)[0]
            if np.isinf(drop):
                break
            levels.append(start[2] - drop)
            start[2] = levels[-1] - 1e-4
    known = np.round(np.array(levels) / _SAME)
    values, count = np.unique(known, return_counts=True)
    common = values[count >= _COMMON * len(position)]
    require(
        len(common),
        "no surface is below all positions; positions above a floor expected",
    )
    return float(np.median([x for x in levels if abs(x / _SAME - common[-1]) <= 1]))


def polygon_grid(
    corners: Float[np.ndarray, "corner 3"], *, spacing: float, most: int
) -> Float[np.ndarray, "point 3"]:
    """Return a regular grid of points in a level polygon [m], by rows from below.

    The grid is centred in the bounding rectangle of the polygon.

    >>> square = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
    >>> polygon_grid(square, spacing=1.0, most=9).tolist()
    [[0.5, 0.5, 0.0], [1.5, 0.5, 0.0]]
    """
    require(
        np.ptp(corners[:, 2]) < _SAME,
        f"corners of the floor differ in height by {np.ptp(corners[:, 2]):.3g} m; the"
        " same height expected",
    )
    low, size = corners[:, :2].min(axis=0), np.ptp(corners[:, :2], axis=0)
    count = np.maximum(np.floor(size / spacing + 1e-6), 1)
    require(
        count.prod() <= most,
        f"{count.prod():,.0f} positions at a spacing of {spacing:g} m; at most"
        f" {most:,} expected",
    )
    margin = (size - (count - 1) * spacing) / 2
    x, y = (
        low[axis] + margin[axis] + spacing * np.arange(count[axis]) for axis in (0, 1)
    )
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    inside = Path(corners[:, :2]).contains_points(points)
    require(
        inside.any(),
        f"no position at a spacing of {spacing:g} m is on the floor; a smaller spacing"
        " expected",
    )
    level = np.full((np.count_nonzero(inside), 1), corners[:, 2].mean())
    return np.concatenate([points[inside], level], axis=1)


def room_side(scene: Scene, window: Window) -> int:
    """Return 1 if the room is on the front side of the window, −1 if on the back side.

    The room is on the side where a surface (the ceiling) is above; if this is so on
    both sides or on neither, the front side is returned.
    """
    walls, centre = _walls(scene, []), _centre(window)
    front, back = (
        np.isfinite(first_hits(centre + step, _UP[None], walls.corner)[0])
        for step in (_START * window.frame.normal, -_START * window.frame.normal)
    )
    return -1 if back and not front else 1


def _walls(scene: Scene, windows: Sequence[Window]) -> Triangulation:
    # Triangles close the windows, so that the flood fill does not leave the room
    parts = [mesh.vertices[mesh.faces] for mesh in meshes(scene)]
    parts += [t.vertices[t.faces] for window in windows for t in window.triangles()]
    corner = np.concatenate(parts) if parts else np.zeros((0, 3, 3))
    return Triangulation(corner, np.zeros(len(corner), dtype=int))


def _centre(window: Window) -> Vector:
    # The centre of the largest triangle is inside the window for any outline
    largest = max(window.triangles(), key=lambda t: t.areas().max())
    chosen = largest.faces[int(np.argmax(largest.areas()))]
    return np.asarray(largest.vertices[chosen].mean(axis=0))


def _centred(walls: Triangulation, start: Vector, spacing: float) -> Vector:
    # Moves the start point so that grid points are centred between opposite walls
    east, west, north, south = first_hits(start, _SIDEWAYS, walls.corner)
    moved = start.copy()
    for axis, ahead, behind in ((0, east, west), (1, north, south)):
        width = ahead + behind
        if np.isfinite(width) and width > spacing:
            count = np.floor(width / spacing + 1e-6)
            margin = (width - (count - 1) * spacing) / 2
            place = (behind - margin) / spacing
            moved[axis] += (np.clip(round(place), 0, count - 1) - place) * spacing
    return moved


def _filled(
    walls: Triangulation, start: Vector, spacing: float
) -> Float[np.ndarray, "point 3"]:
    # Flood fill over neighbouring points with a free line of sight between them
    known, waiting = {(0, 0)}, [(0, 0)]
    most = round(_LARGEST / spacing)
    while waiting:
        cell = waiting.pop()
        point = start + spacing * np.array([*cell, 0.0])
        free = first_hits(point, _SIDEWAYS, walls.near(point, spacing).corner) > spacing
        for step in _SIDEWAYS[free].astype(int).tolist():
            there = (cell[0] + step[0], cell[1] + step[1])
            require(
                max(map(abs, there)) <= most,
                f"the room behind the window is open or extends {_LARGEST:g} m;"
                " a closed room, its unit (--units) or a sensor file expected",
            )
            if there not in known:
                known.add(there)
                waiting.append(there)
    cells = np.array(sorted(known), dtype=float)
    return start + spacing * np.column_stack([cells, np.zeros(len(cells))])


def _most_frequent(levels: Float[np.ndarray, " point"]) -> float:
    found = np.round(levels[np.isfinite(levels)] / _SAME)
    require(len(found), "there is no surface below the window; a floor expected")
    values, count = np.unique(found, return_counts=True)
    chosen = values[int(np.argmax(count))]
    same = np.abs(levels / _SAME - chosen) <= 1
    return float(np.median(levels[same]))
