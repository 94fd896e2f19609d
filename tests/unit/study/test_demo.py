"""The bundled study is whole and its room has the size it should."""

import numpy as np
import pytest

from clerestory.errors import OutputError
from clerestory.scene.scene_checks import check_scene
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.new_study import write_demo


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


def test_writing_the_demo_again_keeps_what_was_changed(tmp_path):
    write_demo(tmp_path)
    (tmp_path / "desks.pts").write_text("1 1 0.76 0 0 1\n")
    (tmp_path / "room.rad").unlink()
    write_demo(tmp_path)
    assert (tmp_path / "desks.pts").read_text() == "1 1 0.76 0 0 1\n"
    assert (tmp_path / "room.rad").is_file()


def test_a_demo_where_nothing_can_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        write_demo(tmp_path / "file" / "demo")
