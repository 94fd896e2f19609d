"""Annual figures of a view grid, against closed forms and repeated draws."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.glare.comfort_classes import protection_level
from clerestory.glare.view_grid_metrics import (
    disturbed_positions,
    disturbed_views,
    view_figures,
)


def uniform(views=1, steps=10_000, low=0.2, high=0.6):
    """DGP that takes every value of an interval equally often."""
    return np.tile(np.linspace(low, high, steps), (views, 1))


def test_figures_of_a_uniform_distribution():
    figures = view_figures(uniform())
    assert figures.exceeded[0] == pytest.approx(0.58, abs=1e-4)
    assert figures.share[0] == pytest.approx([0.625, 0.5, 0.375], abs=1e-3)
    assert protection_level(figures.exceeded[0]) == "none"


def test_a_shift_of_all_hours_moves_the_figures_by_its_derivative():
    """The density is 1 / 0.4, so a shift σ moves a share by σ / 0.4."""
    sigma = 0.01
    figures = view_figures(uniform(), np.full((1, 10_000), sigma))
    assert figures.exceeded_error[0] == pytest.approx(sigma, rel=1e-3)
    assert figures.share_error[0] == pytest.approx([sigma / 0.4] * 3, rel=0.02)


def test_dark_hours_are_free_of_glare():
    dgp = np.where(np.arange(100) < 90, np.nan, 0.5)[None]
    figures = view_figures(dgp, 0.01 * dgp)
    assert figures.exceeded[0] == 0.5
    assert figures.share[0] == pytest.approx([0.1, 0.1, 0.1])


def test_no_occupied_hours_are_an_error():
    with pytest.raises(InputError, match="no occupied steps; at least one expected"):
        view_figures(np.zeros((3, 0)))


def test_shares_scatter_as_their_errors_say():
    """Independent positions of one view each, drawn anew two thousand times."""
    random = np.random.default_rng(5)
    truth = random.uniform(0.3, 0.5, 60)
    sigma = np.full(60, 0.03)
    place = np.arange(60)
    for measure in (disturbed_views, disturbed_positions):
        drawn = [
            measure(truth + sigma * random.normal(size=60), sigma, position=place)
            for _ in range(2000)
        ]
        scatter = np.std([one.value for one in drawn])
        # The chance is that of a draw, so the mean of the variance is a little larger
        mean = np.sqrt(np.mean([one.error**2 for one in drawn]))
        assert 0.9 * scatter < mean < 1.2 * scatter


def test_views_of_one_position_err_together():
    dgp, place = np.full(8, 0.4), np.zeros(8, int)
    one = disturbed_views(dgp[:1], np.full(1, 0.1), position=place[:1])
    every = disturbed_views(dgp, np.full(8, 0.1), position=place)
    assert every.error == pytest.approx(one.error) == pytest.approx(0.5)


def test_a_position_is_disturbed_by_its_worst_view():
    dgp = np.array([0.2, 0.5, 0.2, 0.3, 0.39, 0.38])
    place = np.array([0, 0, 1, 1, 2, 2])
    found = disturbed_positions(dgp, np.zeros(6), position=place)
    assert found.value == pytest.approx(1 / 3)
    assert disturbed_views(dgp, np.zeros(6), position=place).value == 1 / 6
