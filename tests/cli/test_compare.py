"""`clerestory compare` and `clerestory import`, without tracing."""

import json

import numpy as np
import pytest
import xarray as xr
from honeybee_models import box, honeybee_model

from clerestory.study.results import Results, save_results


@pytest.fixture
def run(room):
    """Two days of two sensors and a view, measured 10 % lower, with times in UTC."""
    times = np.datetime64("2024-06-25T00:30", "s") + np.arange(48) * np.timedelta64(
        1, "h"
    )
    hours = np.arange(48) % 24 + 0.5
    sky = 1000 * np.maximum(np.sin(np.pi * (hours - 5) / 14), 0)
    lux = np.array([[1.0], [0.5]]) * sky
    axes = ("sensor", "time")
    data = xr.Dataset(
        {
            "illuminance": (axes, lux),
            "standard_error": (axes, 0.01 * lux),
            "glare_dgp": (("view", "time"), 0.2 + 1e-4 * sky[None]),
            "occupied": (("time",), sky > 0),
        },
        coords={
            "time": times.astype("datetime64[ns]"),
            "sensor": ["desks.1", "desks.2"],
            "grid": ("sensor", ["desks", "desks"]),
            "position": (("sensor", "xyz"), [[0.0, 1, 0.75], [0, 2, 0.75]]),
            "direction": (("sensor", "xyz"), [[0.0, 0, 1], [0, 0, 1]]),
            "view": ["eye"],
        },
        attrs={
            "title": "days",
            "method": "3-phase",
            "step_minutes": 60.0,
            "utc_offset_hours": 1.0,
        },
    )
    (room / "run").mkdir()
    save_results(Results(data), room / "run")
    rows = ["time,desks.1,eye.dgp,attic.1"]
    for time, value in zip(times, sky, strict=True):
        stamp = f"{time - np.timedelta64(1, 'h')}+00:00"
        rows.append(f"{stamp},{value / 1.11:.6f},{0.2 + 1e-4 * value:.6f},7")
    (room / "measured.csv").write_text("\n".join(rows) + "\n")
    return "run"


def test_tables_and_page_show_the_agreement(call, room, run):
    outcome = call("compare", "measured.csv", run, "-o", "out")
    assert outcome.status == 0, outcome.err
    assert "desks illuminance: bias +11.0 %" in outcome.out
    assert "Measured but not simulated: attic.1." in outcome.out
    shares = (room / "out" / "shares.csv").read_text().splitlines()
    assert shares[0].startswith("group,quantity,pairs,3-phase: Δ < 5 %")
    assert shares[1].endswith(",0.0,0.0,100.0")
    assert shares[2].startswith("eye,dgp,")
    assert shares[2].endswith(",100.0,100.0,100.0")
    page = (room / "out" / "comparison.html").read_text()
    assert page.count("data:image/png;base64,") >= 5
    assert "http-equiv" in page
    assert 'src="http' not in page
    facts = json.loads((room / "out" / "comparison.json").read_text())
    # Too low a measurement may fit a little better a step of the search away
    assert abs(facts[0]["offset_not_applied"]["illuminance"]["minutes"]) <= 5
    assert "is one clock wrong" not in outcome.out
    assert facts[0]["groups"][0]["relative_bias"] == pytest.approx(0.11)


def test_two_simulations_stand_side_by_side(call, room, run):
    outcome = call(
        "compare", "measured.csv", run, run, "--name", "a", "--name", "b", "-q"
    )
    assert (outcome.status, outcome.out) == (0, "")
    head = (room / "comparison" / "shares.csv").read_text().splitlines()[0]
    assert "a: Δ < 5 %" in head
    assert "b: Δ < 20 %" in head


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["measured.csv"],
            "no simulation is given",
        ),
        (["measured.csv", "run", "--name", "a", "--name", "b"], "2 names for 1"),
        (["missing.csv", "run"], "cannot be read"),
        (["measured.csv", "nowhere"], "cannot be read"),
    ],
)
def test_bad_input_is_one_line(call, room, run, words, message):
    outcome = call("compare", *words)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1


def test_an_obj_becomes_a_scene(call, room):
    (room / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl Oak\nf 1 2 3\n")
    (room / "m.toml").write_text("[materials]\nOak = { reflectance = 0.4 }\n")
    outcome = call("import", "a.obj", "--materials", "m.toml", "-o", "out")
    assert outcome.status == 0, outcome.err
    text = (room / "out" / "scene.rad").read_text()
    assert "void plastic Oak" in text
    assert "polygon" in text


def test_a_honeybee_room_becomes_a_study(call, room):
    sensor = {"pos": [1, 1, 1], "dir": [0, 0, 1]}
    grid = {"identifier": "g", "sensors": [sensor]}
    model = honeybee_model(box("hut", (0, 0, 0), (4, 5, 3)), sensor_grids=[grid])
    (room / "hut.hbjson").write_text(json.dumps(model))
    words = ("import", "hut.hbjson", "--weather", "two_days.wea", "-o", "hut")
    outcome = call(*words)
    assert outcome.status == 0, outcome.err
    assert "next: clerestory run hut/study.toml" in outcome.out
    study = (room / "hut" / "study.toml").read_text()
    assert 'method = "2-phase"' in study
    assert 'file = "../two_days.wea"' in study
    assert (room / "hut" / "g.pts").read_text() == "1 1 1 0 0 1\n"


def test_an_unknown_ending_is_refused(call, room):
    (room / "a.dwg").write_text("")
    outcome = call("import", "a.dwg", "-o", "out")
    assert outcome.status == 2
    assert "extension is '.dwg'; one of .hbjson" in outcome.err
