"""Transforms move points as their options say."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.scene.transform import parse_transform

X, Y, Z = np.eye(3)


@pytest.mark.parametrize(
    ("options", "point", "expected"),
    [
        ("-t 1 2 3", X, [2, 2, 3]),
        ("-rx 90", Y, Z),
        ("-ry 90", Z, X),
        ("-rz 90", X, Y),
        ("-s 2.5", X, 2.5 * X),
        ("-mx", X, -X),
        ("-my", Y, -Y),
        ("-mz", Z, -Z),
        ("-rz 90 -t 1 0 0", X, [1, 1, 0]),
        ("-t 1 0 0 -rz 90", X, [0, 2, 0]),
        ("-i 3 -t 1 0 0", X, [4, 0, 0]),
        ("-i 0 -t 1 0 0", X, X),
        ("-i 2 -rz 45 -i 1 -t 0 0 1", X, [0, 1, 1]),
        ("", X, X),
    ],
)
def test_options_move_points(options, point, expected):
    move, taken = parse_transform(options.split())
    assert taken == len(options.split())
    np.testing.assert_allclose(move.points(point), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("options", "scale", "mirrored"),
    [
        ("-s 2 -s 3", 6, False),
        ("-s -2", 2, True),
        ("-mx -mz", 1, False),
        ("-i 3 -s 2 -my", 8, True),
        ("-i 2 -my", 1, False),
    ],
)
def test_scale_and_mirror_are_followed(options, scale, mirrored):
    move, _ = parse_transform(options.split())
    assert (move.scale, move.mirrored) == (scale, mirrored)
    sign = -1 if mirrored else 1
    assert np.linalg.det(move.matrix[:3, :3]) == pytest.approx(sign * scale**3)


def test_options_stop_at_the_first_word_that_is_none():
    assert parse_transform(["-mx", "room.rad", "-my"])[1] == 1
    assert parse_transform(["-q", "1"])[1] == 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("-t 1 2", "3 number"),
        ("-t 1 2 three", "3 number"),
        ("-rz", "1 number"),
        ("-rz nan", "1 number"),
        ("-s inf", "1 number"),
        ("-s 0", "other than 0"),
        ("-t 1e300 0 0 -s 1e300", "more than 1e"),
        ("-i", "count"),
        ("-i 1.5", "count"),
        ("-i 99999 -s 10", "more than 1e"),
        ("-i 99999 -s 0.1", "less than 1e-15"),
    ],
)
def test_bad_options_are_refused(options, message):
    with pytest.raises(InputError, match=message):
        parse_transform(options.split())
