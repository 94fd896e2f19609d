"""Sums of paths: merged batches, and relative errors of rows."""

import numpy as np
import pytest

from clerestory.engine.matrix_jobs import row_errors
from clerestory.engine.sums import FIXED_POINT, Sums, estimated
from clerestory.phases.stored_views import pooled

SHAPE = 5, 16, 7, 3


@pytest.fixture
def both():
    """Sums of all batches and of merged batches, of the same two units of rows."""
    rng, whole = np.random.default_rng(8), Sums.empty(np.uint64, SHAPE)
    few = Sums.merged(SHAPE, 4)
    for rows in (np.arange(5), np.array([0, 2, 3])):
        weights = rng.uniform(0, 30, (len(rows), *SHAPE[1:])) * FIXED_POINT
        for sums in (whole, few):
            sums.add(rows, weights.astype(np.uint64))
            sums.count[rows] += 32
    return whole, few


def test_estimate_and_error_are_those_of_pooled_batches(both):
    whole, few = (estimated(sums, reached=True, components=True) for sums in both)
    np.testing.assert_allclose(few.values, whole.values, rtol=1e-14)
    np.testing.assert_allclose(few.components, pooled(whole.components, 4), atol=1e-6)
    assert few.paths == whole.paths == 16 * 32 * 8


def test_convergence_is_tested_with_all_batches(both):
    whole, few = both
    np.testing.assert_array_equal(few.collected(), whole.collected())
    np.testing.assert_array_equal(row_errors(few), row_errors(whole))


def test_faint_rows_need_not_reach_the_relative_error():
    """One of 16 batches of a row has light: the error is as large as the mean."""
    sums = Sums.empty(np.uint64, (2, 16, 1, 1))
    sums.count[:] = 1000
    sums.total[0], sums.total[1, 3] = int(100 * FIXED_POINT), int(FIXED_POINT)
    mean = 1 / 16 / 1000
    assert row_errors(sums) == pytest.approx([0, mean / (0.01 * (0.1 + mean) / 2)])
    assert row_errors(sums, least=0.01) == pytest.approx([0, mean / 0.01])
