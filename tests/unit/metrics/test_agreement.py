"""Agreement against figures worked out by hand and against NumPy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.metrics.agreement import agreement


def test_figures_of_four_pairs_worked_out_by_hand():
    """Deviations +4, -18, +45, 0 on 100, 200, 300, 400."""
    measured = np.array([100.0, 200.0, 300.0, 400.0])
    found = agreement(measured, measured + np.array([4.0, -18.0, 45.0, 0.0]))
    assert found.within == (0.5, 0.75, 1.0)
    assert found.mean_bias == pytest.approx(31 / 4)
    assert found.relative_bias == pytest.approx(31 / 1000)
    assert found.rmse == pytest.approx(np.sqrt((16 + 324 + 2025) / 4))
    assert found.variation == pytest.approx(found.rmse / 250)
    assert found.median_deviation == pytest.approx((0.04 + 0.09) / 2)


def test_a_limit_is_not_within_itself():
    """The paper's columns are Δ < 5 %."""
    assert agreement(np.array([200.0]), np.array([220.0])).within == (0.0, 0.0, 1.0)


def test_a_constant_side_has_no_correlation():
    assert np.isnan(agreement(np.array([1.0, 1.0]), np.array([1.0, 2.0])).correlation)


@given(st.floats(0.1, 10), st.floats(1, 100))
def test_a_factor_and_an_addend_leave_the_correlation(factor, addend):
    measured = np.array([100.0, 150.0, 400.0, 900.0])
    found = agreement(measured, factor * measured + addend)
    assert found.correlation == pytest.approx(1.0)
    assert found.mean_bias == pytest.approx((factor - 1) * measured.mean() + addend)


def test_darkness_is_refused():
    with pytest.raises(InputError, match="measured value is 0"):
        agreement(np.array([0.0]), np.array([1.0]))
