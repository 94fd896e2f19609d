"""View grids of two-phase studies against sensors at the eye, in a room with glass."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.study import glazed_grid_points
from clerestory.study.config import read_study
from clerestory.study.run_plan import plan_study
from clerestory.study.study_run import run_study

pytestmark = pytest.mark.slow

ROOM = Path(__file__).parents[1] / "cli" / "room"

GLASS = """
void glass clear 0 0 3 .8 .8 .8
clear polygon pane 0 0 12  3 0 1  1 0 1  1 0 2.5  3 0 2.5
"""
GRID = """
[[view_grid]]
name = "seats"
places = [[2, 1.5, 1.2]]
directions = 4
samples = 1024
sun_samples = 4
tolerance = 0.02
most_directions = 1024
"""
# North, east, south and west of the position of the grid
EYES = "2 1.5 1.2 0 1 0\n2 1.5 1.2 1 0 0\n2 1.5 1.2 0 -1 0\n2 1.5 1.2 -1 0 0\n"


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("glazed") / "study"
    shutil.copytree(ROOM, folder)
    (folder / "glass.rad").write_text(GLASS)
    (folder / "eye.pts").write_text(EYES)
    head, _, tail = (folder / "study.toml").read_text().partition("[[window]]")
    head = head.replace("3-phase", "2-phase").replace('["room', '["glass.rad", "room')
    rest = tail[tail.index("[[sensors]]") :].replace("samples = 256", "samples = 16384")
    (folder / "study.toml").write_text(head + rest + GRID)
    return read_study(folder / "study.toml")


@pytest.fixture(scope="module")
def data(study):
    return run_study(study, out=study.folder / "out").data


def test_illuminance_at_the_eye_is_that_of_sensors(data):
    """The sum over cells, and the irradiance of a point, in every direction."""
    found = data["grid_view_illuminance"].values
    own = data["grid"].values == "eye"
    sensors, error = (
        data[name].values[own] for name in ("illuminance", "standard_error")
    )
    lit = np.isfinite(found[0])
    assert 10 < lit.sum() < found.shape[1]
    found, sensors, error = (each[:, lit] for each in (found, sensors, error))
    assert error.mean() < 0.05 * sensors.mean()
    assert np.all(abs(found - sensors) < 4 * error + 0.03 * sensors)
    assert found.sum() == pytest.approx(sensors.sum(), rel=0.02)


def test_glare_is_that_of_the_window(data):
    """The window is in the south; DGP grows with the light at the eye."""
    dgp, error = (data[f"grid_view_dgp{end}"].values for end in ("", "_error"))
    lit = np.isfinite(dgp[0])
    north, _, south, _ = dgp[:, lit]
    assert (south >= north).all()
    assert south.max() > 0.3
    assert np.all(error[:, lit] < 0.05)
    assert data["worst_view"].values[0] in range(4)


def test_a_second_run_reads_the_glare_of_every_position(data, study, monkeypatch):
    def traced(*_arguments, **_keywords):
        raise AssertionError("traced again")

    monkeypatch.setattr(glazed_grid_points.GlazedViewPoint, "glare", traced)
    again = run_study(study, out=study.folder / "out").data
    for name in ("grid_view_dgp", "grid_view_dgp_error", "grid_view_illuminance"):
        np.testing.assert_array_equal(again[name].values, data[name].values)


def test_a_plan_estimates_the_tracing_of_the_positions(study):
    plan = plan_study(study, out=study.folder / "planned")
    names = [matrix.file for matrix in plan.matrices]
    assert any(name.startswith("coefficients") for name in names)
    assert plan.later.paths > 1024 * 1024
    assert plan.stages["view grids"].work == "1 positions, 4 views"
