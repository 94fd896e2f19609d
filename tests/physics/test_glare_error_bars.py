"""The ± of glare indices in studies is their scatter over runs with other seeds.

The edges of a diffusing window cross the threshold of glare sources. An index may jump
with a row of pixels, so ± and scatter are compared at many moments with glare sources.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.study.config import Study, read_study
from clerestory.study.study_run import run_study

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.*too coarse to tell glare sources"),
]

ROOM = Path(__file__).parents[1] / "cli" / "room"
SEEDS = [6763 * (number + 1) for number in range(40)]

NAMES = ("dgp", "illuminance", "dgi", "ugr", "cgi", "ugp", "vcp", "dgr")

STUDY = """
title = "Repeated"
method = "{method}"
[scene]
files = ["room.rad"]
[[window]]
name = "south"
file = "window.rad"
bsdf = "diffuser.xml"
[[sensors]]
file = "desk.pts"
[[view]]
name = "towards"
file = "towards.vf"
resolution = 56
[[view]]
name = "aside"
file = "aside.vf"
resolution = 56
[weather]
file = "days.wea"
[sky]
subdivision = 1
"""


def study(folder: Path, method: str) -> Study:
    """The room of ten polygons, two views, 28 moments from overcast to clear."""
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "diffuser.xml", lambertian(0.5, klems("quarter")))
    lines = ["place Test\nlatitude 47\nlongitude -8\ntime_zone -15\nsite_elevation 400"]
    lines += ["weather_data_file_units 1"]
    for day in range(7):
        for hour in (9.5, 11.5, 13.5, 15.5):
            height = 0.3 + 0.08 * day
            normal, diffuse = 110 * day, 100 + 40 * ((3 * day + int(hour)) % 7)
            lines.append(f"{day + 3} 15 {hour} {normal * height:.0f} {diffuse}")
    (folder / "days.wea").write_text("\n".join(lines) + "\n")
    for name, eye in (
        ("towards", "2 3.5 1.2 -vd 0 -1 0"),
        ("aside", "1.2 3 1.2 -vd 1 -0.6 0"),
    ):
        view = f"rvu -vta -vp {eye} -vu 0 0 1 -vh 180 -vv 180\n"
        (folder / f"{name}.vf").write_text(view)
    (folder / "study.toml").write_text(STUDY.format(method=method))
    return read_study(folder / "study.toml")


@pytest.fixture(scope="module", params=["3-phase", "5-phase"])
def runs(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("repeated")
    repeated, found = study(folder / "study", request.param), []
    for seed in SEEDS:
        chosen = repeated.with_trace(seed=seed, device="cpu", cluster=None)
        data = run_study(chosen, out=folder / "out").data
        shutil.rmtree(folder / "out")
        found.append(
            {
                name: (data[f"glare_{name}"].values, data[f"glare_{name}_error"].values)
                for name in NAMES
            }
        )
    return found


@pytest.mark.parametrize("name", NAMES)
def test_glare_in_studies_scatters_as_stated(runs, name):
    """The median over moments: at some, one run of forty shows a jump."""
    values, errors = (np.array([run[name][part] for run in runs]) for part in (0, 1))
    scatter = values.std(axis=0, ddof=1)
    seen = (np.array([run["dgr"][0] for run in runs]).min(axis=0) > 0) & (scatter > 0)
    assert seen.sum() > 20
    ratio = np.sqrt(np.square(errors).mean(axis=0))[seen] / scatter[seen]
    assert 0.8 < np.median(ratio) < 1.25
