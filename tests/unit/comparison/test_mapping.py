"""Mapping files, loggers and grid scans; nothing in them crashes a reader."""

from contextlib import suppress

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.comparison.logger_files import read_plain
from clerestory.comparison.mapping import (
    read_mapping,
    read_measured_series,
    write_layout_sensors,
)
from clerestory.comparison.series import group_of, quantity_of
from clerestory.errors import InputError
from clerestory.scene.sensors import read_sensors
from sample_files import SCAN, four_sensors


@pytest.fixture
def near():
    """A study of four sensors, numbered along y first."""
    return four_sensors()


def test_a_scan_finds_its_sensors_its_unit_and_its_minutes(tmp_path, near):
    (tmp_path / "m.toml").write_text(SCAN)
    (tmp_path / "nine.csv").write_text("south, broken, north\n 1, 9, 2\n3, 9, 4\n")
    first, second = read_measured_series(tmp_path / "m.toml", near=near)
    # Backwards: the first row stands at x = 1.5
    assert first.names == ("lux.4", "lux.3")
    assert first.values.tolist() == [[2000.0], [1000.0]]
    assert str(first.times[0]) == "2024-06-26T09:00:00"
    assert second.names == ("lux.2", "lux.1")
    assert str(second.times[0]) == "2024-06-26T09:02:00"


def test_an_empty_cell_is_a_gap(tmp_path, near):
    (tmp_path / "m.toml").write_text(SCAN)
    (tmp_path / "nine.csv").write_text("north,south\n,1\n3,4\n")
    first, _ = read_measured_series(tmp_path / "m.toml", near=near)
    assert np.isnan(first.values[0, 0])


def test_sensors_of_a_scan_are_written_for_the_study(tmp_path):
    (tmp_path / "m.toml").write_text(SCAN)
    mapping = read_mapping(tmp_path / "m.toml")
    assert write_layout_sensors(tmp_path / "lux.pts", mapping) == 4
    sensors = read_sensors(tmp_path / "lux.pts")
    assert sorted(map(tuple, sensors.position.tolist()))[0] == (0.5, 1.0, 0.75)
    assert sensors.direction[0].tolist() == [0, 0, 1]


def test_a_logger_on_another_clock(tmp_path, near):
    """Two o'clock of Berlin's summer time is midday UTC, six in the morning there."""
    (tmp_path / "m.toml").write_text(
        'utc_offset_hours = 1\nclock = "Europe/Berlin"\n[[logger]]\nfile = "a.csv"\n'
        'time = "when"\nstands_for = "end"\nfactor = 10.0\n'
        'columns = { "lux.1" = "E" }\n'
    )
    (tmp_path / "a.csv").write_text("when,E\n2024-06-26 14:00,5\n2024-06-26 14:05,\n")
    (found,) = read_measured_series(tmp_path / "m.toml", near=near)
    assert str(found.times[0]) == "2024-06-26T05:57:30"
    assert found.step_minutes == 5
    assert found.values[0, 0] == 50
    assert np.isnan(found.values[0, 1])


def test_a_table_of_a_run_is_read_as_it_stands(tmp_path):
    (tmp_path / "a.csv").write_text("time,desks.1\n2023-01-01 00:30,1.5\n")
    found = read_plain(tmp_path / "a.csv", utc_offset_hours=1.0)
    assert found.names == ("desks.1",)
    assert found.values.tolist() == [[1.5]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('layout = "room"', 'layout = "hall"'), r"m.toml: no table \[layout.hall\]"),
        (("[3.0, 1.0]", "[3.0]"), "one coordinate for each column"),
        (('"y"', '"z"'), r'm.toml:4: layout.room.column_axis is "z"'),
        (("3.0", "3.2"), "no sensor within 0.05 m"),
        (('"north"', '"west"'), "no column 'west'; one of north, south expected"),
        (("[0.5, 1.5]", "[0.5]"), "2 rows of readings for 1 measuring points"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, near, change, message):
    (tmp_path / "m.toml").write_text(SCAN.replace(*change))
    (tmp_path / "nine.csv").write_text("north,south\n1,2\n3,4\n")
    with pytest.raises(InputError, match=message):
        read_measured_series(tmp_path / "m.toml", near=near)


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=st.text(max_size=120))
def test_random_bytes_are_refused_with_a_message(tmp_path, near, text):
    (tmp_path / "m.toml").write_text(SCAN)
    for name in ("nine.csv", "plain.csv", "other.toml"):
        (tmp_path / name).write_text(text, encoding="utf-8")
    for name in ("m.toml", "plain.csv", "other.toml"):
        with suppress(InputError):
            read_measured_series(tmp_path / name, near=near)


def test_names_contain_group_and_quantity():
    assert (group_of("a.b.3"), quantity_of("a.b.3")) == ("a.b", "illuminance")
    assert (group_of("eye.DGP"), quantity_of("eye.DGP")) == ("eye", "dgp")
