"""A grid over the floor: as many sensors as fit, at their height, nowhere else."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.window_reader import read_window
from clerestory.scene.floor_grid import floor_grid, room_side

FLOOR = "grey polygon floor 0 0 12  0 0 0  6 0 0  6 4 0  0 4 0\n"
CEILING = "grey polygon ceiling 0 0 12  0 0 3  0 4 3  6 4 3  6 0 3\n"
WALLS = """void plastic grey 0 0 5 .5 .5 .5 0 0
grey polygon west 0 0 12  0 0 0  0 4 0  0 4 3  0 0 3
grey polygon east 0 0 12  6 0 0  6 0 3  6 4 3  6 4 0
grey polygon north 0 0 12  0 4 0  6 4 0  6 4 3  0 4 3
grey polygon ground 0 0 12  -50 -50 -.2  50 -50 -.2  50 50 -.2  -50 50 -.2
"""
# The whole south side is a window, whose front faces north, into the room
WINDOW = "void glow pane 0 0 4 1 1 1 0\npane polygon w 0 0 12  {}\n"
INTO = "6 0 0  0 0 0  0 0 3  6 0 3"
OUT = "6 0 3  0 0 3  0 0 0  6 0 0"


@pytest.fixture
def room(tmp_path):
    """Write scene and window, and read them."""

    def make(*more, corners=INTO):
        (tmp_path / "room.rad").write_text(WALLS + "".join(more))
        (tmp_path / "window.rad").write_text(WINDOW.format(corners))
        return read_rad(tmp_path / "room.rad"), read_window(tmp_path / "window.rad")

    return make


def test_a_room_is_filled_evenly_from_wall_to_wall(room):
    """6 × 4 m hold 12 × 8 points every 0.5 m, a quarter metre from the walls."""
    grid = floor_grid(*room(FLOOR, CEILING))
    x, y = np.meshgrid(0.25 + 0.5 * np.arange(12), 0.25 + 0.5 * np.arange(8))
    expected = np.column_stack([x.ravel(), y.ravel(), np.full(96, 0.76)])
    assert np.allclose(grid.position, expected, atol=1e-9)
    assert np.allclose(grid.direction, [0, 0, 1])


@pytest.mark.parametrize("spacing", [0.3, 0.7, 1.2, 1.5, 2.0, 3.0])
def test_any_spacing_finds_the_room(room, spacing):
    """The point in front of the window may be nearer to it than half the spacing."""
    grid = floor_grid(*room(FLOOR, CEILING), spacing=spacing)
    assert len(grid) == (6 / spacing + 1e-9) // 1 * ((4 / spacing + 1e-9) // 1)
    assert (grid.position[:, :2] > 0).all()
    assert (grid.position[:, :2] < (6, 4)).all()


@pytest.mark.parametrize("corners", [INTO, OUT])
def test_the_room_is_found_on_either_side(room, corners):
    scene, window = room(FLOOR, CEILING, corners=corners)
    assert room_side(scene, window) == (1 if corners == INTO else -1)
    assert len(floor_grid(scene, window, spacing=1.0, height=0.9)) == 24


@pytest.mark.parametrize("height", [1, 2])
def test_furniture_above_the_sensors_leaves_none_in_its_place(room, height):
    """A cabinet of one square metre stands on four of them."""
    cabinet = f"!genbox grey cabinet 1 1 {height} | xform -t 2 2 0\n"
    grid = floor_grid(*room(FLOOR, CEILING, cabinet))
    inside = np.all(np.abs(grid.position[:, :2] - 2.5) < 0.5, axis=1)
    assert not inside.any()
    assert len(grid) == 92


def test_a_desk_below_the_sensors_leaves_them(room):
    desk = "!genbox grey desk 2 1 .03 | xform -t 2 2 .7\n"
    assert len(floor_grid(*room(FLOOR, CEILING, desk))) == 96


def test_an_open_room_is_refused(room):
    scene, window = room("")
    bare = type(scene)(
        scene.materials, tuple(s for s in scene.surfaces if s.name != "east")
    )
    with pytest.raises(InputError, match="closed room, its unit"):
        floor_grid(bare, window, spacing=2.0)


def test_a_room_without_a_floor_is_refused(tmp_path, room):
    scene, window = room(CEILING)
    bare = type(scene)(
        scene.materials, tuple(s for s in scene.surfaces if s.name != "ground")
    )
    with pytest.raises(InputError, match="floor expected"):
        floor_grid(bare, window)
