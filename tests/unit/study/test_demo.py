"""The bundled study is whole and its room has the size it should."""

import numpy as np
import pytest

from clerestory.errors import InputError, OutputError
from clerestory.radiance.view_text import format_view, read_view
from clerestory.scene.scaling import scaled
from clerestory.scene.scene_checks import check_scene
from clerestory.scene.sensors import read_sensors
from clerestory.scene.view import View
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.new_study import write_demo
from clerestory.study.study_files import write_sensors


def test_the_demo_study_reads_without_a_doubt(tmp_path):
    study = read_study(write_demo(tmp_path / "demo"))
    inputs = read_inputs(study)
    assert len(inputs.weather) == 8760
    assert [len(grid) for grid in inputs.grids.values()] == [77, 4]
    windows = [group.inner for group in inputs.groups]
    assert check_scene(inputs.scene, windows, inputs.sensors()) == ()


def test_the_demo_room_is_that_of_the_paper(tmp_path):
    """6.1 m x 9.1 m x 2.7 m, with a window of 6.1 m x 1.8 m facing south."""
    inputs = read_inputs(read_study(write_demo(tmp_path)))
    inner = [s for s in inputs.scene.surfaces if s.name in ("floor", "ceiling")]
    corners = np.concatenate([surface.vertices for surface in inner])
    np.testing.assert_allclose(np.ptp(corners, axis=0), [6.1, 9.1, 2.7])
    window = inputs.groups[0].inner
    np.testing.assert_allclose(window.area, 6.1 * 1.8)
    np.testing.assert_allclose(window.frame.normal, [0, 1, 0], atol=1e-12)


def test_the_demo_takes_a_product_of_ones_own(tmp_path):
    write_demo(tmp_path / "first")
    blind = tmp_path / "first" / "venetian_blind.xml"
    blind.rename(tmp_path / 'my "blind".xml')
    study = read_study(write_demo(tmp_path / "a", bsdf=tmp_path / 'my "blind".xml'))
    assert study.title == 'FLEXLAB test room, my "blind"'
    assert study.window[0].bsdf.samefile(tmp_path / 'my "blind".xml')
    named = read_study(write_demo(tmp_path / "b", bsdf="library:double-clear-6"))
    assert str(named.window[0].bsdf) == "library:double-clear-6"
    assert named.title == "FLEXLAB test room, double-clear-6"


@pytest.mark.parametrize(
    ("folder", "bsdf", "words"),
    [("first", "library:double-clear-6", "a study is here"), ("b", "no.xml", "read")],
)
def test_a_product_that_the_demo_cannot_take(tmp_path, folder, bsdf, words):
    write_demo(tmp_path / "first")
    with pytest.raises(InputError, match=words):
        write_demo(tmp_path / folder, bsdf=bsdf)
    assert not (tmp_path / "b").exists()


def test_writing_the_demo_again_keeps_what_was_changed(tmp_path):
    write_demo(tmp_path)
    (tmp_path / "desks.pts").write_text("1 1 0.76 0 0 1\n")
    (tmp_path / "room.rad").unlink()
    write_demo(tmp_path)
    assert (tmp_path / "desks.pts").read_text() == "1 1 0.76 0 0 1\n"
    assert (tmp_path / "room.rad").is_file()


def test_a_demo_where_nothing_can_be_written_is_reported(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        write_demo(tmp_path / "file" / "demo")


FOOT = 0.3048


def in_feet(folder):
    """The demo with all coordinates in feet."""
    study = write_demo(folder)
    for name in ("room.rad", "window.rad"):
        text = (folder / name).read_text()
        (folder / f"m_{name}").write_text(text)
        factor = f"!xform -s {1 / FOOT!r} m_{name}\n"
        (folder / name).write_text(factor)
    for file in folder.glob("*.vf"):
        view = scaled(read_view(file), 1 / FOOT)
        file.write_text(f"rvu {format_view(view)}\n")
    for file in folder.glob("*.pts"):
        write_sensors(file, scaled(read_sensors(file), 1 / FOOT))
    text = study.read_text().replace("[scene]", '[scene]\nunits = "feet"')
    study.write_text(text)
    return study


def with_view(study):
    """The study with a view that is clipped at 0.1 m."""
    eye = View(position=np.array([2.0, 3.0, 1.2]), fore=0.1)
    study.with_name("eye.vf").write_text(f"rvu {format_view(eye)}\n")
    study.write_text(study.read_text() + '\n[[view]]\nfile = "eye.vf"\n')
    return study


def test_a_study_in_feet_has_the_same_room_windows_sensors_and_views(tmp_path):
    one = read_inputs(read_study(with_view(write_demo(tmp_path / "metres"))))
    with_view(write_demo(tmp_path / "feet"))
    other = read_inputs(read_study(in_feet(tmp_path / "feet")))
    assert one.cameras
    np.testing.assert_allclose(other.scene.bounds(), one.scene.bounds(), rtol=1e-9)
    for a, b in zip(one.groups, other.groups, strict=True):
        for part in ("inner", "outer"):
            assert getattr(b, part).area == pytest.approx(getattr(a, part).area)
            corner = [getattr(g, part).polygons[0].vertices for g in (a, b)]
            np.testing.assert_allclose(corner[1], corner[0], rtol=1e-9, atol=1e-9)
    for name, grid in one.grids.items():
        found = other.grids[name].position
        np.testing.assert_allclose(found, grid.position, atol=1e-4)
    for a, b in zip(one.cameras, other.cameras, strict=True):
        np.testing.assert_allclose(b.view.position, a.view.position, atol=1e-4)
        assert b.view.fore == pytest.approx(0.1, rel=1e-4)
        assert (b.columns, b.rows) == (a.columns, a.rows)


def test_an_unknown_unit_is_refused_with_its_line(tmp_path):
    study = write_demo(tmp_path)
    text = study.read_text().replace("[scene]", '[scene]\nunits = "foot"')
    study.write_text(text)
    with pytest.raises(InputError, match=r'scene.units is "foot"; "metres", .*"feet"'):
        read_study(study)


@pytest.mark.parametrize(("factor", "height"), [(20.0, "54"), (0.1, "0.27")])
def test_a_room_of_unusual_height_is_doubted(tmp_path, factor, height):
    inputs = read_inputs(read_study(write_demo(tmp_path)))
    sensors = scaled(inputs.sensors(), factor)
    findings = check_scene(scaled(inputs.scene, factor), (), sensors)
    hint = f"the room is {height} m high; is it in metres? the key `units` of [scene]"
    assert any(finding.startswith(hint) for finding in findings)
