"""Search of designs: Pareto fronts by brute force, windows, and whole optimisations."""

import csv
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.radiance.window_reader import read_windows
from clerestory.study.config import read_study
from clerestory.study.design_glare import GLARE, quadratic_basis
from clerestory.study.design_run import optimise_study, reduced_windows
from clerestory.study.design_search import (
    candidates,
    chosen_designs,
    figure_names,
    inputs_of,
    named_figure,
    non_dominated,
    spread,
)
from clerestory.study.job import Job
from clerestory.study.optimise_tables import GoalTable
from clerestory.study.variants import read_variants
from uncertain_room import write_room

VARIABLES = """[optimise]
candidates = 64
designs = 3

[[optimise.variable]]
kind = "reflectance"
material = "ceiling"
low = 0.5
high = 0.9

[[optimise.variable]]
kind = "reflectance"
material = "wall"
low = 0.3
high = 0.7
"""
LIGHT = '[[optimise.goal]]\nfigure = "mean illuminance"\n'
DARK = '[[optimise.goal]]\nfigure = "hours above the useful range"\naim = "less"\n'


def test_the_front_is_that_of_all_pairs():
    values = np.random.default_rng(1).integers(0, 12, (200, 3)).astype(float)
    found = non_dominated(values)
    for k, own in enumerate(values):
        better = (values >= own).all(axis=1) & (values > own).any(axis=1)
        equal = (values == own).all(axis=1)
        first = np.flatnonzero(equal)[0] == k
        assert found[k] == (not better.any() and first)


def test_chosen_designs_have_the_best_of_each_goal():
    angle = np.linspace(0, np.pi / 2, 101)
    front = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    chosen = spread(front, 3)
    assert sorted(chosen) == [0, 50, 100]


def test_a_share_of_a_window_has_that_area_about_the_same_centre(tmp_path):
    text = "#@rfluxmtx h=kf u=+Z\nvoid glow g 0 0 4 1 1 1 0\n"
    text += "g polygon pane 0 0 12 0 0 1 0 0 3 2 0 3 2 0 1\n"
    (tmp_path / "whole.rad").write_text(text)
    whole = read_windows(tmp_path / "whole.rad")
    (tmp_path / "half.rad").write_text(reduced_windows(whole, 0.5))
    (half,) = read_windows(tmp_path / "half.rad")
    assert half.area == pytest.approx(0.5 * whole[0].area)
    centres = [w.polygons[0].vertices.mean(axis=0) for w in (half, whole[0])]
    assert centres[0] == pytest.approx(centres[1])
    assert half.frame.up == pytest.approx(whole[0].frame.up)
    assert half.frame.normal == pytest.approx(whole[0].frame.normal)
    assert len(half.partition) == len(whole[0].partition)


def test_an_unknown_figure_is_refused_with_the_known_ones():
    keys = figure_names(300, ["desks"])
    with pytest.raises(InputError, match="mean illuminance; hours with 300 lux"):
        named_figure(GoalTable(figure="brightness"), keys)
    with pytest.raises(InputError, match='grid "eyes"; one of desks expected'):
        named_figure(GoalTable(figure="mean illuminance", place="eyes"), keys)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (VARIABLES, "goal"),
        (VARIABLES.replace("0.5\n", "0.95\n") + LIGHT, '"low" is not below "high"'),
        (
            VARIABLES.replace('material = "wall"', 'window = "wall"') + LIGHT,
            'kind "reflectance"; "material", and no "window", expected',
        ),
        (VARIABLES + LIGHT + '[[optimise.limit]]\nfigure = "x"\n', 'without "least"'),
        (VARIABLES.replace("64", "60") + LIGHT, "a power of two"),
    ],
)
def test_wrong_tables_are_refused(tmp_path, table, message):
    with pytest.raises(InputError) as caught:
        read_study(write_room(tmp_path, more=table))
    assert message in str(caught.value)


def optimised(folder, goals):
    more = VARIABLES + goals
    file = write_room(folder, more=more, first="06-21", last="06-21", samples=1000)
    return optimise_study(read_variants(file), out=folder / "out")


def test_most_light_is_that_of_the_brightest_surfaces(tmp_path):
    found = optimised(tmp_path, LIGHT)
    (best,) = found.designs
    assert best.values == pytest.approx(
        {"ceiling reflectance": 0.9, "wall reflectance": 0.7}
    )
    key = "mean illuminance", "desks"
    assert found.runs[1].of(key).value > found.runs[0].of(key).value
    # The run in full agrees with the expansion
    assert found.runs[1].of(key).value == pytest.approx(best.figures[key], rel=0.03)


def test_a_limit_is_kept_and_the_table_tells_what_was_run(tmp_path):
    limit = '[[optimise.limit]]\nfigure = "mean illuminance"\nmost = 2000\n'
    found = optimised(tmp_path, LIGHT + DARK + limit)
    key = "mean illuminance", "desks"
    assert 1 <= len(found.designs) <= 3
    for design in found.designs:
        assert design.figures[key] <= 2000
        assert 0.5 <= design.values["ceiling reflectance"] <= 0.9
    with (tmp_path / "out" / "designs.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert {row["within limits"] for row in rows} <= {"yes", "no"}
    own = [row for row in rows if row["figure"] == "mean illuminance"]
    for row, run in zip(own, found.runs[1:], strict=True):
        assert float(row["run"]) == pytest.approx(run.of(key).value, rel=1e-4)


def test_impossible_limits_are_refused(tmp_path):
    limit = '[[optimise.limit]]\nfigure = "mean illuminance"\nleast = 1e6\n'
    with pytest.raises(InputError, match="no design is within the limits"):
        optimised(tmp_path, LIGHT + limit)


def shaded_study(folder, text):
    """The room of the command-line tests under a bright sky, with two shade states."""
    shutil.copytree(Path(__file__).parents[2] / "cli" / "room", folder)
    for name, passed in (("bright", 0.6), ("dim", 0.1)):
        write_bsdf(folder / f"{name}.xml", lambertian(passed, klems("quarter")))
    weather = folder / "two_days.wea"
    lines = weather.read_text().splitlines()
    bright = [
        f"{head} {4 * float(diffuse):g}"
        for head, diffuse in (line.rsplit(" ", 1) for line in lines[6:])
    ]
    weather.write_text("\n".join([*lines[:6], *bright]) + "\n")
    file = folder / "study.toml"
    study = file.read_text().replace('bsdf = "diffuser.xml"\n', "")
    states = "".join(
        f'\n[[window.state]]\nname = "{name}"\nbsdf = "{name}.xml"\n'
        for name in ("bright", "dim")
    )
    head, rest = study.split("[[sensors]]", 1)
    file.write_text(f"{head}{states}\n{text}\n[[sensors]]{rest}")
    return file


VIEW = """
[[view]]
name = "chair"
position = [1.5, 2.0, 1.2]
direction = [0, -1, 0]
resolution = 140
samples = 16
"""
SHARE = """
[optimise]
candidates = 64
designs = 2

[[optimise.variable]]
kind = "window share"
window = "south"
low = 0.05
high = 1.0

[[optimise.goal]]
figure = "mean illuminance"
"""
GREY = SHARE.replace('"window share"', '"reflectance"')
GREY = GREY.replace('window = "south"', 'material = "grey"')
GREY = GREY.replace("0.05", "0.3").replace("1.0", "0.8")


def test_a_quadratic_function_is_found_again():
    x = np.random.default_rng(2).uniform(-1, 1, (40, 3))
    given = np.arange(10.0)
    fit = np.linalg.lstsq(quadratic_basis(x), quadratic_basis(x) @ given, rcond=None)
    assert fit[0] == pytest.approx(given)


def searched(file, folder):
    """Candidates of every variant, and the designs that are chosen from them."""
    variants, found = read_variants(file), []
    for variant in variants:
        study = variant.study
        job = Job(study, inputs_of(study), MatrixStore(folder), silent)
        found.append(candidates(variant.name, job, study.optimise))
    return found, chosen_designs(found, variants[0].study.optimise)


def test_a_limit_of_glare_dims_the_window(tmp_path):
    """More light is better; the limit is kept by less light through the window."""
    limit = f'[[optimise.limit]]\nfigure = "{GLARE}"\nmost = 20\n'
    file = shaded_study(tmp_path / "room", VIEW + SHARE + limit)
    (found,), designs = searched(file, tmp_path / "matrices")
    share, glare = found.values[:, 0], found.figures[GLARE, "chair"]
    # DGP of a diffusing window rises with its light
    order = np.argsort(share)
    assert (np.diff(glare[order]) >= 0).all()
    assert glare.min() <= 20 < glare.max()
    # The mean illuminance, the goal, is proportional to the light of the window
    assert designs[0].values["south window share"] == share[glare <= 20].max()


@pytest.mark.slow
def test_glare_of_designs_is_that_of_their_full_runs(tmp_path):
    """Only hours whose DGP is within 0.005 of the limit may count differently."""
    goals = GREY + f'[[optimise.goal]]\nfigure = "{GLARE}"\n'
    file = shaded_study(tmp_path / "room", VIEW + goals)
    found = optimise_study(read_variants(file), out=tmp_path / "out")
    for number, design in enumerate(found.designs, 1):
        data = xr.open_dataset(tmp_path / "out" / f"design {number}" / "results.nc")
        dgp = data["glare_dgp"].values[0][data["occupied"].values.astype(bool)]
        least, most = (100 * np.mean(dgp > 0.40 + d) for d in (0.005, -0.005))
        assert least - 1e-9 <= design.figures[GLARE, "chair"] <= most + 1e-9
        # Few hours are that near, so that this says something
        assert most - least <= 15


def test_glare_without_a_view_is_refused(tmp_path):
    limit = f'[[optimise.limit]]\nfigure = "{GLARE}"\nmost = 5\n'
    file = shaded_study(tmp_path / "room", SHARE + limit)
    with pytest.raises(InputError, match="no view is wide enough for glare"):
        searched(file, tmp_path / "matrices")


def test_states_by_season_are_discrete_choices(tmp_path):
    """Of four combinations of states, the bright one in summer gives most in June."""
    control = """
[window.control]
rule = "season"

[sweep]
window.south.control.winter = ["bright", "dim"]
window.south.control.summer = ["bright", "dim"]
"""
    file = shaded_study(tmp_path / "room", control + SHARE)
    found, designs = searched(file, tmp_path / "matrices")
    assert len(found) == 4
    key = "mean illuminance", "desk"
    most = {own.variant: own.figures[key].max() for own in found}
    chosen = {
        variant.name: variant.study.window[0].control for variant in read_variants(file)
    }
    bright = [most[name] for name, own in chosen.items() if own.summer == "bright"]
    dim = [most[name] for name, own in chosen.items() if own.summer == "dim"]
    # The states transmit 0.6 and 0.1; winter does not count on two days of June
    assert bright == pytest.approx([bright[0]] * 2)
    assert dim == pytest.approx([bright[0] / 6] * 2, rel=1e-3)
    assert chosen[designs[0].variant].summer == "bright"
