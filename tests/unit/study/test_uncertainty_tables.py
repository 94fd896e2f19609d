"""Table [uncertainty] of the study file: unknown quantities and their distributions."""

import numpy as np
import pytest
import xarray as xr

from clerestory.errors import InputError
from clerestory.study.config import read_study
from clerestory.study.expansion_checks import failing, far_draws
from clerestory.study.inputs import read_inputs
from clerestory.study.unknown_quantities import unknown_quantities
from uncertain_room import write_room

FLOOR = '[[uncertainty.unknown]]\nkind = "reflectance"\nmaterial = "floor"\n'


def quantities(folder, tables, *, measured=False):
    study = read_study(write_room(folder, more=f"[uncertainty]\n{tables}"))
    table = study.uncertainty.unknown
    return unknown_quantities(study, read_inputs(study), table, measured=measured)


def test_a_reflectance_is_normal_about_the_value_in_the_scene(tmp_path):
    (floor,) = quantities(tmp_path, FLOOR).unknowns
    assert floor.name == "floor reflectance"
    assert floor.reference == pytest.approx(0.3)
    own = floor.distribution
    assert (own.shape, own.centre, own.deviation) == ("normal", floor.reference, 0.05)
    assert own.low == 0
    assert own.high == pytest.approx(0.99)


def test_keys_of_the_distribution_are_used(tmp_path):
    text = FLOOR + 'distribution = "triangular"\nlow = 0.1\nmode = 0.2\nhigh = 0.5\n'
    (floor,) = quantities(tmp_path, text).unknowns
    assert floor.distribution.mean == pytest.approx(0.8 / 3)


def test_a_quantity_of_measurements_is_for_calibration_only(tmp_path):
    text = FLOOR + '[[uncertainty.unknown]]\nkind = "clock"\n'
    assert len(quantities(tmp_path, text).unknowns) == 1
    found = quantities(tmp_path, text, measured=True)
    assert found.clock == "clock"
    assert found.reference["clock"] == 0


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        (
            '[[uncertainty.unknown]]\nkind = "colour"\n',
            'kind is "colour"; "reflectance"',
        ),
        ('[[uncertainty.unknown]]\nkind = "reflectance"\n', 'without "material"'),
        ('[[uncertainty.unknown]]\nkind = "weather"\n', 'without "files"'),
        (FLOOR + 'window = "south"\n', 'kind "reflectance" with "window"'),
        (FLOOR + "mode = 0.3\n", '"mode" of distribution "normal"'),
        (
            FLOOR + 'distribution = "uniform"\nlow = 0.1\n',
            'distribution "uniform" without high',
        ),
        (FLOOR + "standard_deviation = 0\n", "a number above 0"),
        (FLOOR + FLOOR, 'two quantities are named "floor reflectance"'),
        ("draws = 1000\n" + FLOOR, "a power of two such as 2048 expected"),
        ("draws = 2048\n", "at least one table [[uncertainty.unknown]]"),
        (
            FLOOR
            + '[[uncertainty.correlated]]\nunknowns = ["floor reflectance", "x"]\n'
            + "correlation = 0.5\n",
            'correlated "x" is not the name of a quantity',
        ),
    ],
)
def test_wrong_tables_are_refused_with_their_line(tmp_path, tables, message):
    file = write_room(tmp_path, more=f"[uncertainty]\n{tables}")
    with pytest.raises(InputError) as caught:
        read_study(file)
    assert message in str(caught.value)
    assert caught.value.line is not None


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        (
            FLOOR.replace("floor", "roof"),
            "quantity \"roof reflectance\": material is 'roof'; one of floor",
        ),
        ('[[uncertainty.unknown]]\nkind = "dirt"\n', "but the study has none"),
        (
            FLOOR + 'distribution = "uniform"\nlow = 0.5\nhigh = 1.5\n',
            "values from 0 to 0.99 expected",
        ),
        (FLOOR + "mean = 1.2\n", "a value inside expected"),
        ('[[uncertainty.unknown]]\nkind = "clock"\n', "no unknown quantity"),
    ],
)
def test_quantities_that_do_not_fit_the_scene_are_refused(tmp_path, tables, message):
    with pytest.raises(InputError) as caught:
        quantities(tmp_path, tables)
    assert message in str(caught.value)


def test_checks_are_far_from_the_middle_and_from_each_other():
    rng = np.random.default_rng(2)
    draws = rng.standard_normal((512, 2))
    chosen = draws[far_draws(draws, [0, 1], 4)]
    assert (np.linalg.norm(chosen, axis=1) > 1.5).all()
    gaps = np.linalg.norm(chosen[:, None] - chosen[None], axis=-1)
    assert gaps[~np.eye(4, dtype=bool)].min() > 1.5


def test_a_check_fails_beyond_a_tenth_of_the_deviation():
    found = xr.Dataset(
        {
            "known_figure_deviation": ("known_figure", [100.0]),
            "known_figure_error": ("known_figure", [1.0]),
            "known_figure_value": ("known_figure", [500.0]),
        }
    )
    traced = np.array([[509.0], [511.0], [489.0]])
    fails = failing(traced, np.full((3, 1), 500.0), found)
    assert fails[:, 0].tolist() == [False, True, True]
