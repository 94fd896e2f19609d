"""Every kind of warning is shown once, and counted."""

import json
import re

import numpy as np
import pytest

from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.scene.view import View
from clerestory.study.results import read_results

VIEW = """
[[view]]
name = "seat"
file = "seat.vf"
resolution = 60
samples = 4
"""


@pytest.fixture
def coarse(room):
    """The study of the room, with a view of too few pixels."""
    text = (room / "study.toml").read_text()
    (room / "study.toml").write_text(text + VIEW)
    eye = "rvu -vta -vp 2 2 1.2 -vd 0 -1 0 -vh 180 -vv 180\n"
    (room / "seat.vf").write_text(eye)
    return room


def merging_warnings(text):
    return [line for line in text.splitlines() if "glare sources" in line]


def test_a_coarse_view_is_named_once_in_a_run_and_its_plan(call, coarse):
    """evalglare measures pixels along the diagonal: 0.1 rad/(√2·180°/60) is 1.35."""
    planned = merging_warnings(call("run", "study.toml", "--plan").err)
    run = call("run", "study.toml", "--out", "results", "--quiet")
    assert run.status == 0
    assert merging_warnings(run.err) == planned
    assert planned == [
        'warning: [[view]] "seat": a resolution of 60 pixels is too coarse to'
        " tell glare sources apart; 134 or more expected"
    ]
    data = read_results("results").data
    lit = np.isfinite(data["glare_dgp"].values)
    assert np.all(data["glare_dgp_error"].values[lit] > 0)
    page = (coarse / "results/report.html").read_text()
    assert re.search(r"<td>0\.\d+ ± 0\.\d+</td>", page)
    noted = json.loads((coarse / "results/run.json").read_text())["warnings"]
    assert [f"warning: {line}" for line in noted if "glare sources" in line] == planned


def test_a_view_too_small_for_glare_is_refused_before_tracing(call, coarse):
    text = (
        (coarse / "study.toml").read_text().replace("resolution = 60", "resolution = 8")
    )
    (coarse / "study.toml").write_text(text)
    outcome = call("run", "study.toml", "--out", "results", "--quiet")
    assert outcome.status == 2
    assert outcome.err == (
        '[[view]] "seat" resolution: a picture of 8 × 8 pixels; at least 21 pixels per'
        " side expected\n"
    )
    assert not list((coarse / "results").glob("matrices/*"))


def test_pictures_in_a_row_share_a_warning(call, room):
    eye = View(kind="angular", horizontal=180, vertical=180)
    names = [f"{number}.hdr" for number in range(5)]
    for name in names:
        write_picture(Picture(np.ones((40, 40, 3), np.float32), view=eye), name)
    first, last = merging_warnings(call("glare", *names).err)
    assert "the picture: a resolution of " in first
    assert last == f"{first} (5 such warnings)"
    assert len(merging_warnings(call("glare", *names, "--annual", "year.csv").err)) == 1
