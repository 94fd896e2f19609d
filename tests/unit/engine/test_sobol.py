"""Sobol' sequence against SciPy's."""

import numpy as np
import pytest
from scipy.stats import qmc

from clerestory.engine.sobol import sobol


@pytest.mark.parametrize(
    ("first", "count"), [(0, 1), (0, 4096), (5, 16), (70_001, 512)]
)
def test_points_are_those_of_scipy(first, count):
    sequence = qmc.Sobol(40, scramble=False, bits=32)
    if first:
        sequence.fast_forward(first)
    size = 1 << (count - 1).bit_length()
    expected = np.round(sequence.random(size).T * 2.0**32).astype(np.uint32)
    assert np.array_equal(sobol(first, count), expected[:, :count])
