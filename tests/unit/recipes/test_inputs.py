"""Inputs of recipes: values, defaults and faults, one line each."""

import json

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.recipes.grid_summary import Range
from clerestory.recipes.inputs import (
    occupied_steps,
    read_inputs,
    thresholds,
    traced_effort,
)
from clerestory.recipes.recipe import RECIPES

DAYLIGHT = RECIPES["annual-daylight"].inputs


@pytest.fixture
def read(tmp_path):
    (tmp_path / "m.hbjson").write_text("{}")
    (tmp_path / "w.epw").write_text("")

    def inputs(**values):
        path = tmp_path / "inputs.json"
        given = {"model": "m.hbjson", "wea": "w.epw"} | values
        path.write_text(json.dumps({k: v for k, v in given.items() if v != "drop"}))
        return read_inputs(path, DAYLIGHT)

    return inputs


def test_missing_inputs_have_the_defaults_of_the_interface(read, tmp_path):
    found = read()
    assert found["model"] == tmp_path / "m.hbjson"
    assert found["radiance-parameters"] == "-ab 2 -ad 5000 -lw 2e-05 -dr 0"
    assert found["thresholds"] == "-t 300 -lt 100 -ut 3000"
    assert (found["north"], found["grid-filter"]) == (0.0, "*")
    assert (found["timestep"], found["schedule"]) == (1, None)


def test_names_with_underscores_and_of_components_are_known(read):
    found = read(grid_filter="a*", radiance_par="-ab 5")
    assert found["grid-filter"] == "a*"
    assert found["radiance-parameters"] == "-ab 5"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"spam": 1}, r"input is 'spam'; one of model, grid-filter"),
        ({"wea": "drop"}, r'input "wea" is missing'),
        ({"model": "none.hbjson"}, r"input \"model\" is 'none.hbjson'; a file that"),
        ({"north": 400}, r'input "north" is 400; a number from -360 to 360 expected'),
        ({"north": "up"}, r'input "north" is "up"; a number expected'),
        ({"timestep": 1.5}, r'input "timestep" is 1.5; a whole number expected'),
        ({"grid-filter": 3}, r'input "grid-filter" is 3; text expected'),
    ],
)
def test_faults_name_the_input(read, given, message):
    with pytest.raises(InputError, match=message):
        read(**given)


def test_ambient_options_give_samples_and_bounces():
    assert traced_effort("-ab 6 -ad 100 -c 20") == {"samples": 8000, "bounces": 6}
    with pytest.raises(InputError, match="'-spam' is unknown"):
        traced_effort("-ab 2 -spam 3")
    with pytest.raises(InputError, match="-ab is 0"):
        traced_effort("-ab 0")


@pytest.mark.parametrize("text", ["-t", "-t x", "-x 5", "-lt 500 -ut 100"])
def test_thresholds_that_contradict_are_refused(text):
    with pytest.raises(InputError, match="thresholds are"):
        thresholds(text)


def test_a_schedule_selects_hours_with_a_tenth_or_more(tmp_path):
    path = tmp_path / "s.csv"
    path.write_text("\n".join(["0.09", "0.1", *["0"] * 8758]))
    found = occupied_steps(path, np.arange(8760) + 0.5)
    assert np.flatnonzero(found).tolist() == [1]
    path.write_text("1\n" * 8759)
    with pytest.raises(InputError, match="8759 values; 8760, one for each hour"):
        occupied_steps(path, np.arange(8760) + 0.5)


def test_ranges_combine():
    values = np.array([10.0, 50, 85, 95])
    both = Range(minimum=50, exclusiveMaximum=95)
    assert both.holds(values).tolist() == [False, True, True, False]
    assert both.label == ">50 and <95"
    either = Range(anyOf=(Range(maximum=10), Range(minimum=90)))
    assert either.holds(values).tolist() == [True, False, False, True]
    assert either.label == "<10 or >90"
