"""Requests for traces that make no sense are refused before the device starts."""

import numpy as np
import pytest
from physics_scenes import box, sensor

import clerestory as cl
from clerestory.engine.controller import Growth
from clerestory.engine.matrix_jobs import ViewJob
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.scene.sensors import Sensors

SENSOR = sensor((2, 2, 1), (0, 0, 1))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"samples": 10, "relative_error": 0.1}, "both samples and relative_error"),
        ({"samples": 0}, "samples is 0"),
        ({"samples": 1 << 40}, "samples is "),
        ({"relative_error": 0.0}, "relative_error is 0"),
        ({"relative_error": 2.0}, "relative_error is 2"),
        ({"relative_error": float("nan")}, "relative_error is nan"),
        ({"bounces": -1}, "bounces is -1"),
        ({"bounces": 0}, "1 or more"),
        ({"seed": -1}, "seed is -1"),
        ({"device": "gpu"}, "one of auto, cpu, cuda"),
    ],
)
def test_options_out_of_range_are_refused(options, message):
    """One line with what was wrong and what is expected."""
    scene, south = box(4, 5, 3, 0.5)
    with pytest.raises(InputError, match=message):
        cl.view_matrix(scene, south, sensors=SENSOR, **options)


def test_no_sensors_and_no_windows_are_refused():
    """Empty requests are mistakes."""
    scene, south = box(4, 5, 3, 0.5)
    nothing = Sensors(np.zeros((0, 3)), np.zeros((0, 3)))
    with pytest.raises(InputError, match="at least one"):
        cl.view_matrix(scene, south, sensors=nothing)
    with pytest.raises(InputError, match="at least one"):
        cl.view_matrices(scene, [], sensors=SENSOR)


def test_windows_of_one_name_are_refused():
    """Results are found by name."""
    scene, south = box(4, 5, 3, 0.5)
    with pytest.raises(InputError, match="'south'"):
        cl.daylight_matrices(scene, [south, south])


def test_an_error_out_of_reach_is_reported(monkeypatch):
    """The trace ends at its longest batch and says what it did not reach."""
    monkeypatch.setattr(ViewJob, "growth", Growth(pilot=32, longest=64, most=32))
    scene, south = box(4, 5, 3, 0.5)
    with pytest.warns(ClerestoryWarning, match=r"0\.001 was not reached"):
        cl.view_matrix(scene, south, sensors=SENSOR, relative_error=0.001)


def test_progress_grows_to_its_end():
    """Shares never fall, and end at one."""
    scene, south = box(4, 5, 3, 0.5)
    fractions = []
    cl.view_matrix(
        scene,
        south,
        sensors=SENSOR,
        relative_error=0.005,
        progress=lambda share, note: fractions.append(share),
    )
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1)


def test_a_dark_sensor_ends_its_trace():
    """A sensor that no light reaches reads zero, with no error, in finite time."""
    scene, south = box(4, 5, 3, 0.0)
    away = sensor((2, 2, 1), (0, 1, 0))
    matrix = cl.view_matrix(scene, south, sensors=away, relative_error=0.01)
    assert matrix.values.max() == 0
    assert matrix.standard_error.max() == 0
