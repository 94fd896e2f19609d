"""Standards in a study: spaces, inputs of the standards, verdicts in all outputs."""

import csv

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.metrics.compliance import assess
from clerestory.metrics.standards import standards_named
from clerestory.study.compliance_table import assessments_of, compliance_table
from clerestory.study.config import read_study
from clerestory.study.results import Results, read_results, save_results
from clerestory.study.study_run import run_study

ALL = (
    '[compliance]\nstandards = ["LM-83", "LM-83-23", "LEED v4.1", "EN 17037", "BREEAM"]'
)


def edited(study_file, text):
    study_file.write_text(study_file.read_text() + "\n" + text + "\n")
    return read_study(study_file)


def lines_of(path):
    return path.read_text(encoding="utf-8").splitlines()


@pytest.fixture
def office(study_file, engine, tmp_path):
    assert engine
    return run_study(edited(study_file, ALL), out=tmp_path / "out")


def test_every_standard_has_verdicts_that_are_read_back_as_they_were(office, tmp_path):
    found = assessments_of(office.data)
    assert {one.standard for one in found} == {
        *("LM-83-12", "LM-83-23", "LEED v4.1", "EN 17037", "BREEAM")
    }
    read = read_results(tmp_path / "out").data
    assert repr(assessments_of(read)) == repr(found)
    names = [one.standard for one in found]
    again = assess(read, standards_named(list(dict.fromkeys(names))))
    assert repr(assessments_of(compliance_table(again))) == repr(again)
    assert [v.level for a in again for v in a.verdicts] == [
        v.level for a in found for v in a.verdicts
    ]


def test_the_daylight_factor_behind_a_diffuser_is_known(office):
    """The diffuser sends on the mean radiance of the patches, ∝ 1 + 2 cos ζ.

    The radiance of a ring of patches is its irradiance over its projected solid angle:
    integrals of (1 + 2 c) c and of c over c = cos ζ.
    """
    dome = reinhart(1).dome
    c = np.cos(dome.theta)
    ring = (c[:-1] ** 2 / 2 + 2 * c[:-1] ** 3 / 3) - (
        c[1:] ** 2 / 2 + 2 * c[1:] ** 3 / 3
    )
    radiance = ring / ((c[:-1] ** 2 - c[1:] ** 2) / 2)
    mean = (radiance * (c[:-1] - c[1:])).sum()
    expected = 0.5 * np.pi * abs(mean) / (2 * np.pi * 7 / 6)
    found = office.data["daylight_factor"].values
    assert found == pytest.approx(expected, rel=1e-3)
    assert (office.data["daylight_factor_error"].values > 0).all()


def test_heights_of_grids_above_desks_are_measured_and_half_of_the_hours_are_daylight(
    office,
):
    data = office.data
    height = data["height_above_floor"].values
    assert height == pytest.approx(data["position"].values[:, 2], abs=1e-5)
    assert data["daylight_hours"].values.sum() == data.sizes["time"] // 2
    assert float(data.attrs["median_diffuse_lux"]) > 0


def test_the_view_out_has_the_width_of_the_window(office):
    """The window of the room is 2 m wide; the vertical sensor is in no space."""
    data = office.data
    window = data["window_triangle"].values.reshape(-1, 3)
    x = window[:, 0].min(), window[:, 0].max()
    depth = abs(data["position"].values[:, 1] - window[0, 1])
    left, right = (
        np.arctan((edge - data["position"].values[:, 0]) / depth) for edge in x
    )
    expected = np.degrees(right - left) * (data["space"].values == "desk")
    assert data["view_width"].values == pytest.approx(expected, rel=1e-6)


def test_tables_hold_the_verdicts(office, tmp_path):
    assert office
    out = tmp_path / "out"
    rows = list(csv.DictReader(lines_of(out / "compliance.csv")))
    sda = [row for row in rows if row["quantity"] == "sDA300/50%"]
    assert {row["standard"] for row in sda} == {"LM-83-12", "LM-83-23", "LEED v4.1"}
    lines = list(csv.DictReader(lines_of(out / "requirements.csv")))
    period = next(line for line in lines if line["requirement"] == "Period")
    assert period["status"] == "not fulfilled"
    assert "from" in period["to do"]
    head = next(csv.reader(lines_of(out / "metrics.csv")))
    assert "space" in head
    assert "daylight factor" in head


def test_polygons_make_spaces_with_their_floor_area(study_file, engine, tmp_path):
    assert engine
    tables = (
        '[[space]]\nname = "whole room"\ncorners = [[0, 0], [4, 0], [4, 5], [0, 5]]\n'
    )
    results = run_study(edited(study_file, tables + ALL), out=tmp_path / "out")
    found = assessments_of(results.data)
    assert {one.space for one in found} == {"whole room"}
    assert found[0].area == pytest.approx(20.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[compliance]\nstandards = ["LM-84"]', '"LM-84"; one of "LM-83-12"'),
        ("[compliance]\nstandards = []", "standards"),
        ('[[space]]\nname = "a"', 'neither "grids" nor "corners"'),
        ('[[space]]\nname = "a"\ncorners = [[0, 0], [1, 1]]', "three or more"),
        ('[[space]]\nname = "a"\ngrids = ["lost"]', 'refers to grid "lost"'),
        ('[[space]]\nname = "a"\ngrids = ["desk"]\nviews = ["x"]', 'view "x"'),
        ('[[space]]\nname = "a"\ngrids = ["desk"]\narea = 0', "above 0"),
        ('[[space]]\ngrids = ["desk"]', "name"),
    ],
)
def test_a_wrong_table_is_named_with_its_line(study_file, text, message):
    with pytest.raises(InputError, match=r"study\.toml") as caught:
        edited(study_file, text)
    assert message in str(caught.value)


def test_a_space_without_sensors_or_with_those_of_another_is_an_error(
    study_file, engine, tmp_path
):
    assert engine
    away = '[[space]]\nname = "far"\ncorners = [[90, 0], [94, 0], [94, 5]]'
    whole = study_file.read_text()
    with pytest.raises(InputError, match='no sensor is in space "far"'):
        run_study(edited(study_file, away), out=tmp_path / "out")
    study_file.write_text(whole)
    twice = (
        '[[space]]\nname = "a"\ngrids = ["desk"]\n[[space]]\nname = "b"\n'
        'grids = ["desk"]'
    )
    with pytest.raises(InputError, match='in space "b" and in another one'):
        run_study(edited(study_file, twice), out=tmp_path / "out")


def test_results_without_a_part_of_the_verdicts_are_refused(office, tmp_path):
    part = Results(office.data.drop_vars("quantity_value"), office.run)
    file = save_results(part, tmp_path)
    with pytest.raises(InputError, match="quantity_value missing"):
        read_results(file)
