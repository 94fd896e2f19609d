"""`clerestory run --plan`: what a run will take, before it starts."""

import json
import re
import time
from collections import Counter
from contextlib import contextmanager

import pytest

import clerestory as cl
from clerestory.study.run_log import RunLog
from clerestory.study.run_plan import plan_study


def test_a_plan_names_matrices_and_writes_nothing(call, room):
    done = call("run", "study.toml", "--plan", "--out", "results")
    assert done.status == 0
    assert re.search(r"view-south .* 4 .* 41 .* 1,024 ", done.out)
    assert re.search(r"daylight-south .* 41 .* 146 .* 10,496 ", done.out)
    assert re.search(r"multiply .* 4 sensors, 48 steps .*\d s", done.out)
    assert re.search(r"about (< )?\d+ s, memory about .*B,\s+disk 1 MB", done.out)
    assert not (room / "results").exists()


def test_matrices_of_variants_have_one_line(call, room):
    """Another seed: each matrix is traced twice, with as many paths."""
    text = (room / "study.toml").read_text()
    variant = '[[variant]]\nname = "other seed"\ntrace.seed = 2\n'
    (room / "study.toml").write_text(text + variant)
    done = call("run", "study.toml", "--plan", "--out", "results")
    assert done.status == 0, done.err
    assert re.search(r"2 × view-south .* 4 .* 41 .* 2,048 ", done.out)
    assert len(re.findall("view-south", done.out)) == 1


def test_what_an_earlier_run_kept_costs_nothing(call):
    assert call("run", "study.toml", "--out", "results", "--quiet").status == 0
    done = call("run", "study.toml", "--plan", "--out", "results")
    assert len(re.findall("kept", done.out)) == 2
    plan = plan_study(cl.read_study("study.toml"), out="results")
    assert plan.seconds == 0
    assert all(matrix.kept for matrix in plan.matrices)


def test_sizes_on_disk_are_those_of_the_files(call, room):
    """Files hold HDF5's tables besides, and chunks that are not full."""
    assert call("run", "study.toml", "--out", "results", "--quiet").status == 0
    plan = plan_study(cl.read_study("study.toml"), out="elsewhere")
    for matrix in plan.matrices:
        size = (room / "results/matrices" / matrix.file).stat().st_size
        assert matrix.bytes <= size < 1.15 * matrix.bytes + 30_000


@pytest.fixture
def view(room):
    """The room with a five-phase study and a view, of which a picture is written."""
    (room / "seat.vf").write_text("rvu -vta -vp 2 2 1.2 -vd 0 -1 0 -vh 180 -vv 180\n")
    text = (room / "study.toml").read_text().replace("3-phase", "5-phase")
    view = (
        '[[view]]\nname = "seat"\nfile = "seat.vf"\nresolution = 136\nsamples = 16\n'
        'pictures = ["06-21T09:30", "06-21T12:30"]\n'
    )
    (room / "study.toml").write_text(text + view)
    return room


def test_a_plan_has_the_stages_the_pictures_and_the_files_of_the_run(view):
    """Compressed pictures and the drawings in results.nc depend on their content."""
    study = cl.read_study("study.toml")
    plan = plan_study(study, out="results")
    glare = cl.run_study(study, out="results").data["glare_dgp"]
    run = json.loads((view / "results/run.json").read_text())
    assert set(plan.stages) == set(run["seconds"])
    folders = {"pictures": "results/pictures/*.hdr", "write": "results/*.*"}
    for stage, files in folders.items():
        written = [f for f in view.glob(files) if f.suffix != ".lock"]
        assert plan.stages[stage].files == len(written), stage
        size = sum(file.stat().st_size for file in written)
        assert size / 1.5 < plan.stages[stage].bytes < size * 1.5, stage
    computed = int(glare.notnull().sum())
    assert plan.stages["pictures"].work == f"glare at {computed} steps, 2 pictures"
    sizes = {file.name: file.stat().st_size for file in view.glob("results/matrices/*")}
    assert {matrix.file for matrix in plan.matrices} == set(sizes)
    for matrix in plan.matrices:
        size = sizes[matrix.file]
        assert matrix.bytes <= size < 1.2 * matrix.bytes + 100_000, matrix.file


def test_a_plan_estimates_standards_and_unknown_quantities(room):
    text = (room / "study.toml").read_text()
    more = '[compliance]\nstandards = ["LM-83", "EN 17037"]\n\n[uncertainty]\n'
    kinds = ('"dirt"', '"sky"')
    more += "".join(f"[[uncertainty.unknown]]\nkind = {kind}\n" for kind in kinds)
    (room / "study.toml").write_text(text + more)
    stages = plan_study(cl.read_study("study.toml"), out="results").stages
    assert stages["compliance"].work == "2 standards"
    assert stages["uncertainty"].work == "2,048 draws"
    assert stages["compliance"].seconds > 0
    assert stages["uncertainty"].seconds > 0


def test_a_plan_after_a_run_has_the_times_of_the_run(view):
    study = cl.read_study("study.toml")
    cl.run_study(study, out="results")
    seconds = json.loads((view / "results/run.json").read_text())["seconds"]
    stages = plan_study(study, out="results").stages
    found = {name: cost.seconds for name, cost in stages.items()}
    # Only the paths from pixels to the windows are traced again
    assert 0 < found.pop("trace") < seconds.pop("trace")
    assert found == seconds
    other = study.with_trace(seed=8)
    assert plan_study(other, out="results").stages["trace"].seconds > 0
    assert plan_study(other, out="results").stages["write"].seconds != seconds["write"]


def test_a_moment_without_light_is_found_before_the_run(view, call):
    text = (view / "study.toml").read_text().replace("06-21T12:30", "06-21T01:30")
    (view / "study.toml").write_text(text)
    done = call("run", "study.toml", "--plan")
    assert done.status != 0
    assert 'view "seat": no step with light at 06-21T01:30' in done.err


@pytest.mark.slow
@pytest.mark.parametrize("method", ["3-phase", "5-phase"])
def test_products_pictures_and_glare_take_the_planned_time(view, method, monkeypatch):
    """Processor time, as other programs share the cores."""
    spent = Counter()
    phase = RunLog.phase

    @contextmanager
    def measured(self, name):
        start = time.process_time()
        with phase(self, name):
            yield
        spent[name] += time.process_time() - start

    study = cl.read_study("study.toml").with_method(method)
    plan = plan_study(study, out="results")
    monkeypatch.setattr(RunLog, "phase", measured)
    cl.run_study(study, out="results")
    after = ("control", "multiply", "pictures", "metrics", "write")
    planned = sum(plan.stages[name].seconds for name in after)
    assert 1 / 3 < planned / sum(spent[name] for name in after) < 3


def test_all_matrices_of_pictures_are_part_of_the_plan(view):
    """All that a run stores is asked for; paths to the windows are not stored."""
    names = [m.file for m in plan_study(cl.read_study("study.toml"), out="r").matrices]
    kinds = {name.rpartition("-")[0] for name in names}
    assert kinds == {
        "view-south",
        "daylight-south",
        "direct-view-south",
        "direct-daylight-south",
        "sun-south",
        "picture-seat-reflected-south",
    }
