"""Annual glare of recipes: files, glare autonomy, and eyes of sensors."""

import json

import numpy as np

from clerestory.glare.point_glare import view_along
from clerestory.metrics.honeybee_writer import GridRecord
from clerestory.recipes.grid_glare import _eyes, write_glare
from clerestory.scene.sensors import Sensors


def test_glare_autonomy_counts_occupied_hours_below_the_limit(tmp_path):
    """Of four occupied hours one is dark; the limit itself is glare."""
    grids = (GridRecord("eyes", "eyes", 2),)
    dgp = {"eyes": np.array([[0.2, 0.4, 0.5, 0.9], [0.3, 0.3, 0.3, 0.9]])}
    hours = np.array([9.5, 10.5, 11.5, 19.5])
    used = np.array([True, True, True, False])
    occupied = np.array([True, True, True, True, False])
    write_glare(tmp_path, grids, dgp, hours, used, occupied, 0.4)
    autonomy = np.loadtxt(tmp_path / "metrics" / "ga" / "eyes.ga")
    assert autonomy.tolist() == [50, 100]
    assert np.array_equal(np.loadtxt(tmp_path / "results" / "eyes.dgp"), dgp["eyes"])
    found = np.loadtxt(tmp_path / "results" / "sun-up-hours.txt")
    assert np.array_equal(found, hours)
    info = json.loads((tmp_path / "results" / "grids_info.json").read_text())
    assert info[0]["count"] == 2


def test_sensors_at_one_position_share_it():
    """Three sensors at two positions: each has its own line of sight."""
    places = np.array([[1.0, 1, 1.2], [3, 1, 1.2], [1, 1, 1.2]])
    lines = np.array([[0.0, -1, 0], [0, 1, 0], [1, 0, 0]])
    grid, owner = _eyes("eyes", Sensors(places, lines))
    assert len(grid) == 2
    for k, place in enumerate(places):
        views = grid.views(int(owner[k]))
        assert views[0].position.tolist() == place.tolist()
        number = np.flatnonzero(owner == owner[k]).tolist().index(k)
        assert views[number].direction.tolist() == lines[k].tolist()


def test_the_top_of_a_vertical_view_is_y():
    above = view_along(np.array([0.0, 0, 1]), position=np.zeros(3))
    ahead = view_along(np.array([0.0, 1, 0]), position=np.zeros(3))
    assert above.up.tolist() == [0, 1, 0]
    assert ahead.up.tolist() == [0, 0, 1]
