"""Metrics of melanopic light from days made by hand."""

import numpy as np
import pytest
import xarray as xr

from clerestory.metrics.melanopic import bright_days, melanopic_metrics

HOURS = np.arange("2023-06-01T00:30", "2023-06-03T00:30", 60, "datetime64[m]")


def day(*bright):
    """Two equal days with 300 lux in the given hours, else 100 lux."""
    lux = np.full(24, 100.0)
    lux[list(bright)] = 300.0
    return np.tile(lux, 2)


def series(rows, times=HOURS):
    axes = ("sensor", "time")
    return xr.DataArray(np.atleast_2d(rows), dims=axes, coords={"time": times})


@pytest.mark.parametrize(
    ("bright", "share"),
    [
        ((8, 9, 10, 11), 1.0),
        ((12, 13, 14, 15), 1.0),  # begins at noon
        ((13, 14, 15, 16), 0.0),  # begins after noon
        ((8, 9, 10, 12), 0.0),  # not consecutive
        ((9, 10, 11), 0.0),
        (range(6, 20), 1.0),
        ((22, 23, 0, 1), 0.0),  # across midnight
    ],
)
def test_four_hours_that_begin_by_noon(bright, share):
    assert bright_days(series(day(*bright)), HOURS).item() == share


def test_days_are_counted_for_every_sensor():
    """Dark on the second day; steps of half an hour; a gap in the data."""
    dark = day(8, 9, 10, 11)
    dark[24:] = 0
    found = bright_days(series(np.stack([day(8, 9, 10, 11), dark])), HOURS)
    assert found.values.tolist() == [1.0, 0.5]
    half = np.arange("2023-06-01T08:15", "2023-06-01T12:15", 30, "datetime64[m]")
    assert bright_days(series(np.full(8, 300.0), half), half, step_hours=0.5) == 1
    gap = np.delete(np.arange(8, 13), 2)
    times = np.datetime64("2023-06-01T00:30") + gap.astype("timedelta64[h]")
    assert bright_days(series(np.full(4, 300.0), times), times) == 0


def test_metrics_have_errors():
    """± 60 lux around 250 lux: autonomy is 1 or 0, days alike; the mean is ± 60."""
    lux = series(np.full(48, 250.0))
    hourly = xr.Dataset({"illuminance": lux, "standard_error": 0 * lux + 60})
    occupied = np.full(48, True)
    found = melanopic_metrics(hourly, occupied)
    assert found["mean_melanopic_edi"].item() == 250
    assert found["mean_melanopic_edi_error"].item() == pytest.approx(60)
    for name in ("melanopic_autonomy", "melanopic_days"):
        assert found[name].item() == 1
        assert found[f"{name}_error"].item() == pytest.approx(0.5)
    assert found.attrs["melanopic_target_lux"] == 250
