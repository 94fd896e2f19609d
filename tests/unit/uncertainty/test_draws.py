"""Draws of unknown quantities against closed forms."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.uncertainty.distributions import choice, normal, triangular, uniform
from clerestory.uncertainty.draws import Correlated, Unknown, draw


@pytest.mark.parametrize(
    ("given", "mean", "variance"),
    [
        (uniform(0.2, 0.6), 0.4, 0.4**2 / 12),
        # (a + b + c)/3 and (a² + b² + c² − ab − ac − bc)/18
        (triangular(0.0, 0.1, 0.5), 0.2, (0.26 - 0.05) / 18),
        (normal(0.5, 0.05), 0.5, 0.05**2),
        (choice(4), 1.5, 15 / 12),
    ],
)
def test_draws_have_mean_and_variance_of_the_distribution(given, mean, variance):
    found = draw([Unknown("x", given)], 4096).independent[:, 0]
    assert found.mean() == pytest.approx(mean, rel=1e-3)
    assert found.var() == pytest.approx(variance, rel=5e-3)
    assert given.mean == pytest.approx(mean)
    assert given.standard_deviation == pytest.approx(np.sqrt(variance))


def test_a_cut_normal_distribution_stays_in_its_range():
    """Half of a normal distribution has the mean σ √(2/π)."""
    half = normal(0.0, 0.2, low=0.0, high=10.0)
    found = draw([Unknown("x", half)], 4096).independent[:, 0]
    assert found.min() >= 0
    assert found.mean() == pytest.approx(0.2 * np.sqrt(2 / np.pi), rel=2e-3)


def test_correlated_quantities_have_their_correlation():
    pair = [Unknown(name, normal(0.5, 0.1)) for name in ("a", "b")]
    alone = Unknown("c", normal(0.0, 1.0))
    found = draw([*pair, alone], 4096, correlated=[Correlated(("a", "b"), 0.8)])
    matrix = np.corrcoef(found.independent.T)
    assert matrix[0, 1] == pytest.approx(0.8, abs=0.01)
    assert abs(matrix[0, 2]) < 0.02
    assert found.labels == ("a + b", "c")


def test_mixed_sets_differ_from_the_first_in_one_group():
    each = [Unknown(name, uniform(0, 1)) for name in "abc"]
    found = draw(each, 64, few=16)
    for number, own in enumerate(found.mixed):
        changed = (own != found.first[:16]).any(axis=0)
        assert np.flatnonzero(changed).tolist() == [number]
        assert np.array_equal(own[:, number], found.second[:16, number])


def test_the_same_seed_gives_the_same_draws():
    one, same, other = (
        draw([Unknown("x", uniform(0, 1))], 64, seed=seed).first for seed in (1, 1, 2)
    )
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: uniform(0.5, 0.5), "a smaller low end expected"),
        (lambda: normal(0.5, 0.0), "standard deviation is 0"),
        (lambda: normal(1.2, 0.1, high=1.0, low=0.0), "a value inside expected"),
        (lambda: triangular(0, 2, 1), "a value inside expected"),
        (lambda: Correlated(("a",), 0.5), "two or more expected"),
        (lambda: Correlated(("a", "b", "c"), -0.6), "correlation of 3 quantities"),
        (lambda: draw([], 64), "one or more expected"),
        (lambda: draw([Unknown("x", uniform(0, 1))], 100), "a power of two expected"),
        (
            lambda: draw(
                [Unknown("x", uniform(0, 1)), Unknown("y", uniform(0, 1))],
                64,
                correlated=[Correlated(("x", "z"), 0.5)],
            ),
            'correlated "z" is not an unknown quantity; one of x, y expected',
        ),
    ],
)
def test_bad_input_is_refused_in_one_line(make, message):
    with pytest.raises(InputError) as caught:
        make()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
