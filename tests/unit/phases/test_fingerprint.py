"""Fingerprints differ when, and only when, something that matters differs."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from clerestory.directions import Frame
from clerestory.hemisphere.klems import klems
from clerestory.phases.fingerprint import fingerprint
from clerestory.scene.model import Plastic, Polygon, Scene, Source
from clerestory.scene.window import Window

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def room(**change):
    given = {"reflectance": np.full(3, 0.5), "vertices": SQUARE, "line": 1} | change
    grey = Plastic(
        "grey", given["reflectance"], source=Source("room.rad", given["line"])
    )
    floor = Polygon(given["vertices"], "grey", "floor", Source("a.rad", given["line"]))
    return Scene({"grey": grey}, (floor,))


def window(up=(0.0, 1.0, 0.0), basis="full"):
    frame = Frame.from_normal_up(np.array([0.0, 0, 1]), np.array(up))
    return Window("south", (Polygon(SQUARE, "glow"),), frame, klems(basis))


def test_moving_a_line_in_a_file_changes_nothing():
    assert fingerprint(room(line=1)) == fingerprint(room(line=99))


@pytest.mark.parametrize(
    "other",
    [
        room(reflectance=np.array([0.5, 0.5, 0.5000001])),
        room(vertices=SQUARE + 1e-9),
        room(vertices=SQUARE[::-1].copy()),
        replace(room(), materials=room().materials | {"x": Plastic("x", np.ones(3))}),
        replace(room(), surfaces=()),
    ],
)
def test_another_scene_has_another_fingerprint(other):
    assert fingerprint(room()) != fingerprint(other)


@pytest.mark.parametrize("other", [window(up=(1.0, 0.0, 0.0)), window(basis="half")])
def test_another_window_has_another_fingerprint(other):
    assert fingerprint(window()) != fingerprint(other)


def test_values_of_different_kinds_do_not_collide():
    values = [0, 0.0, False, None, "", b"", (), {}, "0", (0,), ((),), np.zeros(1)]
    values += [np.zeros(1, np.float32), np.zeros((1, 1)), np.zeros(1, int), {"0": 0}]
    values += [("ab", "c"), ("a", "bc"), ("abc",), {"a": 1}, ("a", 1)]
    assert len({fingerprint(value) for value in values}) == len(values)


def test_mappings_are_compared_whatever_their_order():
    assert fingerprint({"a": 1, "b": 2}) == fingerprint({"b": 2, "a": 1})


def test_numbers_of_numpy_equal_those_of_python():
    assert fingerprint(np.float64(0.5), np.int32(3)) == fingerprint(0.5, 3)
    assert fingerprint(-0.0) == fingerprint(0.0)


def test_arrays_are_compared_by_content_not_by_memory():
    table = np.arange(12.0).reshape(3, 4)
    assert fingerprint(table) == fingerprint(np.asfortranarray(table))
    assert fingerprint(table[:, ::2]) == fingerprint(table[:, ::2].copy())


def test_records_of_different_classes_differ():
    @dataclass(frozen=True)
    class Cup:
        radius: float

    @dataclass(frozen=True)
    class Tube:
        radius: float

    assert fingerprint(Cup(1.0)) != fingerprint(Tube(1.0))


@pytest.mark.parametrize("value", [object(), {1, 2}, np.array([None]), Scene])
def test_what_cannot_be_distinguished_is_refused(value):
    with pytest.raises(TypeError, match="fingerprint"):
        fingerprint(value)
