"""`clerestory metrics` on a results folder."""

import numpy as np
import pytest

from clerestory.metrics.honeybee import write_honeybee


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


def test_figures_of_a_folder_are_told(call, folder):
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
        (["year", "--states", "short.csv"], "2 steps; one for each of 8760 hours"),
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
