"""Tables that other programs read."""

import csv

import numpy as np
import pytest
import xarray as xr

from clerestory.errors import InputError
from clerestory.metrics.sensor_metrics import sensor_metrics
from clerestory.study.outputs import write_hourly, write_ill, write_metrics
from clerestory.study.results import Results, read_results, save_results

TIMES = np.datetime64("2023-12-31T21:30") + np.arange(3) * np.timedelta64(1, "h")


@pytest.fixture
def results():
    lux = np.array([[0, 100, 400], [10, 20, 30], [1, 2, 3.06]], dtype=np.float32)
    hourly = xr.Dataset(
        {
            "illuminance": (("sensor", "time"), lux),
            "standard_error": (("sensor", "time"), lux / 100),
        },
        coords={
            "sensor": ["desks.1", "desks.2", "eyes.1"],
            "grid": ("sensor", ["desks", "desks", "eyes"]),
            "time": TIMES,
            "occupied": ("time", np.array([False, True, True])),
            "position": (("sensor", "xyz"), np.arange(9.0).reshape(3, 3)),
            "direction": (("sensor", "xyz"), np.tile([0.0, 0, 1], (3, 1))),
        },
    )
    metrics = sensor_metrics(hourly, np.array([False, True, True]))
    data = xr.merge([hourly, metrics], combine_attrs="override")
    return Results(data.assign_attrs(title="Two hours"), {"seed": 1})


def test_daysim_lines_hold_month_day_hour_and_every_sensor(results, tmp_path):
    write_ill(results, tmp_path / "desks.ill", grid="desks")
    lines = (tmp_path / "desks.ill").read_text().splitlines()
    assert lines[0].split() == ["12", "31", "21.500", "0.0", "10.0"]
    assert lines[2].split() == ["12", "31", "23.500", "400.0", "30.0"]
    assert len(lines) == 3


def test_hourly_table_has_a_column_for_every_sensor_of_its_grid(results, tmp_path):
    write_hourly(results, tmp_path / "eyes.csv", grid="eyes")
    rows = list(csv.reader((tmp_path / "eyes.csv").read_text().splitlines()))
    assert rows[0] == ["time", "eyes.1"]
    assert rows[3] == ["2023-12-31 23:30", "3.1"]


def test_metrics_table_has_a_line_for_every_sensor(results, tmp_path):
    write_metrics(results, tmp_path / "metrics.csv")
    rows = list(csv.DictReader((tmp_path / "metrics.csv").read_text().splitlines()))
    assert [row["sensor"] for row in rows] == ["desks.1", "desks.2", "eyes.1"]
    assert float(rows[0]["mean [lux]"]) == 250
    assert float(rows[0]["mean, standard error [lux]"]) == 2.5
    assert float(rows[0]["daylight autonomy [%]"]) == 50
    assert float(rows[0]["useful illuminance [%]"]) == 100
    assert float(rows[1]["fell short [%]"]) == 100
    assert float(rows[2]["y [m]"]) == 7


def test_results_are_read_back(results, tmp_path):
    path = save_results(results, tmp_path)
    again = read_results(path)
    xr.testing.assert_equal(again.data, results.data)
    assert again.run == {"seed": 1}


def test_results_without_run_json_can_be_read(results, tmp_path):
    save_results(results, tmp_path)
    (tmp_path / "run.json").unlink()
    assert read_results(tmp_path).run == {}


@pytest.mark.parametrize("size", [0, 100, 3000])
def test_truncated_results_are_refused(results, tmp_path, size):
    path = save_results(results, tmp_path)
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(InputError, match=r"results\.nc: "):
        read_results(tmp_path)


def test_another_netcdf_is_refused(tmp_path):
    path = tmp_path / "results.nc"
    path.write_bytes(xr.Dataset({"a": 1}).to_netcdf(engine="h5netcdf"))
    with pytest.raises(InputError, match="is not the results"):
        read_results(path)


def test_missing_results_are_reported(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        read_results(tmp_path)
