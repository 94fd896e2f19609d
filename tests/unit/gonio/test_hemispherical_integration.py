"""Integrals over scattered points against closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clerestory.gonio.angles import from_degrees
from clerestory.gonio.scattering_measurement import integration_weights


def grid(step_deg, most_deg):
    theta = np.arange(0, most_deg + 1e-6, step_deg)
    t, p = np.meshgrid(theta, np.arange(0, 360, step_deg), indexing="ij")
    return from_degrees(t.ravel(), p.ravel())


def test_an_even_function_integrates_to_pi_times_its_value():
    weight = integration_weights(grid(10.0, 80.0))
    assert weight.sum() == pytest.approx(np.pi)


def test_a_cosine_power_integrates_to_its_closed_form():
    """∫ cosⁿθ cosθ dω = 2π / (n + 2)."""
    points = grid(3.0, 87.0)
    weight = integration_weights(points)
    for n in (1, 4, 10):
        truth = 2 * np.pi / (n + 2)
        assert weight @ points[:, 2] ** n == pytest.approx(truth, rel=0.01)


def test_points_given_twice_share_their_weight():
    """At θ = 0 a grid in θ and φ gives one direction many times."""
    points = grid(10.0, 80.0)
    weight = integration_weights(points)
    assert weight[:36].sum() == pytest.approx(np.pi * np.sin(np.radians(5)) ** 2, rel=1)
    assert weight.min() >= 0


def test_gaps_are_bridged():
    """A linear function over the disc is known from its corners."""
    points = grid(5.0, 85.0)
    seen = np.hypot(points[:, 0] - 0.3, points[:, 1]) > 0.25
    weight = integration_weights(points[seen])
    assert weight @ (1 + 0.2 * points[seen, 0]) == pytest.approx(np.pi, rel=3e-3)


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 60), st.integers(0, 2**32 - 1))
def test_any_points_have_weights_that_sum_to_pi(count, seed):
    rng = np.random.default_rng(seed)
    points = from_degrees(rng.uniform(0, 90, count), rng.uniform(0, 360, count))
    weight = integration_weights(points)
    assert weight.sum() == pytest.approx(np.pi)
    assert weight.min() >= 0
