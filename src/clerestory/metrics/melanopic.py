"""Metrics of melanopic equivalent daylight illuminance (EDI) at eyes or sensors.

T. Brown et al., PLoS Biology 20 (3), 2022, recommend at least 250 lux at the eye by
day. WELL v2, feature L03, asks for four hours of such light that begin by noon, of
which 136 lux earn one point and 250 lux three, with daylight and electric light. UL
24480 asks for two hours of 500 lux (or a circadian stimulus of 0.3) at the eye by day.
"""

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.metrics.climate_based_metrics import share_at, statistic_over_time
from clerestory.metrics.replicates import with_errors

# Recommended melanopic EDI by day [lux]
MELANOPIC_LUX = 250.0

# Melanopic EDI of WELL v2 L03 for one point [lux]
LOW_MELANOPIC_LUX = 136.0

# Length of the bright period of WELL v2 L03, and latest hour of its beginning [h]
_BRIGHT_HOURS, _NOON = 4.0, 12.0


def melanopic_metrics(
    hourly: xr.Dataset,
    hours: Bool[np.ndarray, " time"],
    *,
    step_hours: float = 1.0,
    target_lux: float = MELANOPIC_LUX,
) -> xr.Dataset:
    """Return metrics of the melanopic EDI of each sensor.

    Parameters
    ----------
    hourly : `illuminance` (melanopic EDI) with its errors, over (sensor, time)
    hours : occupied time steps

    Returns
    -------
    `mean_melanopic_edi` over the occupied hours [lux]; `melanopic_autonomy`, the
    fraction of the occupied hours with the target; `melanopic_days`, the fraction of
    all days with it for four hours that begin by noon; `low_melanopic_days`, the same
    with 136 lux; each with `…_error` and `…_components`
    """
    times, units = hourly["time"].values, hourly["illuminance"].attrs
    share = {"units": "1"}

    def metrics(lux: Float[np.ndarray, "sensor time"]) -> dict[str, xr.Variable]:
        occupied = lux[:, hours]
        days, low = (
            days_of_light(lux, times, step_hours=step_hours, target_lux=level)
            for level in (target_lux, LOW_MELANOPIC_LUX)
        )
        return {
            "mean_melanopic_edi": xr.Variable(
                "sensor", statistic_over_time(occupied, "mean"), units
            ),
            "melanopic_autonomy": xr.Variable(
                "sensor", share_at(occupied, target_lux), share
            ),
            "melanopic_days": xr.Variable("sensor", days, share),
            "low_melanopic_days": xr.Variable("sensor", low, share),
        }

    found = with_errors(hourly, metrics)
    return found.assign_attrs(melanopic_target_lux=target_lux)


def bright_days(
    illuminance: xr.DataArray,
    times: np.ndarray,
    *,
    step_hours: float = 1.0,
    target_lux: float = MELANOPIC_LUX,
) -> xr.DataArray:
    """Fraction of the days on which the target is kept for four hours from before noon.

    The four hours are consecutive and begin at noon or earlier.

    Parameters
    ----------
    illuminance : melanopic EDI over (sensor, time)
    times : centres of the time steps

    Examples
    --------
    >>> times = np.arange("2023-06-01T08:30", "2023-06-01T16:30", 60, "datetime64[m]")
    >>> lux = xr.DataArray([[300.0] * 4 + [0.0] * 4], dims=("sensor", "time"))
    >>> float(bright_days(lux, times)[0])
    1.0
    """
    share = days_of_light(
        illuminance.values, times, step_hours=step_hours, target_lux=target_lux
    )
    return xr.DataArray(share, dims="sensor", attrs={"units": "1"})


def days_of_light(
    lux: Float[np.ndarray, "sensor time"],
    times: np.ndarray,
    *,
    step_hours: float,
    target_lux: float,
    period_hours: float = _BRIGHT_HOURS,
    first_hour: float = 0.0,
    last_begin: float = _NOON,
) -> Float[np.ndarray, " sensor"]:
    """Fraction of the days on which a target is kept for a period of some hours.

    Parameters
    ----------
    lux : illuminance or melanopic EDI [lux]
    times : centres of the time steps
    period_hours : length of the period, of consecutive time steps [h]
    first_hour, last_begin : hours of the day between which the period begins [h]

    Examples
    --------
    >>> times = np.arange("2023-06-01T08:30", "2023-06-01T16:30", 60, "datetime64[m]")
    >>> lux = np.array([[600.0, 600.0] + [0.0] * 6])
    >>> days_of_light(lux, times, step_hours=1.0, target_lux=500.0, period_hours=2.0)
    array([1.])
    """
    count = max(1, round(period_hours / step_hours))
    half = np.timedelta64(round(1800 * step_hours), "s")
    begins = times.astype("datetime64[s]") - half
    day, number = np.unique(begins.astype("datetime64[D]"), return_inverse=True)
    ends = np.minimum(np.arange(len(times)) + count, len(times)) - 1
    whole = begins[ends] - begins <= 2 * half * (count - 1)
    whole &= np.arange(len(times)) + count <= len(times)
    since = (begins - day[number]) / np.timedelta64(3600, "s")
    in_time = (since >= first_hour) & (since <= last_begin)
    may_begin = whole & in_time & (number == number[ends])
    bright = np.asarray(lux >= target_lux)
    found = _any_by_day(_runs(bright, count) & may_begin, number, len(day))
    return np.asarray(found.mean(axis=-1))


def _runs(
    bright: Bool[np.ndarray, "sensor time"], count: int
) -> Bool[np.ndarray, "sensor time"]:
    # Whether a time step and the steps after it, `count` in all, are bright
    steps = bright.shape[1]
    total = np.pad(np.cumsum(bright, axis=1), ((0, 0), (1, 0)))
    after = total[:, np.minimum(np.arange(steps) + count, steps)]
    return np.asarray(after - total[:, :steps] == count)


def _any_by_day(
    values: Bool[np.ndarray, "sensor time"], number: np.ndarray, days: int
) -> Float[np.ndarray, "sensor day"]:
    # 1 for days with any true value
    first = np.searchsorted(number, np.arange(days))
    return np.maximum.reduceat(values, first, axis=1).astype(float)
