"""Two-phase studies with coefficients in files give what those in memory give."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.engine import controller
from clerestory.study import results as study_results
from clerestory.study.config import read_study
from clerestory.study.run_plan import plan_study
from clerestory.study.study_run import run_study

ROOM = Path(__file__).parents[1] / "cli" / "room"

WINDOW = """
[[window]]
name = "south"
file = "window.rad"
bsdf = "diffuser.xml"
"""

PANE = """
void glass {name}
0
0
3 {transmissivity}

{name} polygon pane
0
0
12  3 0 1  1 0 1  1 0 2.5  3 0 2.5
"""

# Transmissivity of glass in bands, in grey and in colour
GLASS = {"grey": "0.8 0.8 0.8", "coloured": "0.9 0.8 0.6"}


@pytest.fixture
def write(tmp_path, monkeypatch):
    """The room of ten polygons behind glass, a sensor a block."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    plain = (folder / "study.toml").read_text().replace(WINDOW, "")
    monkeypatch.setattr(controller, "_SUMS", 1)
    monkeypatch.setattr(study_results, "_LARGE", 100)

    def written(glass, memory_gb=8.0, places="exact"):
        pane = PANE.format(name="glass_pane", transmissivity=GLASS[glass])
        (folder / "window.rad").write_text(pane)
        text = plain.replace('"room.rad"', '"room.rad", "window.rad"')
        text = text.replace("3-phase", "2-phase")
        text = text.replace("[trace]", f"[trace]\nmemory_gb = {memory_gb}")
        text += f'\n[sun]\nplaces = "{places}"\nsamples = 256\n'
        (folder / "study.toml").write_text(text)
        return read_study(folder / "study.toml")

    return written


@pytest.mark.parametrize("places", ["exact", "patches"])
@pytest.mark.parametrize("glass", GLASS)
def test_light_is_the_same_and_its_error_alike(write, tmp_path, glass, places):
    """Values are traced alike, and stored as single precision, ε = 6e-8."""
    held = run_study(write(glass, places=places), out=tmp_path / "held").data
    stored = run_study(write(glass, 0.0, places), out=tmp_path / "stored").data
    files = [f.name for f in (tmp_path / "stored/matrices").glob("*.nc")]
    kinds = {name.split("-")[0] for name in files}
    assert kinds == {"coefficients", "sun"} if places == "exact" else {"coefficients"}
    assert len(files) == len(kinds) * held.sizes["sensor"]
    names = {"illuminance", "direct_sun", "mean_illuminance", "daylight_autonomy"}
    for name in names & set(held):
        scale = float(held[name].max())
        np.testing.assert_allclose(
            stored[name], held[name], rtol=2e-5, atol=2e-6 * scale
        )
    lit = held["standard_error"].values > 0
    ratio = [np.mean(d["standard_error"].values[lit] ** 2) for d in (stored, held)]
    assert 0.4 < ratio[0] / ratio[1] < 2.5


def test_a_second_run_uses_the_files_of_the_first(write, tmp_path):
    study = write("grey", 0.0)
    first = run_study(study, out=tmp_path)
    assert plan_study(study, out=tmp_path).seconds == 0
    xr.testing.assert_identical(run_study(study, out=tmp_path).data, first.data)
