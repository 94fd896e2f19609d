"""Changes of metrics for changes of reflectances, with a known illuminance."""

import numpy as np
import pytest
import xarray as xr

from clerestory.errors import InputError
from clerestory.matrix.derivatives import Parameter
from clerestory.matrix.error_components import COUNT, UNIT
from clerestory.matrix.expansion import labelled_derivatives
from clerestory.metrics.metric_changes import FIGURES, metric_changes

TIMES = np.datetime64("2023-03-21T08:30") + np.arange(4) * np.timedelta64(1, "h")
HOURS = np.array([True, True, True, False])
GRIDS = ["desks", "desks", "eyes"]


def components(share):
    """All of the error in the first component."""
    found = np.zeros((*share.shape[:-1], COUNT, share.shape[-1]), np.int8)
    found[..., 0, :] = UNIT * np.sign(share)
    return found


def run(lux, slope, curve, *, error, slope_error, value=0.5):
    """Results of three sensors with one parameter."""
    shape = np.broadcast_to(lux, (3, 4)).astype(np.float32)
    spread = np.full((3, 4), error, np.float32)
    hourly = xr.Dataset(
        {
            "illuminance": (("sensor", "time"), shape),
            "standard_error": (("sensor", "time"), np.abs(spread)),
            "error_components": (("sensor", "component", "time"), components(spread)),
        },
        coords={"time": TIMES},
    )
    ones = np.ones((1, 3, 4), np.float32)
    derivatives = labelled_derivatives(
        [Parameter("floor", value, "reflectance")],
        slope * ones,
        abs(slope_error) * ones,
        curve * ones,
        times=TIMES,
        parts=components(slope_error * ones),
    )
    return hourly, derivatives


def test_changes_of_each_metric():
    """Lux 100, 290, 2995 in the occupied hours; + 20 lux moves two of them."""
    lux = np.array([100.0, 290.0, 2995.0, 9000.0])
    hourly, derivatives = run(lux, 200.0, 0.0, error=0.0, slope_error=0.0)
    found = metric_changes(hourly, derivatives, HOURS, GRIDS, step=0.1)
    more = found["sensitivity"].sel(parameter="floor", change="more", place="desks")
    assert more.sel(figure="mean illuminance") == pytest.approx(20)
    # Two of three hours reach 300 lux in place of one; one of three exceeds 3000 lux
    assert more.sel(figure="daylight autonomy") == pytest.approx(100 / 3)
    assert more.sel(figure="useful illuminance") == pytest.approx(-100 / 3)
    assert more.sel(figure="spatial autonomy") == pytest.approx(100)
    less = found["sensitivity"].sel(parameter="floor", change="less", place="eyes")
    assert less.sel(figure="mean illuminance") == pytest.approx(-20)
    assert less.sel(figure="useful illuminance") == pytest.approx(-100 / 3)
    assert found["place"].values.tolist() == ["desks", "eyes"]
    assert found["figure"].values.tolist() == list(FIGURES)
    base = found["sensitivity_base"].sel(place="eyes")
    assert base.sel(figure="mean illuminance") == pytest.approx(lux[:3].mean())


def test_second_derivatives_bend_the_change():
    """E + s·δ + ½ c δ²."""
    hourly, derivatives = run(500.0, 200.0, 1000.0, error=0.0, slope_error=0.0)
    found = metric_changes(hourly, derivatives, HOURS, GRIDS, step=0.2)
    mean = found["sensitivity"].sel(figure="mean illuminance", place="eyes")[0]
    assert mean.values == pytest.approx([-20, 60])


def test_the_error_of_a_mean_is_that_of_the_derivative():
    """Errors of the illuminance itself cancel in its change."""
    hourly, derivatives = run(500.0, 200.0, 0.0, error=30.0, slope_error=40.0)
    found = metric_changes(hourly, derivatives, HOURS, GRIDS, step=0.1)
    of = found["sensitivity_error"].sel(figure="mean illuminance")
    assert np.allclose(of, 0.1 * 40, rtol=1e-4)


def test_steps_stay_within_the_range_of_reflectances():
    hourly, derivatives = run(500.0, 10.0, 0.0, error=1, slope_error=1, value=0.97)
    found = metric_changes(hourly, derivatives, HOURS, GRIDS, step=0.05)
    assert np.allclose(found["sensitivity_step"], [[-0.05, 0.03]])


def test_no_occupied_hour_is_refused():
    given = run(500.0, 10.0, 0.0, error=1, slope_error=1)
    with pytest.raises(InputError, match="no time step"):
        metric_changes(*given, np.zeros(4, bool), GRIDS, step=0.05)
