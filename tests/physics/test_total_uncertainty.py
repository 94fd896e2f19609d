"""Propagation of unknown quantities against rooms that are traced with their values."""

import warnings

import numpy as np
import pytest
import xarray as xr

from clerestory.errors import ClerestoryWarning
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.operated_study import operated
from clerestory.study.retracing import retraced
from clerestory.study.study_run import run_study
from uncertain_room import MATERIALS, unknown, write_room

DRAWS = 200


def uncertain(materials, deviation, *, more="", distribution="normal", checks=2):
    tables = "".join(
        unknown(name, deviation, distribution=distribution) for name in materials
    )
    return f"[uncertainty]\ndraws = 2048\nchecks = {checks}\n{tables}{more}"


def quantile_error(values, share, rng):
    """Standard error of a quantile by the bootstrap."""
    picks = rng.integers(0, len(values), (400, len(values)))
    return np.quantile(values[picks], share, axis=1).std()


@pytest.mark.slow
def test_distributions_are_those_of_200_traced_rooms(tmp_path):
    """Mean, 5 % and 95 % of the mean illuminance of the room, within 4 s.e."""
    file = write_room(tmp_path, more=uncertain(MATERIALS, 0.05))
    study = read_study(file)
    data = run_study(study, out=tmp_path / "out").data
    expanded = data["known_figure_draws"].values[0]
    rng = np.random.default_rng(11)
    inputs = read_inputs(study)
    job = Job(study, inputs, MatrixStore(tmp_path / "again"), silent)
    situation, lux = operated(job), []
    hours = np.flatnonzero(data["occupied"].values)
    for _ in range(DRAWS):
        values = {n: rng.normal(rho, 0.05) for n, rho in MATERIALS.items()}
        changed = retraced(job, values, situation.at(hours))
        lux.append(changed.lux().mean())
    traced = np.array(lux)
    error = traced.std() / np.sqrt(DRAWS)
    assert error < 0.01 * traced.mean()
    assert abs(traced.mean() - expanded.mean()) < 4 * error
    for share in (0.05, 0.95):
        gap = np.quantile(traced, share) - np.quantile(expanded, share)
        assert abs(gap) < 4 * quantile_error(traced, share, rng)
    assert traced.std() == pytest.approx(expanded.std(), rel=4 / np.sqrt(2 * DRAWS))


def test_wide_distributions_give_the_warning_that_the_expansion_fails(tmp_path):
    """Interreflection at ±0.3 is beyond second order."""
    file = write_room(
        tmp_path,
        more=uncertain(MATERIALS, 0.3),
        first="06-21",
        last="06-21",
        samples=4000,
    )
    with pytest.warns(ClerestoryWarning, match="the expansion fails in"):
        data = run_study(read_study(file), out=tmp_path / "out").data
    assert data["check_fails"].values.any()


def test_narrow_distributions_give_no_warning(tmp_path):
    file = write_room(
        tmp_path, more=uncertain(("floor", "wall"), 0.03), first="06-21", last="06-21"
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error", ClerestoryWarning)
        data = run_study(read_study(file), out=tmp_path / "out").data
    assert not data["check_fails"].values.any()
    traced, expanded = (data[f"check_{name}"].values for name in ("traced", "expanded"))
    assert traced[:, 0] == pytest.approx(expanded[:, 0], rel=0.02)


def test_light_is_proportional_to_sky_and_sun(tmp_path):
    """With one factor on both, the mean illuminance has the variance of the factor."""
    both = """
[[uncertainty.unknown]]
kind = "sky"
standard_deviation = 0.1
[[uncertainty.unknown]]
kind = "sun"
standard_deviation = 0.1
[[uncertainty.correlated]]
unknowns = ["sky", "sun"]
correlation = 1
"""
    file = write_room(
        tmp_path, more=uncertain((), 0.05, more=both), first="06-21", last="06-21"
    )
    data = run_study(read_study(file), out=tmp_path / "out").data
    value, spread = (
        float(data[f"known_figure_{part}"][0]) for part in ("value", "deviation")
    )
    assert spread == pytest.approx(0.1 * value, rel=0.01)
    assert data["unknown_group"].values.tolist() == ["sky + sun"]
    assert data["total_index"].values[0] == pytest.approx(1, abs=0.05)
    assert "check_traced" not in data


def test_results_are_reproducible(tmp_path):
    """A second run, with stored matrices, gives bitwise the same results."""
    file = write_room(
        tmp_path, more=uncertain(("floor",), 0.05), first="06-21", last="06-21"
    )
    one, other = (
        run_study(read_study(file), out=tmp_path / "out").data for _ in range(2)
    )
    xr.testing.assert_identical(one.drop_attrs(), other.drop_attrs())


def test_years_of_weather_are_mixed(tmp_path):
    """A second year of half the irradiance: a quarter of the mean as deviation."""
    head = "place x\nlatitude 40\nlongitude 0\ntime_zone 0\nsite_elevation 0\n"
    head += "weather_data_file_units 1\n"
    for name, share in (("one", 1.0), ("two", 0.5)):
        hours = [f"6 21 {h + 0.5} {600 * share} {120 * share}" for h in range(6, 19)]
        (tmp_path / f"{name}.wea").write_text(head + "\n".join(hours) + "\n")
    more = """
[[uncertainty.unknown]]
kind = "weather"
files = ["two.wea"]
"""
    weather = 'file = "one.wea"'
    file = write_room(tmp_path, more=uncertain((), 0.05, more=more), weather=weather)
    data = run_study(read_study(file), out=tmp_path / "out").data
    value, mean, spread = (
        float(data[f"known_figure_{part}"][0])
        for part in ("value", "mean", "deviation")
    )
    # The luminance of the sky depends on more than its irradiance
    assert mean == pytest.approx(0.75 * value, rel=0.1)
    assert spread == pytest.approx(0.25 * value, rel=0.3)
    assert len(np.unique(data["known_figure_draws"].values[0].round(3))) == 2
