"""Annual metrics against honeybee-radiance-postprocess's own reference values."""

import json

import numpy as np
import pytest

from clerestory.control.lm83_blinds import operate_by_direct_sun
from clerestory.errors import InputError
from clerestory.metrics.climate_based_metrics import (
    annual_statistic,
    continuous_autonomy,
    daylight_autonomy,
    light_exposure,
    useful_illuminance,
)
from clerestory.metrics.honeybee import read_honeybee
from clerestory.metrics.honeybee_writer import write_honeybee
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.spatial_metrics import (
    hours_above,
    spatial_autonomy,
    sunlight_exposure,
)


@pytest.fixture(scope="module")
def folder(shared_data):
    """Results of two rooms with dynamic window groups."""
    return shared_data / "metrics" / "results_folders" / "results_sample"


def reference(shared_data, metric, grid):
    name = f"{grid}.{metric.split('_')[0]}"
    return np.loadtxt(shared_data / "metrics" / "sample_metrics" / metric / name)


@pytest.mark.parametrize("grid", ["TestRoom_1", "TestRoom_2"])
def test_metrics_equal_the_reference_to_the_last_digit(shared_data, folder, grid):
    """All groups in state 0, every day from 8 to 18 h; two decimals are kept."""
    lux = read_honeybee(folder).illuminance(grid)
    hours = occupied_hours(lux["time"].values)
    bands = useful_illuminance(lux, hours)
    found = {
        "da": daylight_autonomy(lux, hours),
        "cda": continuous_autonomy(lux, hours),
        "udi": bands[1] + bands[2],
        "udi_lower": bands[0],
        "udi_upper": bands[3],
    }
    for metric, share in found.items():
        expected = reference(shared_data, metric, grid)
        assert np.allclose(100 * share.values, expected, atol=0.005 + 1e-6)


# What honeybee-radiance-postprocess 0.5.25 says of results_sample with its defaults:
# AnnualDaylight(folder).spatial_daylight_autonomy(), .annual_sunlight_exposure(),
# and of the sensor that has most of each .average_values(), .peak_values(),
# .cumulative_values()
PROGRAM = {
    "TestRoom_1": (1.0, 0.25, 770, 2595.99902, 50652.0703, 22740952.0),
    "TestRoom_2": (23 / 24, 0.0, 162, 1278.63525, 58312.2656, 11200845.0),
}


@pytest.mark.parametrize("grid", list(PROGRAM))
def test_shares_of_rooms_and_statistics_equal_those_of_the_program(folder, grid):
    """It keeps single precision, a year's sum to about a lux hour in 10⁷."""
    results = read_honeybee(folder)
    lux = results.illuminance(grid)
    direct = results.illuminance(grid, light="direct")
    hours = occupied_hours(lux["time"].values)
    year = np.ones(len(hours), dtype=bool)
    sda, ase, most, mean, peak, total = PROGRAM[grid]
    assert spatial_autonomy(lux, hours).value == pytest.approx(sda, abs=1e-12)
    assert sunlight_exposure(direct, hours).value == ase
    assert hours_above(direct, hours).max() == most
    assert annual_statistic(lux, year, "mean").max() == pytest.approx(mean, rel=2e-7)
    assert annual_statistic(lux, year, "max").max() == pytest.approx(peak, rel=1e-7)
    assert light_exposure(lux, year).max() == pytest.approx(total, rel=2e-7)


def test_states_choose_among_the_arrays(folder):
    """A state for half of the year, darkness for the other."""
    results = read_honeybee(folder)
    state = np.where(np.arange(8760) < 4380, 1, -1)
    paths = [p for p in results.paths["TestRoom_1"] if not p.startswith("__")]
    lux = results.illuminance("TestRoom_1", states={p: state for p in paths}).values
    hours = results.sun_up_hours.astype(int)
    arrays = [
        np.load(folder / p / f"1_{p}" / "total" / "TestRoom_1.npy") for p in paths
    ]
    static = np.load(
        folder / "__static_apertures__" / "default" / "total" / "TestRoom_1.npy"
    )
    early = hours < 4380
    assert np.allclose(
        lux[:, hours[early]], (sum(arrays) + static)[:, early], rtol=1e-5
    )
    assert np.allclose(lux[:, hours[~early]], static[:, ~early])
    night = np.setdiff1d(np.arange(8760), hours)
    assert not lux[:, night].any()


def test_a_written_folder_reads_the_same(folder, tmp_path):
    results = read_honeybee(folder)
    total = {grid: results.illuminance(grid) for grid in results.paths}
    times = total["TestRoom_1"]["time"].values
    write_honeybee(tmp_path / "ours", {g: a.values for g, a in total.items()}, times)
    back = read_honeybee(tmp_path / "ours")
    assert set(back.sun_up_hours) <= set(results.sun_up_hours)
    for grid, lux in total.items():
        assert np.allclose(back.illuminance(grid).values, lux.values)
        assert not back.illuminance(grid, light="direct").any()


def test_a_damaged_folder_is_reported_in_one_line(folder, tmp_path):
    results = read_honeybee(folder)
    lux = {"room": results.illuminance("TestRoom_1").values}
    times = results.illuminance("TestRoom_1")["time"].values
    write_honeybee(tmp_path, lux, times)
    array = tmp_path / "__static_apertures__" / "default" / "total" / "room.npy"
    array.write_bytes(array.read_bytes()[:200])
    with pytest.raises(InputError, match=r"room\.npy: no NumPy array"):
        read_honeybee(tmp_path).illuminance("room")
    (tmp_path / "grids_info.json").write_text(json.dumps([{"name": "x"}]))
    with pytest.raises(InputError, match=r"grids_info\.json: grids with"):
        read_honeybee(tmp_path)
    (tmp_path / "grids_info.json").write_text("{")
    with pytest.raises(InputError, match="not JSON"):
        read_honeybee(tmp_path)


def test_lm83_closes_blinds_only_where_the_sun_is(folder):
    """With the rule kept, at most 2 % of the sensors have 1000 lux of direct sun."""
    results = read_honeybee(folder)
    groups = results.dynamic_paths("TestRoom_1")
    direct = {p: results.by_state("TestRoom_1", p, light="direct") for p in groups}
    static = results.by_state("TestRoom_1", "__static_apertures__", light="direct")[0]
    operation = operate_by_direct_sun(direct, static=static)
    left = results.illuminance("TestRoom_1", states=operation.states, light="direct")
    share = (left.values >= 1000).mean(axis=0)
    assert np.all(share[operation.kept] <= 0.02)
    open_share = (
        results.illuminance("TestRoom_1", light="direct").values >= 1000
    ).mean(axis=0)
    idle = open_share <= 0.02
    assert all(not state[idle].any() for state in operation.states.values())
    assert idle.any()
    assert not idle.all()
