"""Positions of view grids, and the answers to wrong ones."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs


@pytest.fixture
def with_grid(study_file):
    """Read the view grids of the study with more tables at its end."""

    def read(*tables):
        text = study_file.read_text()
        study_file.write_text("\n".join([text, *tables]))
        return read_inputs(read_study(study_file)).view_grids

    return read


def complaint(with_grid, *tables):
    with pytest.raises(InputError) as caught:
        with_grid(*tables)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_list_of_desks_gives_the_eyes_themselves(with_grid):
    (grid,) = with_grid(
        '[[view_grid]]\nname = "desks"\nplaces = [[1, 2.5, 1.2], [3, 4, 1.6]]'
    )
    assert grid.position.tolist() == [[1, 2.5, 1.2], [3, 4, 1.6]]
    assert grid.azimuths_deg.tolist() == [0, 45, 90, 135, 180, 225, 270, 315]
    east = grid.views(1)[2]
    assert east.direction == pytest.approx([1, 0, 0])
    assert east.position.tolist() == [3, 4, 1.6]


def test_eye_heights_are_above_the_floor_below_the_sensors(with_grid):
    """The desk at 0.7 m is below two of the three sensors of the grid "eye"."""
    (grid,) = with_grid(
        '[[view_grid]]\nname = "all"\ngrid = "desk"\neye_heights = [1.2, 1.7]\n'
        "directions = 4\nfirst_azimuth_deg = 30"
    )
    x, y = grid.position[:, :2].T
    assert x.tolist() == [1.5, 2.5, 2, 1.5, 2.5, 2]
    assert y.tolist() == [1.5, 1.5, 4, 1.5, 1.5, 4]
    assert grid.position[:, 2] == pytest.approx([1.2] * 3 + [1.7] * 3)
    assert grid.azimuths_deg.tolist() == [30, 120, 210, 300]


def test_a_file_may_have_directions_or_none(with_grid, study_file):
    study_file.with_name("seats.pts").write_text("1 2.5 1.2\n3, 4, 1.2 0 -1 0 # west\n")
    (grid,) = with_grid('[[view_grid]]\nname = "seats"\nfile = "seats.pts"')
    assert grid.position.tolist() == [[1, 2.5, 1.2], [3, 4, 1.2]]


def test_spacing_fills_the_floor_behind_the_window(with_grid):
    """Four by five metres at a spacing of one metre."""
    (grid,) = with_grid('[[view_grid]]\nname = "floor"\nspacing = 1.0')
    assert len(grid) == 20
    assert np.ptp(grid.position, axis=0) == pytest.approx([3, 4, 0])
    assert grid.position[:, 2] == pytest.approx(np.full(20, 1.2))


def test_spacing_fills_a_given_floor(with_grid):
    (grid,) = with_grid(
        '[[view_grid]]\nname = "zone"\nspacing = 0.5\n'
        "floor = [[1, 3, 0], [3, 3, 0], [3, 4, 0], [2, 4, 0], [2, 5, 0], [1, 5, 0]]"
    )
    assert len(grid) == 4 * 2 + 2 * 2
    assert grid.position[:, :2].max(axis=0) == pytest.approx([2.75, 4.75])


def test_places_on_the_floor_have_eyes_above_it(with_grid):
    text = '[[view_grid]]\nname = "a"\nplaces = [[1, 2.5, 0], [3, 4, 0]]'
    (grid,) = with_grid(f"{text}\neye_heights = [1.2]")
    assert grid.position.tolist() == [[1, 2.5, 1.2], [3, 4, 1.2]]


def test_lengths_of_places_are_in_the_unit_of_the_scene(with_grid, study_file):
    text = study_file.read_text().replace(
        'files = ["room.rad"]', 'files = ["room.rad"]\nunits = "feet"'
    )
    study_file.write_text(text)
    (grid,) = with_grid('[[view_grid]]\nname = "a"\nplaces = [[1, 2.5, 1.2]]')
    assert grid.position[0] == pytest.approx(0.3048 * np.array([1, 2.5, 1.2]))


WRONG = {
    "no name": ("places = [[1, 2, 1.2]]", "name"),
    "no positions": ('name = "a"', 'no positions; one of "grid", "file", "places"'),
    "two sources": (
        'name = "a"\ngrid = "desk"\nspacing = 1.0',
        '"grid" and "spacing"; one of',
    ),
    "unknown grid": (
        'name = "a"\ngrid = "dusk"',
        'view grid "a" refers to grid "dusk"; one of desk, eye expected',
    ),
    "directions that do not divide the circle": (
        'name = "a"\ngrid = "desk"\ndirections = 7',
        "directions is 7; a divisor of 360, such as 4, 8 or 12 expected",
    ),
    "floor without spacing": (
        'name = "a"\ngrid = "desk"\nfloor = [[0,0,0],[1,0,0],[1,1,0]]',
        '"floor" without "spacing"',
    ),
    "floor of two corners": (
        'name = "a"\nspacing = 1.0\nfloor = [[0,0,0],[1,0,0]]',
        '"floor" has 2 corners; three or more expected',
    ),
    "sloping floor": (
        'name = "a"\nspacing = 1.0\nfloor = [[0,0,0],[1,0,0],[1,1,1]]',
        "differ in height by 1 m; the same height expected",
    ),
    "a height twice": (
        'name = "a"\ngrid = "desk"\neye_heights = [1.2, 1.2]',
        "a height twice",
    ),
    "too many positions": (
        'name = "a"\nspacing = 0.001\nfloor = [[0,0,0],[4,0,0],[4,5,0],[0,5,0]]',
        '[[view_grid]] "a": 20,000,000 positions at a spacing of 0.001 m; at most'
        " 10,000 expected",
    ),
    "outside the scene": (
        'name = "a"\nplaces = [[1, 2, 1.2], [1, 200, 1.2]]',
        '[[view_grid]] "a": position 2 (1 200 1.2) is outside the bounding box of the'
        " scene; positions in the room expected",
    ),
    "outdoors": (
        'name = "a"\nplaces = [[1, -5, 1.2], [2, -6, 1.2]]',
        "2 positions are behind all windows: 1 (1 -5 1.2), 2 (2 -6 1.2); positions in"
        " front of a window expected",
    ),
    "in a table": (
        'name = "a"\nplaces = [[2, 1.5, 0.7]]',
        "position 1 (2 1.5 0.7) is on a surface; positions in free space expected",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_view_grids_are_answered_in_one_line(with_grid, name):
    keys, words = WRONG[name]
    assert words in complaint(with_grid, f"[[view_grid]]\n{keys}")


def test_an_eye_in_furniture_is_an_error(with_grid, study_file):
    box = "!genbox grey cupboard 0.4 0.4 2 | xform -t 3 4 0\n"
    with study_file.with_name("room.rad").open("a") as room:
        room.write("\n" + box)
    words = complaint(
        with_grid, '[[view_grid]]\nname = "a"\nplaces = [[3.2, 4.2, 1.2]]'
    )
    assert "is enclosed by a wall or furniture" in words


def test_two_view_grids_have_different_names(with_grid):
    table = '[[view_grid]]\nname = "a"\ngrid = "desk"\n'
    assert 'two tables have the name "a"' in complaint(with_grid, table, table)


def test_a_rule_names_a_view_grid_that_exists(with_grid):
    words = complaint(
        with_grid,
        '[[view_grid]]\nname = "a"\ngrid = "desk"',
        '[[window]]\nname = "w"\nfile = "window.rad"\n'
        '[[window.state]]\nbsdf = "diffuser.xml"\n'
        '[window.control]\nrule = "glare"\nview_grids = ["b"]',
    )
    assert 'refers to view grid "b"; one of a expected' in words
