"""Non-negative least squares by exchanging many unknowns at a time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from clerestory.gonio.lobe_fitting import non_negative


@given(st.integers(0, 10_000), st.integers(1, 40), st.integers(0, 60))
def test_the_minimum_is_that_of_lawson_and_hanson(seed, unknowns, more):
    """SciPy's active set, on systems of all sizes, most of whose unknowns are zero."""
    rng = np.random.default_rng(seed)
    basis = rng.normal(size=(unknowns + more, unknowns)) + 0.5
    target = rng.normal(size=unknowns + more)
    gram = basis.T @ basis + 1e-3 * np.eye(unknowns)
    factor = np.linalg.cholesky(gram).T
    expected, _ = nnls(factor, np.linalg.solve(factor.T, basis.T @ target))
    found = non_negative(gram, basis.T @ target)
    assert np.all(found >= 0)
    assert found == pytest.approx(expected, abs=1e-7 * max(1, np.abs(expected).max()))


def test_a_negative_target_gives_zero():
    assert np.all(non_negative(np.eye(3), -np.ones(3)) == 0)
