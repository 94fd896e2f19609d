"""Times brought together: means over coarse steps, moments, gaps, clocks."""

import numpy as np
import pytest

from clerestory.comparison.series import Series
from clerestory.comparison.series_comparison import Rules, compare_series
from clerestory.comparison.time_alignment import pair_series
from clerestory.errors import InputError


def times(start, count, minutes):
    first = np.datetime64(start, "s")
    return first + np.arange(count) * np.timedelta64(60 * minutes, "s")


def series(start, minutes, values, *, step=None, names=("desk",), offset=0.0):
    values = np.atleast_2d(np.asarray(values, dtype=float))
    at = times(start, values.shape[1], minutes)
    return Series(names, at, values, minutes if step is None else step, offset)


def test_minutes_are_averaged_over_the_hours_of_a_study():
    """Steps 12:30 … of a study are the means of 12:00 to 13:00."""
    measured = series("2024-06-26T12:00:30", 1, np.arange(120.0))
    simulated = series("2024-06-26T12:30", 60, [100.0, 200.0])
    pairs = pair_series(measured, simulated)
    assert pairs.measured.tolist() == [np.arange(60).mean(), np.arange(60, 120).mean()]
    assert pairs.simulated.tolist() == [100.0, 200.0]


def test_a_step_that_is_not_filled_does_not_count():
    values = np.where(np.arange(60) < 20, np.nan, 500.0)
    measured = series("2024-06-26T12:00:30", 1, values)
    simulated = series("2024-06-26T12:30", 60, [100.0])
    assert pair_series(measured, simulated).measured.size == 0
    assert pair_series(measured, simulated, coverage=0.5).measured.tolist() == [500.0]
    assert pair_series(measured, simulated).gaps.tolist() == [20]


def test_a_finer_study_is_averaged_over_the_steps_of_the_logger():
    measured = series("2024-06-26T12:07:30", 15, [400.0])
    simulated = series("2024-06-26T12:00:30", 1, np.arange(60.0))
    assert pair_series(measured, simulated).simulated.tolist() == [7.0]


def test_a_moment_is_met_between_the_middles_of_steps():
    measured = series("2024-06-26T13:00", 60, [500.0], step=0)
    simulated = series("2024-06-26T12:30", 60, [100.0, 200.0])
    assert pair_series(measured, simulated).simulated.tolist() == [150.0]


def test_a_moment_beside_a_gap_takes_the_step_that_it_lies_in():
    measured = series("2024-06-26T12:50", 60, [500.0, 500.0], step=0)
    at = np.array(["2024-06-26T12:30", "2024-06-26T20:30"], "datetime64[s]")
    simulated = Series(("desk",), at, np.array([[100.0, 200.0]]), 60.0, 0.0)
    pairs = pair_series(measured, simulated)
    assert pairs.simulated.tolist() == [100.0]  # 13:50 lies in no step
    assert pairs.outside.tolist() == [1]


@pytest.mark.parametrize("minutes", [1, 5, 10, 60])
def test_a_linear_day_is_the_same_at_any_resolution(minutes):
    """Means over steps of a straight line are its values in their middles."""
    count = 600 // minutes
    fine = times("2024-06-26T08:00", count, minutes) + np.timedelta64(30 * minutes, "s")
    hours = (fine - np.datetime64("2024-06-26T08:00", "s")) / np.timedelta64(3600, "s")
    measured = Series(("desk",), fine, (100 + 50 * hours)[None], minutes, 0.0)
    simulated = series("2024-06-26T08:30", 60, 100 + 50 * (np.arange(10) + 0.5))
    pairs = pair_series(measured, simulated)
    assert pairs.measured.size == 10
    np.testing.assert_allclose(pairs.measured, pairs.simulated)


def test_clocks_of_two_time_zones_show_the_same_moment():
    ours = series("2024-06-26T12:30", 60, [300.0], offset=1.0)
    theirs = series("2024-06-26T11:30", 60, [300.0], offset=0.0)
    pairs = pair_series(theirs.on_clock(1.0), ours)
    assert pairs.times.tolist() == ours.times.tolist()


def test_a_typical_year_is_matched_without_its_year_and_says_so():
    measured = series("2019-06-26T12:30", 60, [300.0])
    simulated = series("2023-06-26T12:30", 60, [330.0])
    found = compare_series([measured], simulated)
    assert found.years_ignored
    assert found.pairs.simulated.tolist() == [330.0]


def test_29_february_falls_away_in_a_year_without():
    at = np.array(["2024-02-28T12:30", "2024-02-29T12:30"], "datetime64[s]")
    measured = Series(("desk",), at, np.array([[300.0, 300.0]]), 60.0, 0.0)
    simulated = series("2023-02-28T12:30", 1440, [330.0, 330.0], step=60)
    assert compare_series([measured], simulated).pairs.measured.size == 1


def day(shift_minutes=0.0):
    """A day of light in five-minute steps."""
    at = times("2024-06-26T06:02:30", 144, 5)
    hours = np.arange(144) / 12 - shift_minutes / 60
    lux = 1000 * np.maximum(np.sin(np.pi * hours / 12), 0) ** 2 * (1.2 + np.sin(hours))
    return Series(("desk",), at, lux[None], 5.0, 0.0)


def test_a_wrong_clock_is_found_and_not_mended():
    found = compare_series([day(-60)], day())
    assert found.offset["illuminance"].minutes == 60
    assert found.offset["illuminance"].matters
    assert found.offset["illuminance"].rmse < 0.01
    assert found.table()["desk", "illuminance"].variation > 0.2


def test_a_right_clock_is_not_shifted():
    found = compare_series([day()], day())
    assert found.offset["illuminance"].minutes == 0
    assert not found.offset["illuminance"].matters


def test_a_shift_is_applied_when_asked():
    found = compare_series([day(-60)], day(), rules=Rules(shift_minutes=60))
    assert found.table()["desk", "illuminance"].variation < 0.01


def test_darker_values_do_not_count_but_glare_does():
    measured = series(
        "2024-06-26T12:30", 60, [[50.0, 500.0], [0.3, 0.4]], names=("desk", "eye.dgp")
    )
    found = compare_series([measured], measured)
    assert found.below.tolist() == [1, 0]
    assert found.table()["eye", "dgp"].count == 2


def test_nothing_in_common_is_said_in_words():
    measured = series("2024-06-26T12:30", 60, [300.0])
    with pytest.raises(InputError, match="no measured series has the name"):
        compare_series([measured], series("2024-06-26", 60, [1.0], names=("b",)))
    with pytest.raises(InputError, match="no time in common"):
        compare_series([measured], series("2024-01-01", 60, [1.0]))
    with pytest.raises(InputError, match="a lower limit"):
        compare_series([measured], measured, rules=Rules(above_lux=400.0))
