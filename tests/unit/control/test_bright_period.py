"""Shades that give a bright period of the day: four hours that begin by noon."""

import numpy as np
import pytest

from clerestory.control.bright_period import bright_states
from clerestory.control.state_choice import Limit, least_closed
from clerestory.errors import InputError

DAY = np.arange("2023-06-01T06:30", "2023-06-01T20:30", 60, "datetime64[m]")
DIM, BRIGHT = 200.0, 800.0


def by_hour(lux, *shares):
    """Light in states that transmit shares of the given illuminances."""
    return np.outer(np.array(shares), lux)


def test_the_most_closed_bright_state_is_kept_for_four_hours():
    light = by_hour(np.full(14, BRIGHT), 1.0, 0.5, 0.1)
    rest = np.full(14, 2)
    states = bright_states(light, DAY, target=250, afterwards=rest)
    assert states.tolist() == [1] * 4 + [2] * 10


def test_a_dark_hour_begins_the_period_again():
    lux = np.full(14, BRIGHT)
    lux[2] = DIM
    light = by_hour(lux, 1.0, 0.5)
    states = bright_states(light, DAY, target=250, afterwards=np.ones(14, int))
    assert states.tolist() == [1, 1, 0, 1, 1, 1, 1] + [1] * 7
    lux[3:] = DIM
    states = bright_states(
        by_hour(lux, 1.0, 0.5), DAY, target=250, afterwards=np.ones(14, int)
    )
    # Open until noon, after which a period cannot begin
    assert states.tolist() == [1, 1] + [0] * 5 + [1] * 7


def test_each_day_has_its_own_period():
    times = np.append(DAY, DAY + np.timedelta64(1, "D"))
    light = by_hour(np.full(28, BRIGHT), 1.0, 0.1)
    states = bright_states(light, times, target=250, afterwards=np.ones(28, int))
    assert states.reshape(2, 14).tolist() == [[0] * 4 + [1] * 10] * 2


def test_glare_forbids_open_states_and_the_dark_needs_none():
    light = by_hour(np.append(np.full(7, BRIGHT), np.zeros(7)), 1.0, 0.25)
    glare = Limit(np.array([[0.5] * 14, [0.3] * 14]), 0.4)
    rest = np.full(14, 1)
    states = bright_states(light, DAY, target=250, afterwards=rest, limits=[glare])
    assert states.tolist() == [1] * 14


def test_a_limit_closes_no_more_open_than_a_given_state():
    dgp = np.array([[0.2, 0.5, 0.5], [0.2, 0.3, 0.5], [0.1, 0.2, 0.45]])
    found = least_closed([Limit(dgp, 0.4)], at_least=np.array([1, 1, 0]))
    assert found.tolist() == [1, 1, 2]


def test_a_target_of_nothing_is_an_error():
    with pytest.raises(InputError, match="target"):
        bright_states(np.ones((2, 14)), DAY, target=0, afterwards=np.zeros(14, int))
