"""Two-phase studies with coefficients in files give what those in memory give."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.engine import controller
from clerestory.metrics.space import DIRECT
from clerestory.phases import illuminance as hourly
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.study import results as study_results
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.results import read_results
from clerestory.study.run_plan import plan_study
from clerestory.study.study_run import run_study
from clerestory.study.study_skies import study_skies
from clerestory.study.study_tracing import trace_study

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


@pytest.mark.parametrize("memory_gb", [8.0, 0.0])
def test_the_direct_sun_by_itself_is_the_term_of_all_light(write, tmp_path, memory_gb):
    """Its error is that of C_ds alone, and at most that of all light."""
    study = write("grey", memory_gb)
    run_study(study, out=tmp_path)
    data = read_results(tmp_path).data
    np.testing.assert_array_equal(data["direct_open"], data["direct_sun"])
    lit = data["direct_open"] > 0
    assert np.all(data["direct_open_error"].values[~lit] == 0)
    store = MatrixStore(tmp_path / "matrices")
    job = Job(study, read_inputs(study), store, silent, scratch=tmp_path)
    matrices = trace_study(job)
    skies = study_skies(study, job.inputs, matrices.suns)
    alone = matrices.direct_illuminance(skies, [])
    for name, own in DIRECT.items():
        np.testing.assert_array_equal(data[own], alone[name])


def test_hourly_values_are_written_once(write, tmp_path, monkeypatch):
    """The file of hourly values becomes that of the results."""
    files, read = [], hourly.read_hourly

    def noted(path, axes):
        files.append(path.stat().st_ino)
        return read(path, axes)

    monkeypatch.setattr(hourly, "read_hourly", noted)
    run_study(write("grey", 0.0), out=tmp_path)
    assert files == [(tmp_path / "results.nc").stat().st_ino]
