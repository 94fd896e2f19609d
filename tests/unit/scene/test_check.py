"""Misplaced sensors and windows are found and named; a sound scene raises no doubt."""

import numpy as np
import pytest

from clerestory.directions import Frame
from clerestory.hemisphere.klems import klems
from clerestory.scene import scene_checks
from clerestory.scene.model import Glass, Plastic, Polygon, Scene
from clerestory.scene.scene_checks import check_scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window


def rectangle(corner, one, two, name):
    corner, one, two = (np.array(v, dtype=float) for v in (corner, one, two))
    return Polygon(
        np.array([corner, corner + one, corner + one + two, corner + two]), "grey", name
    )


def room(size=1.0):
    """A room 4 × 4 × 3 m on a ground 0.2 m below, open in the south above 1 m."""
    surfaces = (
        rectangle((0, 0, 0), (4, 0, 0), (0, 4, 0), "floor"),
        rectangle((0, 0, 3), (0, 4, 0), (4, 0, 0), "ceiling"),
        rectangle((0, 0, 0), (0, 4, 0), (0, 0, 3), "west"),
        rectangle((4, 0, 0), (0, 0, 3), (0, 4, 0), "east"),
        rectangle((0, 4, 0), (4, 0, 0), (0, 0, 3), "north"),
        rectangle((0, 0, 0), (4, 0, 0), (0, 0, 1), "sill"),
        rectangle((-10, -10, -0.2), (24, 0, 0), (0, 24, 0), "ground"),
    )
    scaled = tuple(Polygon(size * s.vertices, "grey", s.name) for s in surfaces)
    return Scene({"grey": Plastic("grey", np.full(3, 0.5))}, scaled)


def window(*, turned=False, at=0.0):
    pane = rectangle((0, at, 1), (0, 0, 2), (4, 0, 0), "pane")
    vertices = pane.vertices[::-1] if turned else pane.vertices
    normal = np.array([0.0, -1 if turned else 1, 0])
    frame = Frame.from_normal_up(normal, np.array([0.0, 0, 1]))
    return Window("south", (Polygon(vertices, "void", "pane"),), frame, klems())


def sensors(*points, direction=(0, 0, 1), names=None):
    position = np.array(points, dtype=float)
    return Sensors(
        position, np.tile(np.array(direction, float), (len(points), 1)), names
    )


DESKS = [(1, 1, 0.8), (2, 2, 0.8), (3, 3, 0.8)]


def test_a_sound_scene_raises_no_doubt():
    assert check_scene(room(), [window()], sensors(*DESKS)) == ()
    assert check_scene(room(), [window()], sensors(*DESKS, direction=(0, 1, 0))) == ()
    assert check_scene(room()) == ()


@pytest.mark.parametrize(
    ("point", "message"),
    [
        ((2, 2, -0.1), "sensor 4 of 4 is enclosed"),
        ((2, 2, -3), "sensor 4 of 4 is outside the bounding box"),
        ((2, 50, 1), "sensor 4 of 4 is outside the bounding box"),
        ((2, 2, 0), "sensor 4 of 4 is nearer than 1 mm to a surface"),
        ((4, 2, 1.5), "sensor 4 of 4 is nearer than 1 mm to a surface"),
        ((2, 0, 2), 'sensor 4 of 4 is in the plane of window "south"'),
        ((1, 1, 0.8), "sensor 4 of 4 is given twice"),
    ],
)
def test_a_misplaced_sensor_is_named(point, message):
    [finding] = check_scene(room(), [window()], sensors(*DESKS, point))
    assert message in finding


def test_findings_among_some_of_the_sensors_say_so(monkeypatch):
    """Where all would take too long; checks without triangles include each."""
    monkeypatch.setattr(scene_checks, "_EFFORT", 2 * 14)  # triangles of the room
    few = check_scene(room(), (), sensors((2, 2, 0), *DESKS, DESKS[0]))
    assert few[0] == "sensor 5 of 5 is given twice"
    assert few[1].startswith("sensor 1 of 5, 2 of which were checked, is nearer")
    assert len(few) == 2


def test_sensors_go_by_their_names():
    [finding] = check_scene(
        room(), (), sensors((1, 1, 0.8), (2, 2, 0), names=("a", "b"))
    )
    assert "sensor b of 2" in finding


def test_a_sensor_with_nothing_beneath_is_named():
    scene = room()
    without = Scene(scene.materials, scene.surfaces[:-1])
    over_the_edge = Scene(
        scene.materials,
        (*without.surfaces, rectangle((-9, -9, -1), (1, 0, 0), (0, 1, 0), "plinth")),
    )
    [finding] = check_scene(over_the_edge, (), sensors((2, 2, -0.5)))
    assert "without a surface below" in finding


def test_a_window_that_turns_its_back_is_named():
    [finding] = check_scene(room(), [window(turned=True)], sensors(*DESKS))
    assert 'window "south" has 3 of 3 sensors behind it' in finding


def test_sensors_of_other_rooms_may_be_behind_a_window():
    """In a building, most sensors are behind a window of a courtyard."""
    others = [(x, y, 0.8) for x in (1, 2, 3) for y in (-8, -6, -4)]
    assert check_scene(room(), [window()], sensors(*DESKS, *others)) == ()
    [finding] = check_scene(room(), [window(turned=True)], sensors(*DESKS))
    assert "reverse its vertices" in finding


def test_a_window_outside_the_scene_is_named():
    findings = check_scene(room(), [window(at=-20.0)], sensors(*DESKS))
    assert findings == ('window "south" extends 10 m beyond the surfaces of the scene',)


def test_a_window_behind_its_own_glazing_is_named():
    scene = room()
    pane = Polygon(window().polygons[0].vertices, "grey", "glazing")
    glazed = Scene(scene.materials, (*scene.surfaces, pane))
    [finding] = check_scene(glazed, [window()], sensors(*DESKS))
    assert 'window "south" is covered by the surface "glazing"' in finding


@pytest.mark.parametrize("size", [1000.0, 0.001])
def test_scenes_that_are_hardly_in_metres_are_doubted(size):
    [finding] = check_scene(room(size))
    assert "is it in metres?" in finding


def test_a_view_into_a_wall_is_named_unless_it_is_of_glass():
    view = View("angular", np.array([2, 3.5, 1.2]), horizontal=180, vertical=180)
    plan = View("parallel", np.array([2, 3.5, 1.2]), horizontal=4, vertical=4)
    [finding] = check_scene(room(), views={"desk": view, "plan": plan})
    assert finding == 'view "desk" faces a partition or a wall less than 1 m away'
    glass = {"grey": Glass("grey", np.full(3, 0.9))}
    assert check_scene(Scene(glass, room().surfaces), views={"desk": view}) == ()
