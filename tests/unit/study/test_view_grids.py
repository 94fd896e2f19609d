"""Annual glare of view grids: written position by position, labelled, tabulated."""

import csv
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from clerestory.progress import silent
from clerestory.scene.sensors import Sensors
from clerestory.study.annual_view_grids import Hours, study_view_grids
from clerestory.study.control_case import Case
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.control_rules import by_glare
from clerestory.study.results import Results, read_results, save_results
from clerestory.study.spaces import label_spaces
from clerestory.study.view_grid_outputs import write_grid_dgp, write_grid_views
from clerestory.study.view_grid_positions import ViewGrid
from clerestory.study.view_grid_tables import ViewGridTable
from clerestory.study.window_tables import ControlTable

TIMES = np.datetime64("2023-06-21T00:30") + np.arange(48) * np.timedelta64(1, "h")
HOURS = Hours(TIMES, np.flatnonzero(np.arange(48) % 24 >= 6), np.arange(48) % 24 >= 4)


def grid(name, positions, *, directions=4, by_state=False):
    table = ViewGridTable(
        name=name, places=[[0, 0, 1]], directions=directions, by_state=by_state
    )
    return ViewGrid(table, np.arange(3.0 * positions).reshape(positions, 3))


def glare(grid, number, states, steps):
    """DGP that grows with position, direction and hour, and falls with the state."""
    base = 0.3 + 0.1 * number + 0.025 * np.arange(grid.table.directions)[:, None]
    dgp = base + 0.001 * (steps % 24) - 0.1 * np.asarray(states[0])[steps]
    return xr.Dataset(
        {
            name: (("view", "time"), values)
            for name, values in {
                "dgp": dgp,
                "dgp_error": 0.01 + 0 * dgp,
                "illuminance": 1e4 * dgp,
            }.items()
        }
    )


@pytest.fixture
def found(tmp_path):
    states = [np.zeros(48, int)]
    return study_view_grids(
        [grid("a", 5, by_state=True), grid("b", 2, directions=2)],
        glare,
        states,
        every_state=[[np.full(48, state)] for state in range(3)],
        hours=HOURS,
        folder=tmp_path,
        display=silent,
    )


def test_every_hour_of_every_view_is_in_the_file(found):
    assert found.sizes["grid_view"] == 5 * 4 + 2 * 2
    dgp = found["grid_view_dgp"]
    assert dgp.dtype == np.float32
    assert bool(dgp.isel(time=slice(0, 6)).isnull().all())
    one = dgp.isel(grid_view=4 * 3 + 2, time=30)
    assert float(one) == pytest.approx(0.3 + 0.3 + 0.05 + 0.006)
    assert one["grid_view"].item() == "a.4.180"
    assert one["view_grid"].item() == "a"
    assert found["grid_view_position"].values[14].tolist() == [9, 10, 11]
    assert found["grid_view_azimuth"].values[-2:].tolist() == [0, 180]
    assert found["grid_view_number"].values[-2:].tolist() == [1, 1]


def test_annual_figures_are_those_of_the_occupied_hours(found):
    """Of 40 occupied hours two may have more: the second-highest hour 22, twice."""
    exceeded = found["grid_view_exceeded_dgp"]
    assert float(exceeded[4 * 4 + 3]) == pytest.approx(0.7 + 0.075 + 0.022)
    assert found["grid_view_exceeded_dgp_error"].values[19] == pytest.approx(0.01)
    # In grid "a" position 1 is above 0.40 in no view, position 2 in all
    assert found["disturbed_views"].values.tolist() == [0.8, 0.5]
    assert found["disturbed_positions"].values.tolist() == [0.8, 0.5]


def test_each_state_has_its_figures_where_they_are_asked_for(found):
    by_state = found["grid_view_exceeded_dgp_by_state"]
    assert by_state.sizes == {"shade_state": 3, "grid_view": 24}
    first = found["grid_view_exceeded_dgp"].values
    assert by_state.values[1, :20] == pytest.approx(first[:20] - 0.1, abs=1e-6)
    assert np.isnan(by_state.values[:, 20:]).all()


def results_with(found):
    """Results of one sensor, with view grids."""
    count = len(TIMES)
    lux = xr.Dataset(
        {
            "illuminance": (("sensor", "time"), np.ones((1, count), np.float32)),
            "standard_error": (("sensor", "time"), np.ones((1, count), np.float32)),
        },
        coords={
            "sensor": ["desk.1"],
            "grid": ("sensor", ["desk"]),
            "time": TIMES,
            "occupied": ("time", HOURS.occupied),
            "position": (("sensor", "xyz"), np.zeros((1, 3))),
            "direction": (("sensor", "xyz"), np.array([[0.0, 0, 1]])),
        },
    )
    return Results(lux.merge(found).assign_attrs(title="Views"))


def test_results_are_stored_whole_and_alike(found, tmp_path):
    results = results_with(found)
    first = save_results(results, tmp_path).read_bytes()
    again = save_results(results, tmp_path).read_bytes()
    assert first == again
    back = read_results(tmp_path).data
    for name in found.data_vars:
        np.testing.assert_array_equal(back[name].values, found[name].values)


def test_tables_have_a_line_per_view_and_per_step(found, tmp_path):
    results = results_with(found)
    write_grid_views(results, tmp_path / "a.csv", grid="a")
    rows = list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))
    assert len(rows) == 20
    assert rows[19]["view"] == "a.5.270"
    assert rows[19]["position"] == "5"
    assert rows[19]["EN 17037"] == "none"
    assert float(rows[19]["hours above 0.45 [%]"]) == 100 * 36 / 40
    assert float(rows[0]["DGP exceeded in 5 %, state 2"]) == pytest.approx(0.122)
    write_grid_dgp(results, tmp_path / "b.csv", grid="b")
    rows = list(csv.reader((tmp_path / "b.csv").read_text().splitlines()))
    assert rows[0] == ["time", "b.1.0", "b.1.180", "b.2.0", "b.2.180"]
    assert rows[1] == ["2023-06-21 00:30", "", "", "", ""]
    assert rows[1 + 30] == ["2023-06-22 06:30", "0.306", "0.331", "0.406", "0.431"]


def test_a_rule_by_a_view_grid_chooses_as_if_every_view_were_known():
    """Lower limits of DGP in place of exact values do not change the states."""
    random = np.random.default_rng(3)
    dgp = np.sort(random.uniform(0.2, 0.6, (7, 4, 500)), axis=1)[:, ::-1]
    worst = dgp.max(axis=0)
    exact, asked = [], []

    def largest(states, steps, names, *, enough):
        state = states[0][steps]
        found = np.zeros(len(steps))
        for point in dgp:
            seen = found <= enough
            asked.append(seen.sum())
            found[seen] = np.maximum(found, point[state, steps])[seen]
        exact.append(enough)
        return found

    study = SimpleNamespace(view=[])
    inputs = SimpleNamespace(
        weather=SimpleNamespace(times=np.arange(500)),
        groups=[SimpleNamespace(states=range(4))],
    )
    signals = ControlInputs(study, inputs, None, None, np.zeros, largest)
    control = ControlTable(rule="glare", dgp_below=0.45, view_grids=["a"])
    states = by_glare(Case(signals, 0, control, [np.zeros(500, int)]))
    within = worst <= 0.45
    expected = np.where(within.any(axis=0), within.argmax(axis=0), worst.argmin(axis=0))
    np.testing.assert_array_equal(states, expected)
    assert exact[:4] == [0.45] * 4
    assert sum(asked) < 4 * 7 * 500


def test_positions_belong_to_the_space_of_the_nearest_sensor():
    """Two level grids 10 m apart; one position in each, with two directions."""
    points = np.array([[0.0, 0, 0.8], [1, 0, 0.8], [10, 0, 0.8], [11, 0, 0.8]])
    up = np.tile([0.0, 0, 1], (2, 1))
    grids = {"west": Sensors(points[:2], up), "east": Sensors(points[2:], up)}
    table = ViewGridTable(name="g", places=[[0, 0, 1]], directions=2)
    inputs = SimpleNamespace(
        grids=grids,
        sensors=lambda: Sensors(points, np.tile(up, (2, 1))),
        groups=[],
        cameras=[],
        view_grids=[ViewGrid(table, np.array([[10.4, 1, 1.2], [0.4, 1, 1.2]]))],
    )
    study = SimpleNamespace(space=[], view=[])
    found = label_spaces(study, inputs, xr.Dataset())
    assert found["grid_view_space"].dims == ("grid_view",)
    assert found["grid_view_space"].values.tolist() == ["east"] * 2 + ["west"] * 2
