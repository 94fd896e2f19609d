"""Sensitivities of whole studies against studies with other materials."""

import csv
import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.report.page import write_report
from clerestory.study.config import read_study
from clerestory.study.study_run import run_study
from uncertain_room import unknown

ROOM = Path(__file__).parents[1] / "cli" / "room"
STEP = 0.1
GREY = ".5 .5 .5"

# Port of the four- and six-phase methods, in front of the window
PORTS = """#@rfluxmtx h=kq u=Z
void polygon front
0
0
12 4 -0.5 0.5  0 -0.5 0.5  0 -0.5 3  4 -0.5 3
"""


@pytest.fixture
def files(tmp_path):
    """Files of the room of ten polygons behind a diffuser."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "diffuser.xml", lambertian(0.5, klems("quarter")))
    (folder / "ports.rad").write_text(PORTS)
    return folder


def run(folder, out, *, method="3-phase", reflectance=None, seed=1, table=""):
    """Results of the study, with another reflectance of the grey surfaces."""
    text = (ROOM / "study.toml").read_text()
    text = text.replace('"3-phase"', f'"{method}"').replace(
        "seed = 7", f"seed = {seed}"
    )
    text = text.replace("samples = 256", "samples = 16384")
    if method in ("4-phase", "6-phase"):
        own = 'bsdf = "diffuser.xml"\n'
        text = text.replace(own, f'{own}ports = "ports.rad"\n')
    (folder / "study.toml").write_text(f"{text}\n{table}")
    scene = (ROOM / "room.rad").read_text()
    if reflectance is not None:
        grey = " ".join([f"{reflectance:g}"] * 3)
        first, rest = scene.split("plastic grey", 1)
        numbers = rest.split("\n", 4)
        numbers[3] = f"5 {grey} 0 0"
        scene = f"{first}plastic grey" + "\n".join(numbers)
    (folder / "room.rad").write_text(scene)
    return run_study(read_study(folder / "study.toml"), out=out)


@pytest.mark.parametrize(
    "method",
    [
        "3-phase",
        pytest.param("2-phase", marks=pytest.mark.slow),
        pytest.param("5-phase", marks=pytest.mark.slow),
        pytest.param("4-phase", marks=pytest.mark.slow),
        pytest.param("6-phase", marks=pytest.mark.slow),
    ],
)
def test_changes_are_those_of_studies_with_other_walls(files, tmp_path, method):
    """Second order is exact within a hundredth of the change here."""
    table = f'[sensitivity]\nmaterials = "all"\nstep = {STEP}\n'
    found = run(files, tmp_path / "a", method=method, table=table)
    data = found.data.sel(parameter="grey", figure="mean illuminance")
    value = float(data["sensitivity_value"])
    for side, sign in (("less", -1), ("more", 1)):
        other = run(
            files, tmp_path / side, method=method, reflectance=value + sign * STEP,
            seed=2 + sign,
        ).data  # fmt: skip
        hours = other["occupied"].values.astype(bool)
        for place in data["place"].values.tolist():
            one = data.sel(change=side, place=place)
            here = other["grid"].values == place
            mean = other["illuminance"].values[here][:, hours].mean()
            spread = np.sqrt(
                np.square(other["mean_illuminance_error"].values[here]).mean()
            )
            change = mean - float(one["sensitivity_base"])
            both = 2 * spread + float(one["sensitivity_error"])
            assert abs(float(one["sensitivity"]) - change) < 3 * both + 0.02 * abs(
                change
            )
            assert np.sign(change) == sign


def test_table_and_report_have_the_changes(files, tmp_path):
    table = '[sensitivity]\nmaterials = ["grey"]\n'
    found = run(files, tmp_path / "out", table=table)
    with (tmp_path / "out" / "sensitivity.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["material"] for row in rows} == {"grey"}
    assert {row["step"] for row in rows} == {"0.05", "-0.05"}
    write_report(found, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "Which material changes the result most" in page
    assert "+0.05 on grey: mean illuminance of desk +" in page


def shaded(text):
    """The study with two shade states, and a view away from the window."""
    states = "".join(
        f'[[window.state]]\nname = "{name}"\nbsdf = "diffuser.xml"\n\n'
        for name in ("open", "closed")
    )
    view = """[[view]]
name = "wall"
position = [1.5, 2.0, 1.2]
direction = [0, 1, 0]
resolution = 140
samples = 4

"""
    text = text.replace('bsdf = "diffuser.xml"\n', "")
    return text.replace("[[sensors]]", states + view + "[[sensors]]", 1)


def test_changes_of_glare_are_in_table_and_report(files, tmp_path):
    """A view of a wall, without glare sources: DGP rises with the light at the eye."""
    table = '[sensitivity]\nmaterials = ["grey"]\nglare = true\n'
    text = shaded((ROOM / "study.toml").read_text())
    (files / "study.toml").write_text(f"{text}\n{table}")
    found = run_study(read_study(files / "study.toml"), out=tmp_path / "out")
    data = found.data
    assert data["glare_sensitivity"].dims == (
        "parameter", "change", "glare_figure", "view",
    )  # fmt: skip
    assert data["view"].values.tolist() == ["wall"]
    one = data.sel(view="wall", glare_figure="mean DGP", parameter="grey")
    less, more = one["glare_sensitivity"].values
    error = one["glare_sensitivity_error"].values
    assert less < -3 * error[0]
    assert more > 3 * error[1]
    with (tmp_path / "out" / "sensitivity.csv").open(newline="") as stream:
        rows = [r for r in csv.DictReader(stream) if r["grid"] == "wall"]
    assert {row["metric"] for row in rows} >= {"mean DGP"}
    assert {row["step"] for row in rows} == {"0.05", "-0.05"}
    write_report(found, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "Changes in wall" in page
    assert "mean DGP, now" in page


def test_glare_without_a_view_is_refused(files, tmp_path):
    with pytest.raises(InputError, match="glare without a view that is wide enough"):
        run(files, tmp_path, table='[sensitivity]\nmaterials = "all"\nglare = true\n')


@pytest.mark.slow
def test_uncertain_walls_behind_ports_are_those_of_traced_rooms(files, tmp_path):
    """Draws far from the model, expanded and traced again with the same seeds."""
    table = f"[uncertainty]\ndraws = 128\nchecks = 2\n{unknown('grey', 0.05)}"
    data = run(files, tmp_path / "out", method="4-phase", table=table).data
    assert not data["check_fails"].values.any()
    traced, expanded = (data[f"check_{n}"].values[:, 0] for n in ("traced", "expanded"))
    assert np.abs(traced / data["known_figure_value"].values[0] - 1).max() > 0.05
    assert expanded == pytest.approx(traced, rel=0.02)


def test_glare_with_ports_is_refused(files, tmp_path):
    """Derivatives of illuminance are computed; glare behind ports is not tested."""
    table = '[sensitivity]\nmaterials = "all"\nglare = true\n'
    with pytest.raises(InputError, match='glare with method "4-phase"'):
        run(files, tmp_path, method="4-phase", table=table)


def test_an_unknown_material_is_named_before_tracing(files, tmp_path):
    with pytest.raises(InputError, match=r"\[sensitivity\] materials: .*door"):
        run(files, tmp_path, table='[sensitivity]\nmaterials = ["door"]\n')
