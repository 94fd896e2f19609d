"""Metrics against hours counted by hand."""

import numpy as np
import pytest
import xarray as xr

from clerestory.errors import InputError
from clerestory.metrics.climate_based_metrics import (
    USEFUL_RANGES,
    annual_statistic,
    continuous_autonomy,
    daylight_autonomy,
    useful_illuminance,
)
from clerestory.metrics.occupied_hours import occupied_hours, within_hours
from clerestory.metrics.sensor_metrics import sensor_metrics

# Two sensors, five hours; the last hour does not count.
LUX = xr.DataArray(
    [[0.0, 99.0, 300.0, 3000.0, 1e5], [150.0, 600.0, 299.0, 100.0, 1e5]],
    dims=("sensor", "time"),
)
HOURS = np.array([True, True, True, True, False])


def hourly(error):
    shape = np.full(LUX.shape, error)
    return xr.Dataset({"illuminance": LUX, "standard_error": (LUX.dims, shape)})


def test_autonomy_counts_hours_at_or_above_the_target():
    assert daylight_autonomy(LUX, HOURS).values.tolist() == [0.5, 0.25]
    assert daylight_autonomy(LUX, HOURS, target_lux=100).values.tolist() == [0.5, 1.0]


def test_continuous_autonomy_gives_part_credit_below_the_target():
    """(0 + 99/300 + 1 + 1)/4 and (0.5 + 1 + 299/300 + 1/3)/4."""
    expected = [(0.33 + 2) / 4, (0.5 + 1 + 299 / 300 + 1 / 3) / 4]
    np.testing.assert_allclose(continuous_autonomy(LUX, HOURS), expected, rtol=1e-12)


def test_useful_bands_hold_their_lower_limit_and_sum_to_one():
    shares = useful_illuminance(LUX, HOURS)
    assert list(shares.band.values) == list(USEFUL_RANGES)
    assert shares.isel(sensor=0).values.tolist() == [0.5, 0.0, 0.25, 0.25]
    assert shares.isel(sensor=1).values.tolist() == [0.0, 0.75, 0.25, 0.0]
    np.testing.assert_allclose(shares.sum("band"), 1)


def test_means_leave_out_the_hours_that_do_not_count():
    assert annual_statistic(LUX, HOURS, "mean").values.tolist() == [849.75, 287.25]
    assert annual_statistic(LUX, HOURS, "median").values.tolist() == [199.5, 224.5]
    assert annual_statistic(LUX, HOURS, "max").values.tolist() == [3000.0, 600.0]


def test_hours_of_a_schedule_start_inclusive_and_end_exclusive():
    day = np.datetime64("2001-03-01T00:00") + np.arange(48) * np.timedelta64(1, "h")
    mask = occupied_hours(day, from_hour=8, to_hour=18)
    assert np.flatnonzero(mask).tolist() == [*range(8, 18), *range(32, 42)]


def test_hours_of_a_leap_day_in_other_units_count_too():
    moment = np.array(["2004-02-29T08:30:00.000"], dtype="datetime64[ns]")
    assert occupied_hours(moment).tolist() == [True]


@pytest.mark.parametrize(("from_hour", "to_hour"), [(18, 8), (8, 8), (-1, 5), (8, 25)])
def test_a_schedule_that_ends_before_it_starts_is_refused(from_hour, to_hour):
    with pytest.raises(InputError, match="two increasing hours"):
        occupied_hours(np.array([], "M8[s]"), from_hour=from_hour, to_hour=to_hour)


def test_a_year_without_a_counted_hour_is_refused():
    with pytest.raises(InputError, match="no time step"):
        within_hours(LUX, np.zeros(5, bool))
    with pytest.raises(InputError, match="3 values of the mask for 5 time steps"):
        within_hours(LUX, np.ones(3, bool))


def test_limits_that_do_not_grow_are_refused():
    with pytest.raises(InputError, match="three increasing numbers"):
        useful_illuminance(LUX, HOURS, limits_lux=(300, 100, 3000))


def test_without_statistical_error_no_metric_has_one():
    metrics = sensor_metrics(hourly(0.0), HOURS)
    for name in (
        "mean_illuminance",
        "daylight_autonomy",
        "continuous_autonomy",
        "useful",
    ):
        assert np.all(metrics[f"{name}_error"] == 0)
    assert metrics["useful"].values.tolist() == [0.25, 1.0]
    assert metrics.attrs["hours"] == 4


def test_an_hour_within_its_error_of_a_limit_blurs_the_metric():
    """±2 lux move 300 and 299 across 300, 99 and 100 across 100, 3000 across 3000.

    All errors are fully correlated: 99 becomes useful when 3000 ceases to be.
    """
    metrics = sensor_metrics(hourly(2.0), HOURS)
    assert metrics["mean_illuminance_error"].values == pytest.approx([2.0, 2.0])
    assert metrics["daylight_autonomy_error"].values == pytest.approx([0.125, 0.125])
    assert metrics["useful_error"].values == pytest.approx([0.0, 0.125])
