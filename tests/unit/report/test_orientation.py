"""Orientation of windows in words, and its quality checks."""

import numpy as np
import pytest

from clerestory.report.content import WindowSurface
from clerestory.report.content_from_results import from_results
from clerestory.report.orientation import compass, orientation


@pytest.fixture(scope="module")
def content(room):
    return from_results(room.analytic_results(times=room.year(days=1)))


def window(normal, up, centre=(3.0, 0.0, 1.7)):
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 0, 1]]])
    corners += np.array(centre) - corners.mean(axis=1)
    return WindowSurface("w", corners, np.array(normal, float), np.array(up, float))


def test_compass_turns_with_the_scene():
    """A scene whose +y points 30° east of north has its +x 30° south of east."""
    assert compass(np.array([0.0, 1, 0])) == "north"
    assert compass(np.array([0.0, -1, 0])) == "south"
    assert compass(np.array([-1.0, 0, 0])) == "west"
    assert compass(np.array([1.0, 0, 0]), north=np.radians(45)) == "south-east"
    assert compass(np.array([0.0, 0, -1])) == "straight down"


def test_a_window_towards_the_sensors_is_fine(content):
    row = orientation(window([0, 1, 0], [0, 0, 1]), content)
    assert (row.room_side, row.outer_side, row.up) == ("north", "south", "straight up")
    assert row.in_front == 1
    assert row.problem == ""
    assert row.area == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("normal", "up", "words"),
    [
        ([0, -1, 0], [0, 0, 1], "faces away from 100%"),
        ([0, 1, 0], [1, 0, 0], "up direction is horizontal"),
        ([0, 1, 0], [0, 0, -1], "is upside down"),
    ],
)
def test_mistakes_are_named(content, normal, up, words):
    assert words in orientation(window(normal, up), content).problem


def test_a_window_may_face_away_from_sensors_of_other_rooms(content):
    """The sensors nearest to it are in front of it, more than half are behind it."""
    x, y, z = content.sensors.position[content.sensors.position[:, 1].argmax()]
    row = orientation(window([0, 1, 0], [0, 0, 1], (x, y - 0.01, z)), content)
    assert row.in_front < 0.5
    assert row.problem == ""


def test_a_skylight_may_have_its_up_to_the_north(content):
    skylight = window([0, 0, -1], [0, 1, 0], centre=(3, 4, 2.7))
    assert orientation(skylight, content).problem == ""
