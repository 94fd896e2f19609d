"""Clock offsets and gains in calibration: smooth days in closed form."""

import numpy as np
import pytest

from clerestory.comparison.calibration_model import calibration_model
from clerestory.comparison.series import Series
from clerestory.comparison.series_comparison import Rules
from clerestory.errors import InputError
from clerestory.study.unknown_quantities import UnknownQuantities
from clerestory.uncertainty.calibration import calibrate
from clerestory.uncertainty.distributions import normal
from clerestory.uncertainty.draws import Unknown
from clerestory.uncertainty.expansion import Expansion, Part

MINUTES = np.arange(6 * 60, 18 * 60, 10)
TIMES = np.datetime64("2024-06-21", "s") + MINUTES * np.timedelta64(60, "s")
CLOCK = Unknown("clock", normal(0.0, 30.0, low=-60, high=60), 0.0, "min")
GAIN = Unknown("gain", normal(1.0, 0.2, low=0.2, high=3.0), 1.0)
GLASS = Unknown("glass", normal(0.8, 0.2, low=0.1, high=1.0), 0.8)


def day(minutes):
    """Illuminance of two sensors, brightest at noon and at two."""
    noon = np.array([[720.0], [840.0]])
    return 1000 * np.exp(-(((minutes - noon) / 180) ** 2))


def model(measured, unknowns, *, clock="", gains=None, rules=None):
    names = ("desks.1", "eyes.1")
    simulated = Series(names, TIMES, day(MINUTES), 10.0, 0.0)
    series = Series(names, TIMES, measured, 10.0, 0.0)
    quantities = UnknownQuantities(
        tuple(unknowns), {}, {}, (), (), "", clock, gains or {}, {}
    )
    factors = tuple(own.name for own in unknowns if own.name == "glass")
    expansion = Expansion(
        {own.name: own.reference for own in unknowns},
        ((Part(day(MINUTES), factors),),),
    )
    rules = rules or Rules(10.0)
    return calibration_model([series], simulated, expansion, quantities, rules=rules)


def test_a_clock_that_is_late_is_found():
    """A logger 23 minutes late marks an event of 12:00 with 12:23."""
    found = model(day(MINUTES - 23), [CLOCK], clock="clock")
    fit = calibrate(found.predict, found.measured, found.unknowns)
    assert fit.values[0] == pytest.approx(-23, abs=0.5)


def test_a_gain_acts_on_its_grid_alone():
    scale = np.array([[1.0], [0.9]])
    found = model(scale * day(MINUTES), [GAIN], gains={"gain": "eyes"})
    fit = calibrate(found.predict, found.measured, found.unknowns)
    assert fit.values[0] == pytest.approx(0.9, rel=1e-3)
    assert found.predict(np.array([1.0])) == pytest.approx(day_of(found), rel=1e-9)


def day_of(found):
    """Simulated value of each pair."""
    minutes = (found.pairs.times - np.datetime64("2024-06-21")).astype(int) / 60
    return np.take_along_axis(day(minutes), found.pairs.series[None], axis=0)[0]


def test_glass_and_a_gain_of_all_grids_are_not_told_apart():
    found = model(0.7 * day(MINUTES), [GLASS, GAIN], gains={"gain": ""})
    fit = calibrate(found.predict, found.measured, found.unknowns, relative_error=0.02)
    assert [pair[:2] for pair in fit.alike()] == [("glass", "gain")]
    assert fit.values[0] / 0.8 * fit.values[1] == pytest.approx(0.7, rel=0.01)


def test_dark_values_are_left_out():
    found = model(day(MINUTES), [GLASS], rules=Rules(500.0))
    assert found.measured.min() > 500


def test_some_pairs_are_predicted_as_in_the_whole_model():
    found = model(day(MINUTES), [GLASS, CLOCK], clock="clock")
    chosen = found.pairs.series == 1
    theta = np.array([0.6, 14.0])
    assert found.of(chosen).predict(theta) == pytest.approx(
        found.predict(theta)[chosen]
    )


def test_a_gain_of_an_unknown_grid_is_refused():
    with pytest.raises(InputError, match='grid "wall"; one of desks, eyes expected'):
        model(day(MINUTES), [GAIN], gains={"gain": "wall"})
