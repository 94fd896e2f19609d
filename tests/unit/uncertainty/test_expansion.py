"""Propagation through the quadratic expansion against closed forms."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.uncertainty.distributions import choice, normal, uniform
from clerestory.uncertainty.draws import Unknown, draw
from clerestory.uncertainty.expansion import Expansion, Part, by_differences


def named(draws):
    return dict(zip(draws.names, draws.independent.T, strict=True))


def test_a_linear_function_of_normal_quantities_is_normal():
    """E = E₀ + Σ g δ has the mean E₀ and the variance Σ g² σ²."""
    gradient = {"a": np.array([[300.0]]), "b": np.array([[-100.0]])}
    expansion = Expansion(
        {"a": 0.5, "b": 0.2}, ((Part(np.array([[500.0]]), (), gradient),),)
    )
    unknowns = [Unknown("a", normal(0.5, 0.05)), Unknown("b", normal(0.2, 0.1))]
    found = expansion.illuminance(named(draw(unknowns, 2048)))[:, 0, 0]
    deviation = np.hypot(300 * 0.05, 100 * 0.1)
    assert found.mean() == pytest.approx(500, abs=0.05)
    assert found.std() == pytest.approx(deviation, rel=5e-3)
    ends = np.quantile(found, [0.05, 0.95])
    assert ends == pytest.approx(500 + deviation * np.array([-1, 1]) * 1.64485, abs=0.4)


def test_a_product_of_uniform_factors_has_its_variance():
    """Var(XY) = (μx² + σx²)(μy² + σy²) − μx² μy² for independent X and Y."""
    unknowns = [Unknown("glass", uniform(0.6, 0.8)), Unknown("dirt", uniform(0.8, 1.0))]
    part = Part(np.array([[1000.0]]), ("glass", "dirt"))
    expansion = Expansion({"glass": 0.7, "dirt": 1.0}, ((part,),))
    found = expansion.illuminance(named(draw(unknowns, 2048)))[:, 0, 0]
    spread = 0.2**2 / 12
    both = (0.49 + spread) * (0.81 + spread) - 0.49 * 0.81
    assert found.mean() == pytest.approx(1000 * 0.7 * 0.9 / 0.7, rel=1e-4)
    assert found.std() == pytest.approx(1000 / 0.7 * np.sqrt(both), rel=5e-3)


def test_second_order_terms_are_those_of_a_quadratic_function():
    """A quadratic function equals its expansion, with mixed terms, at any distance."""

    def quadratic(at):
        x, y = at["x"], at["y"]
        return np.array([[2 + 3 * x - y + 4 * x * y + 5 * x**2 - 2 * y**2]])

    reference = {"x": 0.3, "y": 0.6}
    value, first, second = by_differences(quadratic, reference, {"x": 0.1, "y": 0.05})
    expansion = Expansion(reference, ((Part(value, (), first, second),),))
    places = {"x": np.array([0.1, 0.9]), "y": np.array([0.9, 0.2])}
    expected = [
        quadratic({"x": x, "y": y})
        for x, y in zip(places["x"], places["y"], strict=True)
    ]
    assert expansion.illuminance(places) == pytest.approx(np.stack(expected), rel=1e-5)
    linear = expansion.order(1).illuminance(places)
    assert not np.allclose(linear, np.stack(expected), rtol=1e-2)


def test_factors_multiply_derivatives_too():
    part = Part(np.array([[100.0]]), ("glass",), {"floor": np.array([[50.0]])})
    expansion = Expansion({"glass": 1.0, "floor": 0.2}, ((part,),))
    found = expansion.illuminance({"glass": np.array([0.5]), "floor": np.array([0.4])})
    assert found[0, 0, 0] == pytest.approx(0.5 * (100 + 50 * 0.2))


def test_parts_are_summed():
    parts = (
        Part(np.array([[100.0]]), ("south",)),
        Part(np.array([[20.0]]), ("north",)),
    )
    expansion = Expansion({"south": 1.0, "north": 1.0}, (parts,))
    found = expansion.illuminance({"south": np.array([2.0]), "north": np.array([3.0])})
    assert found[0, 0, 0] == pytest.approx(260)


def test_years_of_weather_are_chosen_with_equal_probability():
    years = tuple((Part(np.array([[lux]])),) for lux in (100.0, 200.0, 600.0))
    expansion = Expansion({"year": 0}, years, "year")
    found = expansion.illuminance(
        named(draw([Unknown("year", choice(3))], 3 * 0 + 1024))
    )
    assert np.mean(found) == pytest.approx(300, rel=5e-3)
    assert sorted(set(found.ravel().tolist())) == [100, 200, 600]


def test_selected_sensors_and_times_have_the_same_values():
    rng = np.random.default_rng(1)
    lux, slope = rng.random((2, 5, 7)).astype(np.float32)
    expansion = Expansion({"a": 1.0}, ((Part(lux, (), {"a": slope}),),))
    at = {"a": np.array([1.3, 0.7])}
    whole, times = expansion.illuminance(at), np.array([1, 4])
    part = expansion.select(np.s_[2:4], times).illuminance(at)
    assert part == pytest.approx(whole[:, 2:4][..., times])


def test_derivatives_of_unknown_names_are_refused():
    with pytest.raises(InputError, match="no first derivatives"):
        Part(np.ones((1, 1)), (), {}, {("a", "a"): np.ones((1, 1))})
