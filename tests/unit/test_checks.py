"""Checks of input values name the value and what was expected."""

import numpy as np
import pytest

from clerestory import checks
from clerestory.errors import InputError, MatrixError


@pytest.mark.parametrize("value", [0, -1.0, np.nan, np.inf, np.array([1.0, 0.0])])
def test_values_that_are_not_positive_are_refused(value):
    with pytest.raises(InputError, match=r"width is .*; a positive number expected"):
        checks.positive(value, "width")


@pytest.mark.parametrize("value", [1, 1e-9, np.array([1.0, 2.0]), np.array([])])
def test_positive_values_pass(value):
    checks.positive(value, "width", unit="m")


def test_zero_is_not_negative():
    checks.not_negative(np.array([0.0, 1.0]), "area")
    with pytest.raises(InputError, match="area is -1 m²; 0 or more expected"):
        checks.not_negative(-1, "area", unit="m²")


def test_what_is_no_number_is_outside_every_interval():
    with pytest.raises(InputError, match="share is nan; a number from 0 to 1"):
        checks.within(np.nan, "share", least=0, most=1)


def test_the_first_wrong_number_of_an_array_is_named():
    with pytest.raises(InputError, match=r"^height is -2 m; 0 or more expected$"):
        checks.not_negative(np.array([[0.0, 4.0], [-2.0, -3.0]]), "height", unit="m")


def test_long_values_are_cut():
    with pytest.raises(InputError) as caught:
        checks.one_of("x" * 10_000, "kind", choices=("a", "b"))
    assert len(str(caught.value)) < 120


def test_the_class_and_the_location_of_the_error_are_chosen():
    with pytest.raises(MatrixError, match=r"^a\.rad:3: no window$"):
        checks.require(False, "no window", file="a.rad", line=3, error=MatrixError)
