"""Zone model, its fit, and rules that know temperatures and loads."""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from clerestory.control.predictive import (
    Forecast,
    ShadeCosts,
    Weights,
    predictive_states,
)
from clerestory.control.zone_model import (
    ZoneData,
    ZoneModel,
    ZoneRun,
    fit_zone,
    simulate_zone,
    zone_step,
)
from clerestory.control.zone_rules import (
    cooling_season,
    seasonal_states,
    zone_threshold_states,
)
from clerestory.errors import InputError

MODEL = ZoneModel(40.0, 10.0, 400.0, 6000.0, 0.3, 0.6, 50.0)


def conditions(hours, seed=0, *, warmer=0.0, begin=0):
    """Weather and setpoints of some hours from `begin` on, with a setback at night."""
    rng, time = np.random.default_rng(seed), begin + np.arange(hours)
    daily = np.sin(2 * np.pi * (time % 24 - 9) / 24)
    yearly = -np.cos(2 * np.pi * time / 8760)
    outdoor = 10 + warmer + 12 * yearly + 5 * daily + rng.normal(0, 1, hours)
    day = (time % 24 > 6) & (time % 24 < 19)
    return ZoneData(
        outdoor, np.where(day, 20.0, 16.0), np.where(day, 25.0, 30.0), 200.0 * day
    )


def sunlight(hours):
    time = np.arange(hours)
    return np.maximum(0, 1500 * np.sin(2 * np.pi * (time % 24 - 6) / 24))


def test_air_is_in_balance_and_mass_follows_its_differential_equation():
    """The mass, with the air of each hour, against integration by Runge and Kutta."""
    data, sun, mass = conditions(48), sunlight(48), 21.0
    for at in range(48):
        limits = data.heating_setpoint[at], data.cooling_setpoint[at]
        air, heat, cold, after = zone_step(
            MODEL,
            mass,
            outdoor=data.outdoor[at],
            limits=limits,
            window=sun[at],
            internal=data.internal[at],
            hours=1.0,
        )
        gains = 0.3 * sun[at] + 0.6 * data.internal[at]
        rest = sun[at] + data.internal[at] - gains + 50
        balance = 40 * (data.outdoor[at] - air) + 400 * (mass - air) + gains
        assert balance + heat - cold == pytest.approx(0, abs=1e-9)
        assert limits[0] - 1e-9 <= air <= limits[1] + 1e-9
        assert not (heat > 0 and cold > 0)

        def slope(_, y, air=air, rest=rest, outdoor=data.outdoor[at]):
            return (400 * (air - y) + 10 * (outdoor - y) + rest) / 6000

        exact = solve_ivp(slope, (0, 1), [mass], rtol=1e-10, atol=1e-10).y[0, -1]
        assert after == pytest.approx(exact, abs=1e-8)
        mass = after


def test_fit_recovers_a_zone():
    hours = 24 * 90
    data, rng = conditions(hours), np.random.default_rng(1)
    runs = []
    for share in (1.0, 0.2):
        window, light = share * sunlight(hours), rng.uniform(0, 300, hours)
        found = simulate_zone(MODEL, data, window, light)
        runs.append(ZoneRun(window, light, *found))
    fit = fit_zone(data, runs)
    assert fit.energy_error < 1e-5
    assert fit.load_error < 1e-5
    assert fit.temperature_error < 1e-5
    assert fit.model.air_outdoors == pytest.approx(40, rel=1e-4)
    assert fit.model.capacity == pytest.approx(6000, rel=1e-4)


def test_prediction_costs_as_little_as_the_best_sequence():
    """All 3^7 sequences of states, simulated with the zone model."""
    hours = 7
    data, rng = conditions(hours, warmer=14, begin=9), np.random.default_rng(2)
    gain = np.stack([1, 0.5, 0.1])[:, None] * rng.uniform(0, 12000, hours)
    light = np.stack([0, 0.3, 1.0])[:, None] * rng.uniform(0, 900, hours)
    occupied = np.ones(hours, dtype=bool)
    shades = ShadeCosts(gain, light, np.full((3, hours), -1.0), occupied)
    weights = Weights(movement=0.05)

    def cost(states):
        states, steps = np.asarray(states), np.arange(hours)
        middle = (data.heating_setpoint[0] + data.cooling_setpoint[0]) / 2
        window, lamps = gain[states, steps], light[states, steps]
        _, heat, cold = simulate_zone(MODEL, data, window, lamps, start=middle)
        energy = (heat + cold + lamps).sum() / 1000
        return energy + 0.05 * np.count_nonzero(np.diff(states))

    best = min(map(cost, itertools.product(range(3), repeat=hours)))
    found = predictive_states(
        MODEL, data, shades, weights=weights, forecast=Forecast(hours)
    )
    assert cost(found) < 1.01 * best
    assert cost(found) < 0.9 * min(cost([k] * hours) for k in range(3))


def test_prediction_keeps_the_glare_limit_when_occupied():
    hours = 72
    data, sun = conditions(hours), sunlight(hours)
    gain, none = np.stack([0 * sun, sun]), np.zeros((2, hours))
    occupied = np.arange(hours) % 24 > 12
    # Winter: state 1 heats, but has glare; in some hours both have, state 0 less
    excess = np.stack([np.full(hours, -0.1), np.full(hours, 0.2)])
    excess[:, 60:64] = [[0.5], [0.3]]
    shades = ShadeCosts(gain, none, excess, occupied)
    found = predictive_states(MODEL, data, shades)
    chosen = excess[found, np.arange(hours)]
    assert (chosen == excess.min(axis=0))[occupied].all()
    assert found[~occupied & (sun > 500)].mean() > 0.9


def test_movements_and_views_have_a_cost():
    hours = 240
    data, rng = conditions(hours, warmer=8), np.random.default_rng(3)
    gain = rng.uniform(-300, 600, (4, hours))
    none, occupied = np.zeros((4, hours)), np.ones(hours, dtype=bool)
    shades = ShadeCosts(gain, none, none, occupied)

    def states(**weights):
        return predictive_states(MODEL, data, shades, weights=Weights(**weights))

    moved = [np.count_nonzero(np.diff(states(movement=c))) for c in (0, 0.2, 10)]
    assert moved[0] > 2 * moved[1] > moved[2] == 0
    assert states(view=10).max() == 0


def test_forecast_errors_depend_on_the_seed_only():
    hours = 24 * 14
    data, sun = conditions(hours, warmer=6), 3 * sunlight(hours)
    none = np.zeros((2, hours))
    shades = ShadeCosts(np.stack([sun, sun / 5]), none, none, sun > 0)

    def states(error, seed):
        forecast = Forecast(
            24, temperature_error=5 * error, gain_error=error, seed=seed
        )
        return predictive_states(MODEL, data, shades, forecast=forecast)

    assert np.array_equal(states(0.5, 1), states(0.5, 1))
    assert not np.array_equal(states(0.5, 1), states(0.5, 2))
    assert np.array_equal(states(0.0, 1), states(0.0, 2))


def test_shades_close_while_the_zone_is_cooled():
    hours = 24 * 20
    data, sun = conditions(hours), 3 * sunlight(hours)
    shades = ShadeCosts(
        np.stack([sun, 0 * sun]), np.zeros((2, hours)), np.zeros((2, hours)), sun > 0
    )
    found = zone_threshold_states(
        MODEL,
        data,
        shades,
        quantity="cooling load",
        close_above=np.array([100.0]),
        open_below=np.array([1.0]),
    )
    window = np.where(found == 0, sun, 0)
    _, _, cold = simulate_zone(MODEL, data, window, 0 * sun)
    # The state follows the load of the hour before
    assert (found[1:][cold[:-1] > 100] == 1).all()
    assert (found[1:][cold[:-1] < 1] == 0).all()
    assert 0 < found.mean() < 1
    _, _, open_always = simulate_zone(MODEL, data, sun, 0 * sun)
    assert cold.sum() < 0.7 * open_always.sum()


def test_thresholds_of_zones_need_one_or_as_many_as_changes():
    data, none = conditions(4), np.zeros((4, 4))
    shades = ShadeCosts(none, none, none, none[0] > 0)
    with pytest.raises(InputError, match="2 thresholds for 4 states"):
        zone_threshold_states(
            MODEL,
            data,
            shades,
            quantity="zone temperature",
            close_above=np.array([20.0, 22.0]),
        )


def test_seasons_follow_the_loads_of_a_week():
    cooling = np.repeat([0.0, 10.0, 0.0], 24 * 30)
    found = cooling_season(10 - cooling, cooling)
    change = np.flatnonzero(np.diff(found.astype(int)))
    # Half a week after the loads change
    assert change.tolist() == [24 * 30 + 84, 24 * 60 + 83]


def test_seasonal_states_by_hand():
    """States of little to most closing: gain 100, 50, 10; light 500, 300, 100 lx."""
    gain = np.tile([[100.0], [50.0], [10.0]], (1, 5))
    lux = np.tile([[500.0], [300.0], [100.0]], (1, 5))
    excess = np.full((3, 5), -1.0)
    excess[0, 2:] = 0.5
    excess[1:, 4] = [0.4, 0.2]
    occupied = np.array([False, True, True, True, True])
    cooled = np.array([True, True, True, False, True])
    shades = ShadeCosts(gain, 0 * gain, excess, occupied)
    found = seasonal_states(shades, lux, cooled=cooled, target_lux=300.0)
    # Empty: blocked; dark if blocked; the same with glare; heating; no state without
    assert found.tolist() == [2, 1, 1, 1, 2]
    bright = seasonal_states(shades, lux, cooled=cooled, target_lux=50.0)
    assert bright.tolist() == [2, 2, 2, 1, 2]
    dark = seasonal_states(shades, lux, cooled=cooled, target_lux=900.0)
    assert dark.tolist() == [2, 0, 1, 1, 2]


WRONG = {
    "runs": (lambda: fit_zone(conditions(2000), []), "no simulated run"),
    "short": (
        lambda: fit_zone(conditions(200), [ZoneRun(*[np.zeros(200)] * 5)]),
        "less than 16 days",
    ),
    "weight": (lambda: Weights(heating=-1), "weight of heating"),
    "horizon": (lambda: Forecast(0), "horizon"),
    "steps": (
        lambda: predictive_states(
            MODEL, conditions(5), ShadeCosts(*[np.zeros((2, 4))] * 3, np.zeros(4) > 0)
        ),
        "4 time steps",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_is_one_line(name):
    function, message = WRONG[name]
    with pytest.raises(InputError, match=message) as found:
        function()
    assert "\n" not in str(found.value)
