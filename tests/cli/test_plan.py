"""`clerestory run --plan`: what a run will take, before it starts."""

import re

import clerestory as cl
from clerestory.study.run_plan import plan_study


def test_a_plan_names_matrices_and_writes_nothing(call, room):
    done = call("run", "study.toml", "--plan", "--out", "results")
    assert done.status == 0
    assert re.search(r"view-south .* 4 .* 41 .* 1,024 ", done.out)
    assert re.search(r"daylight-south .* 41 .* 146 .* 10,496 ", done.out)
    assert re.search(r"tracing about \d+ s, memory about .*B,\s+disk 1 MB", done.out)
    assert not (room / "results").exists()


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


def test_pictures_are_part_of_the_plan(room):
    """All that a run traces is asked for, direct suns of pictures too."""
    (room / "seat.vf").write_text("rvu -vta -vp 2 2 1.2 -vd 0 -1 0 -vh 180 -vv 180\n")
    text = (room / "study.toml").read_text().replace("3-phase", "5-phase")
    view = '[[view]]\nname = "seat"\nfile = "seat.vf"\nresolution = 136\nsamples = 16\n'
    (room / "study.toml").write_text(text + view)
    names = [m.file for m in plan_study(cl.read_study("study.toml"), out="r").matrices]
    kinds = {name.rpartition("-")[0] for name in names}
    assert kinds == {
        "view-south",
        "daylight-south",
        "direct-view-south",
        "direct-daylight-south",
        "sun-south",
        "picture-seat-south",
        "direct-picture-seat-south",
        "picture-sun-seat-south",
    }
