"""Window groups of a new study: panes sorted by room and orientation.

Modellers export the panes of a whole building under one material. Of panes with
several faces, the one towards the room is used. Panes whose back faces the room are
turned, and those of one room and one normal form a window group, which can have shades
of its own.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clerestory.brief_repr import brief
from clerestory.radiance.window_reader import Pane, window_of_panes
from clerestory.scene.floor_grid import room_side
from clerestory.scene.model import Scene
from clerestory.scene.room_grids import RoomGrid, room_grids
from clerestory.scene.scaling import scaled
from clerestory.scene.solid_panes import edges_of_panes, faces_behind_others
from clerestory.scene.window import Window

# Smallest cosine between the normals of panes of one window group
_SAME_NORMAL = np.cos(np.radians(0.25))

# Panes by modifier
Panes = Mapping[str, Sequence[Pane]]


@dataclass(frozen=True, eq=False)
class NewWindow:
    """Window group in the unit of its file, named by the modifier of its panes.

    `room` is the number of its room, `turned` whether panes of it were turned, `whole`
    whether it has all panes of the modifier.
    """

    window: Window
    room: int
    turned: bool
    whole: bool

    __repr__ = brief


@dataclass(eq=False)
class _Placed:
    # Pane that faces the room, its file and modifier, its window in metres, and whether
    # it was turned
    file: Path
    name: str
    pane: Pane
    window: Window
    turned: bool
    room: int = 0


def sorted_windows(
    scene: Scene,
    files: Mapping[Path, Panes],
    *,
    metres: float,
    grid: Mapping[str, float] | None,
) -> tuple[dict[Path, list[NewWindow]], list[RoomGrid]]:
    """Return the window groups of each file, and the rooms with their sensors.

    `scene` [m] has no panes, `metres` is the unit of the files. `grid` has spacing and
    height of the sensors [m]; rooms are not told apart without it.
    """
    placed = _inner_faces(
        [
            each
            for file, name, panes in _without_edges(files, metres)
            for each in _facing_room(scene, file, name, panes, metres=metres)
        ]
    )
    rooms = _rooms(scene, placed, grid) if grid else []
    groups = {
        file: [
            group
            for name in panes
            for group in _groups(
                name,
                [each for each in placed if (each.file, each.name) == (file, name)],
            )
        ]
        for file, panes in files.items()
    }
    return groups, [
        replace(room, windows=tuple(_of_room(groups, number, metres)))
        for number, room in enumerate(rooms)
    ]


def faces_left_out(
    files: Mapping[Path, Panes], groups: Mapping[Path, Sequence[NewWindow]]
) -> dict[tuple[Path, str], int]:
    """Return how many faces of panes no window group has, by file and modifier."""
    given = {
        (f, name): len(own) for f, panes in files.items() for name, own in panes.items()
    }
    for file, found in groups.items():
        for group in found:
            given[file, group.window.name] -= len(group.window.polygons)
    return {key: count for key, count in given.items() if count}


def _without_edges(
    files: Mapping[Path, Panes], metres: float
) -> Iterator[tuple[Path, str, list[Pane]]]:
    # Panes by file and modifier, without the edges of solid panes
    every = [p for own in files.values() for panes in own.values() for p in panes]
    edges = iter(edges_of_panes([p.polygon.vertices * metres for p in every]))
    for file, own in files.items():
        for name, panes in own.items():
            yield file, name, [pane for pane in panes if not next(edges)]


def _inner_faces(placed: Sequence[_Placed]) -> list[_Placed]:
    behind = faces_behind_others([each.window for each in placed])
    return [each for each, out in zip(placed, behind, strict=True) if not out]


def _facing_room(
    scene: Scene, file: Path, name: str, panes: Sequence[Pane], *, metres: float
) -> Iterator[_Placed]:
    for pane in panes:
        window = scaled(window_of_panes(name, [pane]), metres)
        turned = room_side(scene, window) < 0
        if turned:
            outline = pane.polygon.vertices[::-1]
            pane = replace(pane, polygon=replace(pane.polygon, vertices=outline))
            window = scaled(window_of_panes(name, [pane]), metres)
        yield _Placed(file, name, pane, window, turned)


def _rooms(
    scene: Scene, every: Sequence[_Placed], grid: Mapping[str, float]
) -> list[RoomGrid]:
    # Finds the room of each pane
    rooms = room_grids(
        scene,
        [each.window for each in every],
        spacing=grid["spacing"],
        height=grid["height"],
    )
    number = {id(w): k for k, room in enumerate(rooms) for w in room.windows}
    for each in every:
        each.room = number[id(each.window)]
    return rooms


def _groups(name: str, panes: Sequence[_Placed]) -> Iterator[NewWindow]:
    waiting = list(panes)
    while waiting:
        first = waiting[0]
        own = [each for each in waiting if _together(first, each)]
        waiting = [each for each in waiting if each not in own]
        window = window_of_panes(name, [each.pane for each in own])
        turned = any(each.turned for each in own)
        yield NewWindow(window, first.room, turned, whole=len(own) == len(panes))


def _together(first: _Placed, other: _Placed) -> bool:
    cosine = first.window.frame.normal @ other.window.frame.normal
    return bool(first.room == other.room and cosine >= _SAME_NORMAL)


def _of_room(
    groups: Mapping[Path, Sequence[NewWindow]], number: int, metres: float
) -> Iterator[Window]:
    for found in groups.values():
        yield from (scaled(g.window, metres) for g in found if g.room == number)
