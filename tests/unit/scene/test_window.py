"""Window files give frames, bases and groups as for rfluxmtx."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.radiance.window_reader import read_window, read_windows

PANE = "polygon pane 0 0 12 0 0 1  0 0 2  3 0 2  3 0 1\n"  # faces +y, 3 m²
SKYLIGHT = "polygon sky 0 0 12 0 0 3  0 1 3  1 1 3  1 0 3\n"  # faces down


@pytest.fixture
def write(tmp_path):
    def write_file(text, name="window.rad"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return write_file


def test_the_front_faces_the_room(write):
    window = read_window(
        write("void glow g 0 0 4 1 1 1 0\n#@rfluxmtx h=kf u=Z\ng " + PANE)
    )
    assert window.name == "g"
    assert window.area == pytest.approx(3)
    assert window.frame.normal.tolist() == [0, 1, 0]
    assert window.frame.up.tolist() == [0, 0, 1]
    assert window.frame.right.tolist() == [-1, 0, 0]
    assert len(window.partition) == 145


def test_the_tutorials_window_faces_north_into_the_room(shared_data):
    window = read_window(shared_data / "tutorial_room/objects/GlazingVmtx.rad")
    assert window.frame.normal.tolist() == [0, 1, 0]
    assert window.area == pytest.approx(6.096 * (2.4384 - 0.904875))


@pytest.mark.parametrize(
    ("variables", "patches", "up"),
    [
        ("h=kf u=Z", 145, [0, 0, 1]),
        ("u=+z h=+kh", 77, [0, 0, 1]),
        ("h=kq u=-Z", 41, [0, 0, -1]),
        ("h=k u=X", 145, [1, 0, 0]),
        ("u=-1,0,0", 145, [-1, 0, 0]),
        ("u=0,5,1 o=view.mtx", 145, [0, 0, 1]),
        ("", 145, [0, 0, 1]),
    ],
)
def test_variables_give_basis_and_up(write, variables, patches, up):
    window = read_window(write(f"#@rfluxmtx {variables}\nvoid {PANE}"))
    assert len(window.partition) == patches
    np.testing.assert_allclose(window.frame.up, up, atol=1e-12)


def test_up_is_north_where_the_window_lies_flat(write):
    window = read_window(write("void " + SKYLIGHT))
    assert window.frame.normal.tolist() == [0, 0, -1]
    assert window.frame.up.tolist() == [0, 1, 0]
    assert window.name == "window"


def test_materials_do_not_matter(write):
    text = "void BSDF b 6 0 blind.xml 0 0 1 . 0 0\nunknown " + PANE
    assert read_window(write(text)).name == "unknown"


def test_groups_are_distinguished_by_modifier(write):
    text = f"#@rfluxmtx h=kf u=Z\nsouth {PANE}#@rfluxmtx h=kh u=Y\nroof {SKYLIGHT}"
    other = "south polygon upper 0 0 12 0 0 3  0 0 4  3 0 4  3 0 3"
    south, roof = read_windows(write(text), write(other, "more.rad"))
    assert (south.name, roof.name) == ("south", "roof")
    assert (len(south.polygons), len(roof.polygons)) == (2, 1)
    assert (len(south.partition), len(roof.partition)) == (145, 77)


def test_fports_of_the_tutorial_are_seven_windows(shared_data):
    windows = read_windows(shared_data / "tutorial_room/fports/FN.rad")
    assert [w.name for w in windows] == ["FN" + c for c in "abcdefg"]
    assert windows[-1].frame.up.tolist() == [0, 1, 0]


def test_windows_may_be_moved_by_xform(write):
    write("#@rfluxmtx h=kq u=Z\ng " + PANE)
    window = read_window(write("!xform -rz 90 -s 2 window.rad", "moved.rad"))
    np.testing.assert_allclose(window.frame.normal, [-1, 0, 0], atol=1e-12)
    assert window.area == pytest.approx(12)
    assert len(window.partition) == 41


def test_holes_do_not_count_as_area(write):
    rim = "0 0 0  0 0 4  4 0 4  4 0 0  0 0 0"
    hole = "1 0 1  1 0 3  3 0 3  3 0 1  1 0 1"
    window = read_window(write(f"void polygon frame 0 0 30 {rim} {hole}"))
    assert window.area == pytest.approx(12)


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (f"a {PANE}a {SKYLIGHT}", 2, "differs by 71.57° from"),
        (f"#@rfluxmtx h=-kf\nvoid {PANE}", 1, "left-handed"),
        (f"\n#@rfluxmtx h=r4\nvoid {PANE}", 2, "not a basis of windows"),
        (f"#@rfluxmtx u=W\nvoid {PANE}", 1, "u=W is not a direction"),
        (f"#@rfluxmtx u=0,0,0\nvoid {PANE}", 1, "is not a direction"),
        (f"#@rfluxmtx q=1\nvoid {PANE}", 1, "unknown variable"),
        (f"#@rfluxmtx u=Y\nvoid {PANE}", 2, "parallel to the normal"),
        ("void ring r 0 0 8 0 0 0 0 0 1 0 1", 1, "surfaces of type ring"),
        ("void polygon p 0 0 9 1 2 3", 1, "ends"),
        ("# nothing", None, "no polygons"),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(write, text, line, message):
    file = write(text)
    with pytest.raises(InputError) as caught:
        read_window(file)
    place = f"{file}:" if line is None else f"{file}:{line}:"
    assert str(caught.value).startswith(place)
    assert message in str(caught.value)
