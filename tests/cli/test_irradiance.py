"""Irradiance of sensors under one sky from the command line."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest

# Horizontal irradiance of 50 W/m², which is 8950 lux
OVERCAST = "gensky 3 21 12 -c -B 50"
FIELD = ("irradiance", "--scene", "black.rad", "--sky", "sky.rad")
ROOM = ("irradiance", "--scene", "room.rad", "--sensors", "desk.pts")


@pytest.fixture
def field(room):
    """A black tile far below one sensor that faces up, and one that faces south."""
    (room / "black.rad").write_text(
        "void plastic black 0 0 5 0 0 0 0 0\n"
        "black polygon tile 0 0 12 0 0 -9 1 0 -9 1 1 -9 0 1 -9\n"
    )
    # Without the ground that a sky command adds
    (room / "sky.rad").write_text(
        f"!{OVERCAST}\nskyfunc glow sky 0 0 4 1 1 1 0\nsky source up 0 0 4 0 0 1 180\n"
    )
    (room / "two.pts").write_text("0 0 1 0 0 1\n0 0 1 0 -1 0\n")
    return room


def table(text):
    """Columns of a CSV table, by name."""
    rows = list(csv.DictReader(io.StringIO(text)))
    return {
        name: np.array([float(row[name]) for row in rows])
        for row in rows
        for name in row
    }


def test_sensors_under_an_overcast_sky_follow_its_closed_form(call, field):
    """Zenith radiance 9 E / (7π) times (1 + 2 sin γ) / 3, as in Moon and Spencer.

    Radiance's skybright.cal blends it with the ground, 0.2 E / π, at the horizon.
    """
    outcome = call(*FIELD, "--sensors", "two.pts", "--relative-error", 0.005)
    assert outcome.status == 0, outcome.err
    found = table(outcome.out)
    altitude, azimuth = np.meshgrid(
        (np.arange(2000) + 0.5) * np.pi / 4000, (np.arange(500) + 0.5) * np.pi / 500
    )
    zenith, ground = 9 * 50 / (7 * np.pi), 0.2 * 50 / np.pi
    share = 1 / (1 + (np.sin(altitude) + 1.01) ** -20)
    radiance = zenith * (1 + 2 * np.sin(altitude)) / 3
    radiance = share * radiance + (1 - share) * ground
    flux = radiance * np.cos(altitude) * np.pi**2 / 4000 / 500
    upwards = 2 * np.sum(flux * np.sin(altitude))
    south = np.sum(flux * np.cos(altitude) * np.sin(azimuth))
    expected = np.array([upwards, south])
    lux, error = found["illuminance_lux"], found["error_lux"]
    assert np.all(np.abs(lux - 179 * expected) < 4 * error)
    assert np.all(error < 0.0055 * lux)
    assert np.all(error > 0)
    for band in ("red", "green", "blue"):
        irradiance = found[f"{band}_W_m2"]
        assert np.all(np.abs(irradiance - expected) < 4 * found[f"error_{band}_W_m2"])
    assert found["dy"].tolist() == [0, -1]


def test_sensors_come_from_standard_input_and_results_go_to_a_file(
    call, field, monkeypatch
):
    monkeypatch.setattr("sys.stdin", io.StringIO("0 0 1 0 0 1\n"))
    outcome = call(*FIELD, "--sensors", "-", "--samples", 64, "-o", "E.csv")
    assert outcome.status == 0, outcome.err
    assert "1 sensors, mean" in outcome.out
    assert len(table(Path("E.csv").read_text())["x"]) == 1


def test_text_has_the_three_columns_of_rtrace(call, field):
    outcome = call(*FIELD, "--sensors", "two.pts", "--samples", 256, "--format", "text")
    assert np.loadtxt(io.StringIO(outcome.out)).shape == (2, 3)


def test_the_same_seed_gives_the_same_table(call, room):
    words = (*ROOM, "--sky", OVERCAST, "--samples", 32)
    first, again, other = (call(*words, "--seed", seed).out for seed in (1, 1, 2))
    assert first == again != other


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("--sensors", "desk.pts"), "the scene has no light source"),
        (("--sensors", "none.pts", "--sky", OVERCAST), "none.pts"),
        (("--sensors", "-", "--sky", OVERCAST), "standard input:1: 2 numbers; six"),
    ],
)
def test_bad_input_is_one_line(call, room, monkeypatch, words, complaint):
    monkeypatch.setattr("sys.stdin", io.StringIO("1 2\n"))
    outcome = call("irradiance", "--scene", "room.rad", *words)
    assert outcome.status == 2
    assert complaint in outcome.err
    assert outcome.err.count("\n") == 1
