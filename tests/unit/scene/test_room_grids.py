"""Grids of several rooms, and views at their desks, in boxes of known size."""

import numpy as np
import pytest

from clerestory.scene.desk_views import desk_views
from clerestory.scene.model import Plastic, Polygon, Scene
from clerestory.scene.room_grids import room_grids
from clerestory.scene.scene_checks import check_scene
from clerestory.scene.view import View
from clerestory.scene.window import window_of

GREY = Plastic("grey", np.full(3, 0.5))


def wall(*corners):
    return Polygon(np.array(corners, float), "grey", "wall")


def upright(a, b, low=0.0, high=3.0):
    return wall((*a, low), (*b, low), (*b, high), (*a, high))


def box(west, east, low=0.0):
    """Floor, ceiling and three walls of a room of 4 m depth with its window south."""
    high = low + 3
    corners = (west, 0), (east, 0), (east, 4), (west, 4)
    level = [wall(*((*c, z) for c in corners)) for z in (low, high)]
    sides = [upright(corners[at], corners[at - 3], low, high) for at in (1, 2, 3)]
    return (*level, *sides)


def window(name, west, east, low=0.0):
    """The whole south side; its front faces north."""
    corners = (east, 0, low), (west, 0, low), (west, 0, low + 3), (east, 0, low + 3)
    polygon = Polygon(np.array(corners, float), name, name)
    return window_of((polygon,), name=name)


def scene(*surfaces):
    return Scene({"grey": GREY}, surfaces)


def test_rooms_behind_a_partition_have_grids_of_their_own():
    rooms = room_grids(
        scene(*box(0, 5), *box(5, 8)),
        [window("one", 0, 5), window("two", 5, 8)],
        spacing=1.0,
        height=0.76,
    )
    assert [[w.name for w in room.windows] for room in rooms] == [["one"], ["two"]]
    assert [len(room.sensors) for room in rooms] == [5 * 4, 3 * 4]
    assert rooms[1].sensors.position[:, 0].min() > 5


def test_two_windows_of_one_room_share_its_grid():
    [room] = room_grids(
        scene(*box(0, 8)),
        [window("one", 0, 4), window("two", 4, 8)],
        spacing=1.0,
        height=0.76,
    )
    assert [w.name for w in room.windows] == ["one", "two"]
    assert len(room.sensors) == 8 * 4


def test_rooms_above_each_other_are_two():
    rooms = room_grids(
        scene(*box(0, 5), *box(0, 5, low=3.2)),
        [window("lower", 0, 5), window("upper", 0, 5, low=3.2)],
        spacing=1.0,
        height=0.76,
    )
    assert [room.sensors.position[0, 2] for room in rooms] == pytest.approx(
        [0.76, 3.96]
    )


def test_views_are_at_the_desk_nearest_to_the_window():
    room = scene(*box(0, 5))
    [grid] = room_grids(room, [window("one", 0, 5)], spacing=1.0, height=0.76)
    along, towards = desk_views(room, grid, height=0.76)
    for view in (along, towards):
        np.testing.assert_allclose(view.position, [2.5, 1.5, 1.2], atol=1e-6)
    np.testing.assert_allclose(towards.direction, [0, -1, 0], atol=1e-9)
    assert abs(along.direction[0]) == pytest.approx(1)


def test_a_view_along_the_window_turns_away_from_a_partition():
    room = scene(*box(0, 5), upright((3.0, 0.5), (3.0, 3.5), high=1.6))
    [grid] = room_grids(room, [window("one", 0, 5)], spacing=1.0, height=0.76)
    along, _ = desk_views(room, grid, height=0.76)
    assert along.direction[0] == pytest.approx(-1)


@pytest.mark.parametrize(
    ("distance", "width", "expected"),
    [(0.6, 3.0, True), (1.4, 3.0, False), (0.65, 0.54, False)],
    ids=["partition", "far wall", "screen on the desk"],
)
def test_partitions_block_a_view_but_screens_do_not(distance, width, expected):
    half = width / 2
    shield = upright((-half, distance), (half, distance), 0.75 - half, 1.2 + half)
    view = View("angular", np.array([0.0, 0.0, 1.2]), horizontal=180, vertical=180)
    [*found] = check_scene(scene(shield), views={"desk": view})
    assert ('view "desk" faces a partition or a wall less than 1 m away' in found) == (
        expected
    )
