"""LM-83, LEED v4.1 and EN 17037 against honeybee-radiance-postprocess.

Three spaces, each with one window group of four tilts. Both programs operate the
blinds from the same hourly illuminance of every tilt and weight spaces by floor area.
Set CLERESTORY_HONEYBEE to a Python interpreter that has honeybee-radiance-postprocess.
"""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.control.lm83_blinds import operate_by_direct_sun
from clerestory.metrics.compliance import assess
from clerestory.metrics.space import WHOLE
from clerestory.metrics.standards import standards_named

SIDES = {"north": 0.5, "south": 0.6, "corner": 0.4}
COUNTS = {"north": 60, "south": 80, "corner": 50}
TILTS = ("open", "tilt0", "tilt45", "closed")
TOTAL, DIRECT = (1.0, 0.6, 0.4, 0.1), (1.0, 0.3, 0.01, 0.0)
HOURS = np.arange(8760)


@pytest.fixture(scope="module")
def honeybee():
    """Python interpreter of honeybee-radiance-postprocess."""
    python = os.environ.get("CLERESTORY_HONEYBEE")
    if not python:
        pytest.skip("CLERESTORY_HONEYBEE names no Python with honeybee's postprocess")
    return python


def hourly(rng, dim):
    """Total and direct illuminance of the four tilts of one space, and of the sky."""
    up = np.maximum(np.sin((HOURS % 24 - 6) / 12 * np.pi), 0)
    up *= (HOURS % 24 >= 6) & (HOURS % 24 < 18)
    total, direct = {}, {}
    for name, count in COUNTS.items():
        depth = np.linspace(0, 1, count)
        sunny = rng.random(8760) < 0.4
        reach = rng.random(8760) * (0.8 if name == "south" else 0.2)
        lit = (depth[:, None] < reach) & sunny & (up > 0)
        sun = (lit * 4e4 * up * (depth < 0.5)[:, None]).astype(np.float32)
        sky = np.exp(-dim[name] * depth)[:, None] * 3000 * up * rng.random(8760)
        total[name] = np.stack([(sky + 0.2 * sun) * t for t in TOTAL])
        direct[name] = np.stack([sun * t for t in DIRECT])
    return total, direct, up


def write_folder(folder, total, direct, up):
    """Write one light path of four states for each grid."""
    lit = np.flatnonzero(up > 0)
    info, states = [], {}
    for name, count in COUNTS.items():
        path = f"{name}_group"
        row = dict.fromkeys(("name", "identifier", "full_id"), name)
        info.append({**row, "group": "", "count": count, "light_path": [[path]]})
        states[name] = {path: list(TILTS)}
        for k, tilt in enumerate(TILTS):
            for light, values in (("total", total), ("direct", direct)):
                place = folder / path / tilt / light
                place.mkdir(parents=True)
                np.save(place / f"{name}.npy", values[name][k][:, lit].astype("f4"))
    for file, text in (
        ("grids_info.json", json.dumps(info)),
        ("grid_states.json", json.dumps(states)),
        ("sun-up-hours.txt", "\n".join(f"{h + 0.5}" for h in lit)),
        (
            "study_info.json",
            json.dumps({"timestep": 1, "study_hours": (HOURS + 0.5).tolist()}),
        ),
    ):
        (folder / file).write_text(text)


def results(total, direct):
    """Results of a run that operates the blinds of every space by LM-83."""
    grids = np.repeat(list(COUNTS), list(COUNTS.values()))
    states, lux = [], []
    for name in COUNTS:
        chosen = operate_by_direct_sun({name: direct[name]}).states[name]
        states.append(chosen)
        lux.append(np.take_along_axis(total[name], chosen[None, None], axis=0)[0])
    opened = np.concatenate([direct[name][0] for name in COUNTS])
    lux = np.concatenate(lux).astype(np.float32)
    axes, minutes = ("sensor", "time"), np.timedelta64(30, "m")
    times = np.datetime64("2023-01-01", "ns") + HOURS * np.timedelta64(1, "h") + minutes
    return xr.Dataset(
        {
            "illuminance": (axes, lux),
            "direct_open": (axes, opened.astype(np.float32)),
            "sun_hours": ("sensor", np.zeros(len(grids))),
            "grid": ("sensor", grids),
            "floor_area": ("sensor", [SIDES[name] ** 2 for name in grids]),
            "occupied": ("time", (HOURS % 24 >= 8) & (HOURS % 24 < 18)),
            "daylight_hours": ("time", (HOURS % 24 >= 6) & (HOURS % 24 < 18)),
        },
        coords={"time": times},
    ).set_coords("grid")


@pytest.mark.parametrize(
    "dim",
    [
        {"north": 1.5, "south": 1.0, "corner": 3.0},
        {"north": 0.2, "south": 0.5, "corner": 0.5},
        {"north": 4.0, "south": 3.0, "corner": 5.0},
    ],
)
def test_shares_points_and_levels_equal_those_of_the_program(honeybee, tmp_path, dim):
    total, direct, up = hourly(np.random.default_rng(3), dim)
    folder = tmp_path / "results"
    write_folder(folder, total, direct, up)
    data = results(total, direct)
    for name in COUNTS:
        part = data["illuminance"].values[data["grid"] == name]
        np.save(folder / f"daylight_hours_{name}.npy", part[:, data["daylight_hours"]])
    script = Path(__file__).with_name("postprocess_office.py")
    cells = json.dumps({name: (SIDES[name], COUNTS[name]) for name in COUNTS})
    done = subprocess.run(
        [honeybee, str(script), str(folder), cells],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    expected = json.loads(done.stdout.splitlines()[-1])
    found = {
        (one.standard, one.space): one
        for one in assess(data, standards_named(["LM-83", "LEED v4.1", "EN 17037"]))
    }
    for space, summary in (*expected["each"].items(), (WHOLE, expected["all"])):
        daylit, sunlit = found["LM-83-12", space].verdicts
        assert daylit.quantities[0].value == pytest.approx(summary["sda"], abs=0.006)
        assert sunlit.quantities[0].value == pytest.approx(summary["ase"], abs=0.006)
    points = found["LEED v4.1", WHOLE].verdicts[0].words
    credits_ = expected["all"]["credits"]
    words = {0: "0 points", 1: "1 point"}.get(credits_, f"{credits_} points")
    exemplary = credits_ == "Exemplary performance"
    assert points == ("3 points, exemplary" if exemplary else words)
    for space, kinds in expected["en17037"].items():
        provision = found["EN 17037", space].verdicts[0]
        target, minimum = kinds["Target Illuminance"], kinds["Minimum Illuminance"]
        shares = [quantity.value for quantity in provision.quantities]
        assert shares == pytest.approx(target[1:] + minimum[1:], abs=1e-9)
        assert provision.level == min(target[0], minimum[0])
