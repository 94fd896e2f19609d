"""`clerestory metrics` on a results folder."""

import numpy as np
import pytest
import xarray as xr

from clerestory.metrics.honeybee_writer import write_honeybee
from clerestory.study.results import Results, save_results


@pytest.fixture
def folder(room):
    """A year of 400 lux by day at one sensor and 100 at the other, no direct sun."""
    times = np.datetime64("2023-01-01T00:30", "s") + np.arange(8760) * np.timedelta64(
        1, "h"
    )
    day = (np.arange(8760) % 24 >= 6) & (np.arange(8760) % 24 < 20)
    lux = np.where(day, 1.0, 0.0) * np.array([[400.0], [100.0]])
    write_honeybee(room / "year", {"desks": lux}, times)
    return "year"


def test_figures_of_a_folder_are_reported(call, folder):
    outcome = call("metrics", folder)
    assert outcome.status == 0
    assert "desks: 2 sensors" in outcome.out
    assert "sDA300/50                   50.0 %" in outcome.out
    assert "ASE1000,250                 0.0 %" in outcome.out
    assert "LEED v4.1 option 1          1 points" in outcome.out


def test_sensors_go_to_a_table_and_a_folder(call, room, folder):
    outcome = call("metrics", folder, "-q", "-o", "m.csv", "--honeybee", "again")
    assert (outcome.status, outcome.out) == (0, "")
    lines = (room / "m.csv").read_text().splitlines()
    assert len(lines) == 3
    assert lines[1].startswith("desks,1,100,100,0,0,100,0,")
    assert (room / "again" / "sun-up-hours.txt").is_file()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nothing"], "cannot be read"),
        (["year", "--states", "short.csv"], "2 time steps; 8760 hourly steps expected"),
        (["year", "--grid", "attic"], "no grid called attic"),
        (["year", "--from", "18", "--to", "8"], "schedule from 18 to 8"),
    ],
)
def test_bad_input_is_one_line(call, room, folder, words, message):
    (room / "short.csv").write_text("time,a\n2023-01-01T00:30,0\n2023-01-01T01:30,1\n")
    outcome = call("metrics", *words)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1


def results(folder, *, sun_hours):
    """A year of two sensors, direct sun of 2000 lux at the first one for some hours."""
    hours = np.arange(8760)
    times = np.datetime64("2023-01-01T00:30", "s") + hours * np.timedelta64(1, "h")
    occupied = (hours % 24 >= 8) & (hours % 24 < 18)
    direct = np.zeros((2, 8760), dtype=np.float32)
    direct[0, np.flatnonzero(occupied)[:sun_hours]] = 2000
    lux = np.full((2, 8760), 500, dtype=np.float32)
    axes = ("sensor", "time")
    dgp = np.where(np.arange(8760) % 100 < 4, 0.5, 0.2)
    data = xr.Dataset(
        {
            "illuminance": (axes, lux),
            "standard_error": (axes, 0 * lux),
            "direct_open": (axes, direct),
            "sun_hours": ("sensor", [float(sun_hours), 0.0]),
            "glare_dgp": (("view", "time"), dgp[None]),
            "sun_reaches": (("opening", "moment"), np.ones((1, 216), dtype=bool)),
            "room_hours_of_sun": ((), 3.6),
            "occupied": ("time", np.ones(len(times), dtype=bool)),
        },
        coords={
            "time": times.astype("datetime64[ns]"),
            "sensor": ["desks.1", "desks.2"],
            "grid": ("sensor", ["desks", "desks"]),
            "position": (("sensor", "xyz"), [[0.0, 1, 0.8], [0.5, 1, 0.8]]),
            "direction": (("sensor", "xyz"), np.tile([0.0, 0, 1], (2, 1))),
            "view": ["eye"],
            "opening": ["south"],
            "moment": np.datetime64("2023-03-21T10:00:30", "ns")
            + np.arange(216) * np.timedelta64(60, "s"),
        },
        attrs={"title": "year", "step_minutes": 60.0},
    )
    folder.mkdir()
    save_results(Results(data), folder)


@pytest.mark.parametrize(("hours", "share"), [(250, "0.0 %"), (251, "50.0 %")])
def test_ase_counts_more_than_250_hours_of_direct_sun(call, room, hours, share):
    results(room / "run", sun_hours=hours)
    outcome = call("metrics", "run")
    assert f"ASE1000,250                 {share}, {hours} h at most\n" in outcome.out
    assert "LEED v4.1 option 1" in outcome.out


def test_departures_from_lm83_stand_beside_the_points(call, room):
    results(room / "run", sun_hours=10)
    out = call("metrics", "run", "--from", 9).out
    note = "(not by LM-83: hours from 9 to 18; 8 to 18 expected)"
    assert f"LEED v4.1 option 1          3 points {note}" in out
    assert "100.0 % (not by LM-83)" in out


def test_glare_of_views_has_its_level(call, room):
    """DGP 0.5 in 4 % of the hours is no more than EN 17037 lets pass."""
    results(room / "run", sun_hours=1)
    assert "EN 17037 glare              level high" in call("metrics", "run").out


def test_hours_of_sun_have_their_level(call, room):
    results(room / "run", sun_hours=1)
    line = "EN 17037 sunlight           level medium (3.6 h of sun on 03-21)"
    assert line in call("metrics", "run").out
