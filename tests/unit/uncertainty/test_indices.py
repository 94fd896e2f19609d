"""Sobol' indices against closed forms."""

import numpy as np
import pytest

from clerestory.uncertainty.distributions import normal, uniform
from clerestory.uncertainty.draws import Correlated, Unknown, draw
from clerestory.uncertainty.indices import sobol_indices


def test_indices_of_the_function_of_ishigami():
    """T. Ishigami, T. Homma, 1990: sin x₁ + a sin² x₂ + b x₃⁴ sin x₁."""
    a, b = 7.0, 0.1
    unknowns = [Unknown(f"x{k}", uniform(-np.pi, np.pi)) for k in (1, 2, 3)]
    draws = draw(unknowns, 8192, few=4096)

    def ishigami(x):
        return (np.sin(x[:, 0]) * (1 + b * x[:, 2] ** 4) + a * np.sin(x[:, 1]) ** 2)[
            None
        ]

    found = sobol_indices(draws, ishigami)
    one = 0.5 * (1 + b * np.pi**4 / 5) ** 2
    two, three = a**2 / 8, b**2 * np.pi**8 * 8 / 225
    variance = one + two + three
    first = np.array([one, two, 0.0]) / variance
    total = np.array([one + three, two, three]) / variance
    assert found.first[0] == pytest.approx(first, abs=0.01)
    assert found.total[0] == pytest.approx(total, abs=0.01)
    assert (found.total_error < 0.03).all()
    assert (abs(found.total[0] - total) < 4 * found.total_error[0]).all()


def test_indices_of_a_sum_are_shares_of_the_variance_and_sum_to_one():
    """For Σ g x of independent quantities, the index is g² σ² over the variance."""
    unknowns = [Unknown("a", normal(0, 1)), Unknown("b", normal(0, 2))]
    draws = draw(unknowns, 2048)
    found = sobol_indices(draws, lambda x: (3 * x[:, 0] + x[:, 1])[None])
    assert found.first[0] == pytest.approx([9 / 13, 4 / 13], abs=0.03)
    assert found.total[0] == pytest.approx([9 / 13, 4 / 13], abs=0.03)


def test_correlated_quantities_share_one_index():
    names = ("a", "b")
    unknowns = [Unknown(name, normal(0, 1)) for name in (*names, "c")]
    draws = draw(unknowns, 2048, correlated=[Correlated(names, 0.5)])
    found = sobol_indices(draws, lambda x: x.sum(axis=1)[None])
    # Var(a + b) = 3, Var(c) = 1
    assert found.first[0] == pytest.approx([0.75, 0.25], abs=0.03)


def test_a_figure_that_does_not_vary_has_no_indices():
    draws = draw([Unknown("a", normal(0, 1)), Unknown("b", normal(0, 1))], 64)
    found = sobol_indices(draws, lambda x: np.stack([np.full(len(x), 5.0), x[:, 0]]))
    assert found.first[0].tolist() == [0, 0]
    assert found.first[1, 0] == pytest.approx(1, abs=0.1)
