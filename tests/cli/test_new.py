"""`clerestory new`: from a room's files to a study that runs."""

import tomllib

import numpy as np
import pytest

from clerestory.radiance.view_text import read_view
from clerestory.radiance.window_reader import read_windows
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.new_study import write_demo

COMMAND = (
    "new office --scene materials.rad room.rad --window window.rad"
    " --bsdf venetian_blind.xml --weather 723170TYA.CSV --spacing 1"
)


@pytest.fixture
def demo(call, tmp_path, monkeypatch):
    """The files of the demo, without its study."""
    folder = tmp_path / "demo"
    write_demo(folder)
    (folder / "study.toml").unlink()
    monkeypatch.chdir(folder)
    return folder


def test_a_study_is_begun_that_can_be_read(call, demo):
    """6.1 × 9.1 m hold 6 × 9 sensors of a metre, but for those within screens."""
    outcome = call(*COMMAND.split())
    assert outcome.status == 0, outcome.err
    study = read_study(demo / "office" / "study.toml")
    assert study.title == "office"
    assert [table.file.resolve() for table in study.window] == [
        (demo / "window.rad").resolve()
    ]
    rows = (demo / "office" / "workplane.pts").read_text().splitlines()
    assert 45 <= len(rows) <= 54
    assert all(row.endswith("0.76 0 0 1") for row in rows)
    assert "next: clerestory run" in outcome.out


def test_a_model_in_feet_gets_a_grid_in_feet(call, demo):
    """The grid is 0.76 m above the floor and a metre wide: 2.493 and 3.281 feet."""
    for name in ("room.rad", "window.rad"):
        (demo / name).rename(demo / f"m_{name}")
        (demo / name).write_text(f"!xform -s {1 / 0.3048!r} m_{name}\n")
    outcome = call(*COMMAND.split(), "--units", "feet")
    assert outcome.status == 0, outcome.err
    assert outcome.err == ""
    study = read_study(demo / "office" / "study.toml")
    assert study.scene.units == "feet"
    rows = np.loadtxt(demo / "office" / "workplane.pts")
    assert 45 <= len(rows) <= 54
    np.testing.assert_allclose(rows[:, 2], 0.76 / 0.3048, rtol=1e-3)
    step = np.diff(np.unique(rows[:, 0].round(2)))
    np.testing.assert_allclose(step.min(), 1 / 0.3048, rtol=1e-2)


def test_a_window_that_turns_its_back_is_turned_round(call, demo):
    text = (demo / "window.rad").read_text()
    lines = text.rstrip().splitlines()
    corners = lines[-4:]
    (demo / "window.rad").write_text("\n".join(lines[:-4] + corners[::-1]) + "\n")
    outcome = call(*COMMAND.split())
    assert outcome.status == 0, outcome.err
    assert 'window "window_glow" reversed' in outcome.out
    (turned,) = read_windows(demo / "office" / "window.rad")
    assert turned.frame.normal.tolist() == pytest.approx([0, 1, 0])
    assert turned.frame.up.tolist() == pytest.approx([0, 0, 1])
    table = tomllib.loads((demo / "office" / "study.toml").read_text())
    assert table["window"][0]["file"] == "window.rad"


def test_several_windows_get_a_table_each_and_own_sensors_are_kept(call, demo):
    (demo / "other.rad").write_text((demo / "window.rad").read_text())
    words = COMMAND.replace("window.rad", "window.rad other.rad").split()
    assert call(*words, "--sensors", "desks.pts").status == 0
    table = tomllib.loads((demo / "office" / "study.toml").read_text())
    assert [w["file"] for w in table["window"]] == ["../window.rad", "../other.rad"]
    assert table["sensors"] == [{"file": "../desks.pts"}]


def test_a_study_that_is_there_stays(call, demo):
    assert call(*COMMAND.split()).status == 0
    before = (demo / "office" / "study.toml").read_bytes()
    outcome = call(*COMMAND.split())
    assert outcome.status == 2
    assert "a new folder expected" in outcome.err
    assert (demo / "office" / "study.toml").read_bytes() == before


def test_a_file_that_is_not_there_leaves_no_folder(call, demo):
    for name in ("room.rad", "723170TYA.CSV"):
        outcome = call(*COMMAND.replace(name, "missing").split())
        assert outcome.status == 2
        assert "missing: cannot be read" in outcome.err
        assert not (demo / "office").exists()


def test_names_with_quotes_are_kept(call, demo):
    (demo / "window.rad").rename(demo / 'the "south".rad')
    words = COMMAND.replace("window.rad", "W").split()
    words[words.index("W")] = 'the "south".rad'
    assert call(*words).status == 0
    study = read_study(demo / "office" / "study.toml")
    assert study.window[0].file.name == 'the "south".rad'


def test_glazing_that_was_left_in_the_room_is_doubted(call, demo):
    pane = (demo / "window.rad").read_text().replace("window_glow polygon", "polygon")
    corners = pane.split("polygon", 1)[1]
    glass = "void glass clear 0 0 3 .8 .8 .8\nclear polygon" + corners
    (demo / "glazing.rad").write_text(glass)
    words = COMMAND.replace("room.rad", "room.rad glazing.rad").split()
    outcome = call(*words)
    assert outcome.status == 0, outcome.err
    assert 'window "window_glow" is covered by the surface' in outcome.err


def test_views_are_proposed_and_a_glazing_is_suggested(call, demo):
    words = COMMAND.replace(" --bsdf venetian_blind.xml", " --views").split()
    outcome = call(*words)
    assert outcome.status == 0, outcome.err
    assert "no --bsdf: windows of library:double-lowe-6;" in outcome.out
    assert ", 2 views" in outcome.out
    study = read_study(demo / "office" / "study.toml")
    assert str(study.window[0].bsdf) == "library:double-lowe-6"
    views = [read_view(table.file) for table in study.view]
    assert [view.position[2] for view in views] == pytest.approx([1.2, 1.2])
    assert views[1].direction == pytest.approx([0, -1, 0])


def test_an_unknown_product_is_an_error_at_its_line(call, demo):
    given = COMMAND.replace("venetian_blind.xml", "library:venetian-80-white@45")
    assert call(*given.split()).status == 0
    study = demo / "office" / "study.toml"
    study.write_text(study.read_text().replace("80-white", "80-whit"))
    outcome = call("run", "office/study.toml", "--plan")
    assert outcome.status != 0
    assert "study.toml:" in outcome.err
    assert "one such as venetian-80-white" in outcome.err


def test_a_desk_before_a_partition_is_reported(call, demo):
    """A partition up to 1.7 m, half a metre in front of the eyes."""
    assert call(*COMMAND.split(), "--views").status == 0
    x, y, _ = read_view(demo / "office" / "desk_2.vf").position
    west, east, at = x - 1, x + 1, y - 0.5
    corners = f"{west} {at} 0.1 {east} {at} 0.1 {east} {at} 1.7 {west} {at} 1.7"
    text = f"void plastic felt 0 0 5 .5 .5 .5 0 0\nfelt polygon p 0 0 12 {corners}\n"
    (demo / "partition.rad").write_text(text)
    words = COMMAND.replace("room.rad", "room.rad partition.rad").split()
    words[1] = "other"
    outcome = call(*words, "--views")
    assert outcome.status == 0, outcome.err
    assert "faces a partition or a wall less than 1 m away: 1 of 2 views" in outcome.err


def box(name, west, east):
    """A room of 4 m × 3 m without its south side."""
    quads = {
        "floor": "0 0 0  1 0 0  1 4 0  0 4 0",
        "ceiling": "0 0 3  0 4 3  1 4 3  1 0 3",
        "north": "0 4 0  1 4 0  1 4 3  0 4 3",
        "west": "0 0 0  0 4 0  0 4 3  0 0 3",
        "east": "1 0 0  1 0 3  1 4 3  1 4 0",
    }
    lines = []
    for side, text in quads.items():
        points = np.array(text.split(), float).reshape(-1, 3)
        points[:, 0] = west + points[:, 0] * (east - west)
        numbers = " ".join(f"{x:g}" for x in points.ravel())
        lines.append(f"grey polygon {name}_{side} 0 0 12 {numbers}\n")
    return "".join(lines)


def pane(name, corners):
    return f"clear polygon {name} 0 0 12 {corners}\n"


@pytest.fixture
def export(demo):
    """Two rooms in a file with their panes, one of which faces outdoors."""
    grey = "void plastic grey 0 0 5 .5 .5 .5 0 0\nvoid glass clear 0 0 3 .9 .9 .9\n"
    (demo / "materials.rad").write_text(grey)
    rooms = box("a", 0, 5) + box("b", 5.2, 8)
    panes = pane("p", "0 0 0  0 0 3  5 0 3  5 0 0")
    panes += pane("q", "5.2 0 0  8 0 0  8 0 3  5.2 0 3")
    (demo / "rooms.rad").write_text(rooms)
    (demo / "panes.rad").write_text(panes)
    (demo / "export.rad").write_text(rooms + panes)
    return demo


EXPORT = "new office --weather 723170TYA.CSV --spacing 1 --scene materials.rad"


@pytest.mark.parametrize(
    "words", ["export.rad --glazing clear", "rooms.rad --window panes.rad"]
)
def test_panes_of_two_rooms_are_two_windows_with_grids(call, export, words):
    """Rooms of 5 × 4 m and 2.8 × 4 m: 20 and 8 or 12 sensors of a metre."""
    outcome = call(*EXPORT.split(), *words.split())
    assert outcome.status == 0, outcome.err
    assert outcome.err == ""
    assert "in 2 rooms, 2 windows" in outcome.out
    study = read_study(export / "office" / "study.toml")
    inputs = read_inputs(study)
    assert [len(surface.vertices) for surface in inputs.scene.surfaces] == [4] * 10
    assert [group.name for group in inputs.groups] == ["panes_1", "panes_2"]
    for group, east in zip(inputs.groups, (2.5, 6.6), strict=True):
        corners = group.inner.polygons[0].vertices
        assert corners.mean(axis=0).tolist() == pytest.approx([east, 0, 1.5])
        assert group.inner.frame.normal.tolist() == pytest.approx([0, 1, 0])
    grids = [grid.position[:, 0] for grid in inputs.grids.values()]
    assert len(grids[0]) == 20
    assert grids[0].max() < 5 < 5.2 < grids[1].min()


# Faces of a pane 0.02 m thick, fronts outwards; the room is towards +y
SOLID = (
    "0 0 0  5 0 0  5 0 3  0 0 3",
    "0 .02 0  0 .02 3  5 .02 3  5 .02 0",
    "0 0 0  0 0 3  0 .02 3  0 .02 0",
    "5 0 0  5 .02 0  5 .02 3  5 0 3",
    "0 0 0  0 .02 0  5 .02 0  5 0 0",
    "0 0 3  5 0 3  5 .02 3  0 .02 3",
)


@pytest.mark.parametrize("faces", [SOLID, SOLID[:2], SOLID[1::-1]])
@pytest.mark.parametrize(
    "words", ["export.rad --glazing clear", "a.rad --window p.rad"]
)
def test_of_a_pane_with_several_faces_the_inner_one_is_the_window(
    call, export, faces, words
):
    text = "".join(pane(f"p{k}", corners) for k, corners in enumerate(faces))
    (export / "export.rad").write_text(box("a", 0, 5) + text)
    (export / "a.rad").write_text(box("a", 0, 5))
    (export / "p.rad").write_text(text)
    outcome = call(*EXPORT.split(), *words.split())
    assert outcome.status == 0, outcome.err
    assert outcome.err == ""
    assert f"is the window; {len(faces) - 1} other face" in outcome.out
    assert "reversed" not in outcome.out
    (group,) = read_inputs(read_study(export / "office" / "study.toml")).groups
    (polygon,) = group.inner.polygons
    assert sorted(polygon.vertices[:, 1]) == [0.02] * 4
    assert group.inner.frame.normal.tolist() == pytest.approx([0, 1, 0])


def test_a_file_of_outer_panes_alone_gives_no_window(call, export):
    """Double glazing whose panes are in two files, the outer pane first."""
    (export / "a.rad").write_text(box("a", 0, 5))
    for name, face in (("outer", SOLID[0]), ("inner", SOLID[1])):
        (export / f"{name}.rad").write_text(pane("p", face))
    words = "a.rad --window outer.rad inner.rad"
    outcome = call(*EXPORT.split(), *words.split())
    assert outcome.status == 0, outcome.err
    (table,) = read_study(export / "office" / "study.toml").window
    assert table.file.name == "inner.rad"


def test_panes_of_two_orientations_are_two_windows(call, export):
    east = pane("r", "5 1 1  5 3 1  5 3 2  5 1 2")
    room = box("a", 0, 5).replace("5 0 3 5 4 3 5 4 0", "5 0 1 5 4 1 5 4 0")
    room += "grey polygon up 0 0 12 5 0 2 5 0 3 5 4 3 5 4 2\n"
    room += "grey polygon left 0 0 12 5 0 1 5 0 2 5 1 2 5 1 1\n"
    room += "grey polygon right 0 0 12 5 3 1 5 3 2 5 4 2 5 4 1\n"
    south = pane("p", "0 0 0  0 0 3  5 0 3  5 0 0")
    (export / "export.rad").write_text(room + south + east)
    outcome = call(*EXPORT.split(), "export.rad", "--glazing", "clear", "--views")
    assert outcome.status == 0, outcome.err
    assert "20 sensors, 2 windows" in outcome.out
    inputs = read_inputs(read_study(export / "office" / "study.toml"))
    normals = [group.inner.frame.normal.tolist() for group in inputs.groups]
    assert normals == [pytest.approx([0, 1, 0]), pytest.approx([-1, 0, 0])]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("--glazing glass", 'made of the glazing "glass"; one of clear, grey expected'),
        ("", "neither window files nor materials of the glazing; one of them expected"),
        ("--glazing clear --window panes.rad", "both window files and materials"),
    ],
)
def test_glazing_that_is_not_there_is_an_error(call, export, words, expected):
    outcome = call(*EXPORT.split(), "export.rad", *words.split())
    assert outcome.status == 2
    assert expected in outcome.err
    assert not (export / "office").exists()
