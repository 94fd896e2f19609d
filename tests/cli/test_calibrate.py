"""`clerestory calibrate` and `optimise` in a small room."""

import json

import numpy as np
import pytest
import xarray as xr
from lxml import html
from scipy import stats

from clerestory.metrics.en17037 import LEVELS, MINIMUM_LUX, TARGET_LUX
from clerestory.study.variants import read_variants
from uncertain_room import MATERIALS, unknown, write_room

GOALS = """
[optimise]
candidates = 64
designs = 2
[[optimise.variable]]
kind = "reflectance"
material = "ceiling"
low = 0.5
high = 0.9
[[optimise.goal]]
figure = "hours with 300 lux or more"
[[optimise.goal]]
figure = "hours above the useful range"
"""


def measured_room(folder, call):
    """Run a room of other walls; return the table of its illuminance."""
    other = MATERIALS | {"wall": 0.65}
    file = write_room(folder, reflectances=other, samples=60_000)
    file.write_text(file.read_text().replace("seed = 5", "seed = 99"))
    call("run", file, "--out", folder / "out", "--quiet")
    return folder / "out" / "illuminance_desks.csv"


def test_calibrate_finds_the_walls_of_another_room(tmp_path, call):
    """Its tables are measurements; the walls reflect 0.65 instead of 0.5."""
    measured = measured_room(tmp_path / "other", call)
    more = "[uncertainty]\n" + unknown("wall", 0.1)
    file = write_room(tmp_path / "own", samples=60_000, more=more)
    out = tmp_path / "found"
    done = call("calibrate", file, measured, "-o", out)
    assert done.status == 0
    assert "wall reflectance: 0.6" in done.out
    facts = json.loads((out / "calibration.json").read_text())
    wall = facts["quantities"]["wall reflectance"]
    assert abs(wall["value"] - 0.65) < 4 * wall["deviation"] + 0.01
    assert wall["deviation"] < 0.02
    assert len(facts["days_not_used"]) == 3
    for day in facts["days_not_used"].values():
        before, after = day["cv_rmse"]
        assert after < 0.5 * before
    page = (out / "calibration.html").read_text()
    assert "2001-06-20, not used" in page or "not used</th>" in page
    study = tmp_path / "own" / "study_calibrated.toml"
    base, calibrated = read_variants(study)
    assert (base.name, calibrated.name) == ("base", "calibrated")
    assert calibrated.study.scene.files[0].name == "calibrated_scene.rad"


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("", "no unknown quantity; [uncertainty] expected"),
        (
            "[uncertainty]\n" + unknown("wall", 0.1) + "[[uncertainty.unknown]]\n"
            'kind = "gain"\ngrid = "eyes"\n',
            'acts on grid "eyes"; one of desks expected',
        ),
    ],
)
def test_calibrate_refuses_what_it_cannot_fit(tmp_path, call, more, message):
    file = write_room(tmp_path / "own", samples=100, more=more)
    measured = tmp_path / "measured.csv"
    measured.write_text("time,desks.1\n2001-06-21T12:30,1000\n2001-06-21T13:30,900\n")
    done = call("calibrate", file, measured, "-o", tmp_path / "found")
    assert done.status == 2
    assert message in done.err
    assert done.err.count("\n") == 1


def test_optimise_writes_designs_and_their_page(tmp_path, call):
    file = write_room(tmp_path, more=GOALS, first="06-21", last="06-21", samples=500)
    done = call("optimise", file, "-o", tmp_path / "designs")
    assert done.status == 0
    assert "design 1" in done.out
    assert (tmp_path / "designs" / "designs.csv").is_file()
    page = (tmp_path / "designs" / "report.html").read_text()
    assert "<h2>Goals</h2>" in page
    assert "as it is" in page


def test_optimise_needs_its_table(tmp_path, call):
    done = call("optimise", write_room(tmp_path), "-o", tmp_path / "designs")
    assert done.status == 2
    assert "no table [optimise]" in done.err


STANDARD = """
[compliance]
standards = ["EN 17037"]

[uncertainty]
draws = 256
[[uncertainty.unknown]]
kind = "sky"
mean = 0.4
standard_deviation = 0.1
[[uncertainty.unknown]]
kind = "sun"
mean = 0.4
standard_deviation = 0.1
[[uncertainty.correlated]]
unknowns = ["sky", "sun"]
correlation = 1
"""


def test_probabilities_of_a_standard_are_those_of_the_light(tmp_path, call):
    """All light has one normal factor f: a level is reached if f is large enough.

    In half of the daylight hours, sensors reach their median, times f: half of them
    must reach the target, and all twelve (95 % of the area) the minimum of a level.
    """
    file = write_room(tmp_path / "own", samples=60_000, more=STANDARD)
    out = tmp_path / "out"
    assert call("run", file, "--out", out, "--quiet").status == 0
    with xr.open_dataset(out / "results.nc") as data:
        hours = data["daylight_hours"].values.astype(bool)
        lux = data["illuminance"].transpose("sensor", "time").values[:, hours]
        own = data["probable_criterion"].str.contains("method 2").values
        levels = data["probable_level"].values[own].tolist()
        found = dict(zip(levels, data["probability"].values[own], strict=True))
    reached = -np.sort(-lux, axis=1)[:, (hours.sum() + 1) // 2 - 1]
    brightest = -np.sort(-reached)
    of_factor = stats.norm(0.4, 0.1)
    limits = zip(TARGET_LUX, MINIMUM_LUX, strict=True)
    for level, (target, least) in zip(LEVELS[1:], limits, strict=True):
        enough = max(target / brightest[5], least / brightest[-1])
        assert found[level] == pytest.approx(of_factor.sf(enough), abs=0.04)
    assert any(0.1 < value < 0.9 for value in found.values())
    page = html.document_fromstring((out / "report.html").read_text())
    (section,) = page.xpath("//section[@id='knowledge']")
    text = " ".join(section.text_content().split())
    assert "Probability of reaching each level" in text
    assert "EN 17037" in text
