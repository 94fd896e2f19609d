"""View out of EN 17037 against closed forms: rooms with one or two openings."""

import numpy as np
import pytest

from clerestory.metrics.view_out import (
    GROUND,
    LANDSCAPE,
    SKY,
    Opening,
    layer_level,
    room_level,
    view_out,
)

# Openings in the plane y = 0; the room is at y > 0
INWARDS = np.array([0.0, 1.0, 0.0])
EYE = np.array([[0.0, 3.0, 1.2]])


def opening(left, right, low=0.8, high=2.2, y=0.0):
    corners = [[left, y, low], [right, y, low], [right, y, high], [left, y, high]]
    return Opening(np.array(corners), INWARDS)


def walls(*rectangles):
    """Rays against vertical rectangles (y, left, right, low, high), nearest first."""

    def cast(origins, directions):
        reach = np.full(len(origins), np.inf)
        normal = np.tile([0.0, 1.0, 0.0], (len(origins), 1))
        for y, left, right, low, high in rectangles:
            with np.errstate(divide="ignore", invalid="ignore"):
                t = (y - origins[:, 1]) / directions[:, 1]
            at = origins + np.where(t > 0, t, 0)[:, None] * directions
            met = (t > 0) & (at[:, 0] >= left) & (at[:, 0] <= right)
            met &= (at[:, 2] >= low) & (at[:, 2] <= high)
            reach = np.where(met & (t < reach), t, reach)
        return reach, normal

    return cast


OPEN = walls()


def angle(left, right, away=3.0):
    return np.degrees(np.arctan(right / away) - np.arctan(left / away))


@pytest.mark.parametrize(("left", "right"), [(-1, 1), (0.5, 2), (-4, -3), (2, 9)])
def test_the_width_is_the_angle_between_the_jambs(left, right):
    found = view_out(EYE, [opening(left, right)], OPEN)
    assert found.width_deg[0] == pytest.approx(angle(left, right), rel=1e-9)


@pytest.mark.parametrize("turn", range(0, 360, 30))
def test_the_width_does_not_depend_on_the_orientation(turn):
    """The interval of azimuths may include the direction where azimuth is ±180°."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    spin = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    one = opening(-1, 2)
    turned = Opening(one.corners @ spin, one.normal @ spin)
    found = view_out(EYE @ spin, [turned], OPEN)
    assert found.width_deg[0] == pytest.approx(angle(-1, 2), rel=1e-9)


def test_widths_of_openings_add_up_unless_one_is_above_the_other():
    beside = view_out(EYE, [opening(-2, -1), opening(1, 3)], OPEN)
    assert beside.width_deg[0] == pytest.approx(angle(-2, -1) + angle(1, 3), rel=1e-9)
    above = view_out(EYE, [opening(-1, 1), opening(-2, 0.5, 2.3, 3)], OPEN)
    assert above.width_deg[0] == pytest.approx(angle(-2, 1), rel=1e-9)


def test_a_partition_in_the_room_hides_its_part_of_the_width():
    """A wall at half the distance hides the columns with x below 0."""
    found = view_out(EYE, [opening(-1, 1)], walls((1.5, -5, 0, 0, 3)))
    assert found.width_deg[0] == pytest.approx(angle(0, 1), rel=1e-9)


def test_nothing_is_seen_from_behind_through_a_roof_or_without_openings():
    behind = np.array([[0.0, -1.0, 1.2]])
    roof = Opening(opening(-1, 1).corners[:, [0, 2, 1]], np.array([0, 0, -1.0]))
    for eyes, openings in ((behind, [opening(-1, 1)]), (EYE, [roof]), (EYE, [])):
        found = view_out(eyes, openings, OPEN)
        assert found.width_deg[0] == 0
        assert found.distance[0] == 0
        assert found.layers[0] == 0
        assert found.levels()[0] == 0


@pytest.mark.parametrize(("away", "level"), [(5.9, 0), (6, 1), (20, 2), (60, 3)])
def test_the_distance_is_that_of_a_parallel_wall(away, level):
    facing = walls((-away, -900, 900, -10, 40))
    found = view_out(EYE, [opening(-1, 1)], facing)
    assert found.distance[0] == pytest.approx(away, rel=1e-12)
    assert found.criteria()[1, 0] == level


@pytest.mark.parametrize(("covered", "expected"), [(0.45, np.inf), (0.55, 10.0)])
def test_the_distance_is_seen_in_half_of_the_width(covered, expected):
    """A wall 10 m away covers a share of the angle, from the left jamb on."""
    left = np.arctan(-1 / 3)
    edge = np.tan(left + covered * -2 * left)
    wall = walls((-10.0, -900, 13 * edge, -10, 90))
    found = view_out(EYE, [opening(-1, 1)], wall)
    assert found.distance[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("height", [1.0, 3.0, 4.8, 5.3, 8.0])
def test_sky_is_seen_above_a_building_that_is_lower_than_the_head(height):
    """Head at 2.2 m in 3 m: the ray over it is 5.2 m high at 12 m from the eye.

    The eye in the middle of a row sees 1.5 % less than the whole height. A building
    below the eye leaves the horizon free.
    """
    found = view_out(EYE, [opening(-1, 1)], walls((-9.0, -900, 900, -9, height)))
    assert bool(found.layers[0] & SKY) == (height < 1.2 + 12 * 1.0 / 3)
    assert found.layers[0] & LANDSCAPE
    assert found.distance[0] == pytest.approx(np.inf if height < 1.2 else 9.0)


@pytest.mark.parametrize(("low", "seen"), [(0.8, True), (1.15, False), (1.3, False)])
def test_ground_is_seen_before_a_building_if_the_sill_is_low(low, seen):
    """Ground at z = 0; the ray over a sill of 0.8 m reaches it 9 m from the eye."""
    found = view_out(EYE, [opening(-1, 1, low)], walls((-9.0, -900, 900, 0, 40)))
    assert bool(found.layers[0] & GROUND) == seen


def test_an_open_horizon_is_landscape_but_a_view_of_the_sky_alone_is_none():
    all_layers = view_out(EYE, [opening(-1, 1)], OPEN)
    assert all_layers.layers[0] == SKY | LANDSCAPE | GROUND
    assert all_layers.distance[0] == np.inf
    high = view_out(EYE, [opening(-1, 1, 2.0, 3.0)], OPEN)
    assert high.layers[0] == SKY
    assert high.levels()[0] == 0


def test_layers_count_in_one_opening():
    """Sky through one opening and landscape through another are not two layers."""
    low, high = opening(-1, -0.5, 1.0, 1.4), opening(0.5, 1.5, 2.5, 3.0)
    sky = view_out(EYE, [high], walls((-9.0, -900, 900, 0, 3)))
    assert sky.layers[0] == SKY
    both = view_out(EYE, [low, high], walls((-9.0, -900, 0, 0, 40)))
    assert both.layers[0] == LANDSCAPE
    assert layer_level(both.layers)[0] == 1


def test_the_facade_beside_the_opening_is_no_landscape():
    """A screen 0.3 m in front of the opening hides everything."""
    found = view_out(EYE, [opening(-1, 1)], walls((-0.3, -9, 9, -9, 9)))
    assert found.width_deg[0] == 0


def test_three_quarters_of_the_area_must_reach_a_level():
    levels = np.array([3, 2, 1, 0])
    assert room_level(levels) == 1
    assert room_level(levels, np.array([75.0, 24, 1, 0])) == 3
