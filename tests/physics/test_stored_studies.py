"""Studies whose matrices and hours lie in files give what those in memory give."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.engine import controller, cost_estimate
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.phases import stored_views
from clerestory.study import results as study_results
from clerestory.study.config import read_study
from clerestory.study.results import read_results
from clerestory.study.run_plan import plan_study
from clerestory.study.study_run import run_study

ROOM = Path(__file__).parents[1] / "cli" / "room"

STATES = """
[[window.state]]
name = "open"
bsdf = "open.xml"
[[window.state]]
name = "closed"
bsdf = "closed.xml"
"""
RULES = {
    "one state": "",
    "facade": 'rule = "threshold"\nclose_above = 100',
    "LM-83": 'rule = "LM-83"',
    "sensors": 'rule = "best"\ngrid = "desk"\nlux_below = 3000',
}

# Too little for the matrices with their errors, enough for rules to look at them
FEW_GB = 1.4e-5


@pytest.fixture
def write(tmp_path, monkeypatch):
    """The room of ten polygons, two sensors a block; returns what writes a study."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    for name, tau in (("open", 0.5), ("closed", 0.05)):
        write_bsdf(folder / f"{name}.xml", lambertian(tau, klems("quarter")))
    plain = (folder / "study.toml").read_text()
    row = 41 * 16 * 8  # patches, batches, bytes of a sum
    monkeypatch.setattr(controller, "_SUMS", 2 * row)
    monkeypatch.setattr(study_results, "_LARGE", 100)
    monkeypatch.setattr(cost_estimate, "_PILOT_PATHS", 1 << 12)

    def written(rule="", memory_gb=8.0):
        control = f"[window.control]\n{rule}\n" if rule else ""
        text = plain.replace(
            'bsdf = "diffuser.xml"\n',
            STATES + control if rule else 'bsdf = "open.xml"\n',
        )
        text = text.replace("[trace]", f"[trace]\nmemory_gb = {memory_gb}")
        (folder / "study.toml").write_text(text)
        return read_study(folder / "study.toml")

    return written


@pytest.mark.parametrize(
    "rule",
    [pytest.param(r, marks=[pytest.mark.slow] * (r != "facade")) for r in RULES],
)
def test_light_is_the_same_and_its_error_alike(write, tmp_path, rule):
    """Values are traced alike, and stored as single precision, ε = 6e-8."""
    held = run_study(write(RULES[rule]), out=tmp_path / "held").data
    stored = run_study(write(RULES[rule], FEW_GB), out=tmp_path / "stored").data
    assert not list((tmp_path / "held/matrices").glob("views-*"))
    assert len(list((tmp_path / "stored/matrices").glob("views-*"))) == 2
    names = ["illuminance", "direct_open", "mean_illuminance", "daylight_autonomy"]
    for name in [name for name in names if name in held]:
        scale = float(held[name].max())
        np.testing.assert_allclose(
            stored[name], held[name], rtol=1e-5, atol=1e-6 * scale
        )
    lit = held["standard_error"].values > 0
    ratio = [np.mean(d["standard_error"].values[lit] ** 2) for d in (stored, held)]
    assert 0.4 < ratio[0] / ratio[1] < 2.5
    if "state" in held:
        assert np.array_equal(stored["state"], held["state"])


def test_results_in_files_hold_all_and_are_the_same_again(write, tmp_path):
    study = write(RULES["facade"], 0.0)
    results = run_study(study, out=tmp_path / "one")
    first = (tmp_path / "one/results.nc").read_bytes()
    run_study(study, out=tmp_path / "one")
    assert (tmp_path / "one/results.nc").read_bytes() == first
    xr.testing.assert_identical(read_results(tmp_path / "one").data, results.data)
    held = run_study(write(RULES["facade"]), out=tmp_path / "held")
    assert set(held.data.variables) == set(results.data.variables)
    assert not (tmp_path / "one/unfinished").exists()
    for table in ("metrics.csv", "illuminance_desk.csv", "desk.ill", "states.csv"):
        ours, theirs = ((tmp_path / n / table).read_text() for n in ("one", "held"))
        assert ours.count("\n") == theirs.count("\n")
        assert ours.split("\n")[0] == theirs.split("\n")[0]


def test_a_run_that_was_killed_goes_on_with_the_next_block(
    write, tmp_path, monkeypatch
):
    study, traced = write(RULES["facade"], 0.0), []
    real = stored_views.estimate_rows

    def dies(job, rows, effort, **more):
        if rows.start:
            raise KeyboardInterrupt
        return counts(job, rows, effort, **more)

    def counts(job, rows, effort, **more):
        traced.append(rows.start)
        return real(job, rows, effort, **more)

    monkeypatch.setattr(stored_views, "estimate_rows", dies)
    with pytest.raises(KeyboardInterrupt):
        run_study(study, out=tmp_path / "out")
    plan = plan_study(study, out=tmp_path / "out")
    assert [m.paths for m in plan.matrices if m.stored] == [512]  # of 4 times 256
    monkeypatch.setattr(stored_views, "estimate_rows", counts)
    results = run_study(study, out=tmp_path / "out")
    assert traced == [0, 2]
    assert plan_study(study, out=tmp_path / "out").seconds == 0
    whole = run_study(study, out=tmp_path / "whole")
    xr.testing.assert_identical(results.data, whole.data)


@pytest.mark.slow
def test_a_damaged_block_is_traced_again(write, tmp_path):
    study = write("", 0.0)
    first = run_study(study, out=tmp_path)
    file = next((tmp_path / "matrices").glob("views-0002-*"))
    file.write_bytes(file.read_bytes()[:-200])
    with pytest.warns(UserWarning, match="traced again"):
        again = run_study(study, out=tmp_path)
    xr.testing.assert_identical(first.data, again.data)
    found = json.loads((tmp_path / "run.json").read_text())["matrices"]
    assert {name.split("-")[0] for name in found} == {"views", "daylight"}


def test_the_plan_counts_stored_blocks_as_one(write, tmp_path):
    study = write(RULES["LM-83"], FEW_GB)
    plan = plan_study(study, out=tmp_path / "out")
    stored = {m.file.rpartition("-")[0]: m for m in plan.matrices if m.stored}
    assert list(stored) == ["views", "direct-views"]
    assert stored["views"].rows == 4
    assert stored["views"].paths == 4 * 256


def test_rules_that_look_at_more_than_memory_holds_are_refused(write, tmp_path):
    with pytest.raises(InputError, match="requires 3 sensors at a time"):
        run_study(write(RULES["sensors"], 0.0), out=tmp_path)


def test_methods_that_hold_all_in_memory_say_so(write, tmp_path):
    study = write("", 0.0).with_method("5-phase")
    with pytest.warns(UserWarning, match="the 5-phase method keeps all matrices"):
        plan_study(study, out=tmp_path)
