"""Sensor files: six numbers a line, and a place for everything that is wrong."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.scene.sensors import Sensors, read_sensors


def test_lines_are_positions_and_unit_directions(tmp_path):
    file = tmp_path / "desk.pts"
    file.write_text("# desks\n\n0.3 0.3 0.75 0 0 2\r\n 1,2,3, 0,-1,0 # by commas\n")
    sensors = read_sensors(file)
    assert sensors.position.tolist() == [[0.3, 0.3, 0.75], [1, 2, 3]]
    assert sensors.direction.tolist() == [[0, 0, 1], [0, -1, 0]]
    assert sensors.names is None


def test_the_tutorials_sensors_are_a_grid_of_a_hundred(shared_data):
    sensors = read_sensors(shared_data / "tutorial_room/points.txt")
    assert len(sensors) == 100
    assert np.unique(sensors.position[:, 2]).tolist() == [0.75]
    np.testing.assert_array_equal(sensors.direction, np.tile([0, 0, 1], (100, 1)))


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("1 2 3 0 0 1\n1 2 3 0 0 0", ":2:", "direction is zero"),
        ("\n1 2 3 0 0", ":2:", "5 numbers; six"),
        ("1 2 3 0 0 1 7", ":1:", "7 numbers; six"),
        ("1 2 nan 0 0 1", ":1:", '"nan" is found where a finite number is expected'),
        ("1 2 3 0 0 1e999", ":1:", '"1e999" is found where a finite'),
        ("x y z dx dy dz", ":1:", '"x" is found where a finite number is expected'),
        ("# nothing\n\n", ":", "no sensors"),
        ("", ":", "no sensors"),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(tmp_path, text, place, message):
    file = tmp_path / "bad.pts"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_sensors(file)
    assert str(caught.value).startswith(f"{file}{place}")
    assert message in str(caught.value)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_sensors(tmp_path / "absent.pts")


@pytest.mark.parametrize(
    ("position", "direction", "names"),
    [
        (np.zeros((2, 3)), np.ones((1, 3)), None),
        (np.zeros(3), np.ones(3), None),
        (np.full((1, 3), np.nan), np.ones((1, 3)), None),
        (np.zeros((1, 3)), np.zeros((1, 3)), None),
        (np.zeros((1, 3)), np.ones((1, 3)), ("a", "b")),
    ],
)
def test_arrays_that_do_not_fit_are_refused(position, direction, names):
    with pytest.raises(InputError):
        Sensors(position, direction, names)
