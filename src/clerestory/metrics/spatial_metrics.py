"""Shares of a room: spatial daylight autonomy and annual sunlight exposure.

sDA300,50% is the share of the sensors that reach 300 lux in half of the occupied
hours; ASE1000,250h the share that gets more than 1000 lux of direct sun in more than
250 hours a year. Sensors count by the area they stand for, alike if none is given.

The error of a share is half of what it changes when all sensors are raised or lowered
by their standard errors together: a cautious one, as in `metrics.sensor_metrics`.

References: IES LM-83-12 and LM-83-23, Approved Method: IES spatial daylight autonomy
(sDA) and annual sunlight exposure (ASE).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.errors import InputError
from clerestory.metrics.daylight_autonomy import TARGET_LUX
from clerestory.metrics.occupied_hours import within_hours

SUN_LUX = 1000.0
MOST_HOURS = 250.0
HALF_OF_THE_HOURS = 0.5


@final
@dataclass(frozen=True)
class RoomShare:
    """A share of a room, and its error.

    Attributes
    ----------
    value : 0…1
    error : standard error, a cautious one; 0 where none is known
    """

    value: float
    error: float = 0.0


def spatial_autonomy(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    standard_error: xr.DataArray | None = None,
    area: Float[np.ndarray, " sensor"] | None = None,
    target_lux: float = TARGET_LUX,
    share_of_hours: float = HALF_OF_THE_HOURS,
) -> RoomShare:
    """Return the share of a room that reaches the target often enough (sDA).

    Parameters
    ----------
    illuminance, standard_error : [lux], over (sensor, time), blinds operated
    hours : which time steps count; LM-83 asks for 8 to 18 h every day
    area : that each sensor stands for [m²]

    Examples
    --------
    >>> lux = xr.DataArray([[400.0, 100.0], [100.0, 100.0]], dims=("sensor", "time"))
    >>> spatial_autonomy(lux, np.ones(2, bool)).value
    0.5
    """

    def share(lux: xr.DataArray) -> float:
        often = (within_hours(lux, hours) >= target_lux).mean("time").values
        return area_share(often >= share_of_hours - 1e-12, area)

    return with_error(share, illuminance, standard_error)


def sunlight_exposure(
    direct: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    standard_error: xr.DataArray | None = None,
    area: Float[np.ndarray, " sensor"] | None = None,
    step_hours: float = 1.0,
    sun_lux: float = SUN_LUX,
    most_hours: float = MOST_HOURS,
) -> RoomShare:
    """Return the share of a room with direct sun in too many hours (ASE).

    Parameters
    ----------
    direct : illuminance from the sun alone, without bounces and without blinds [lux],
        over (sensor, time)
    hours : which time steps count; LM-83 asks for 8 to 18 h every day
    step_hours : length of a time step [h]

    Examples
    --------
    >>> sun = xr.DataArray([[2000.0] * 300, [900.0] * 300], dims=("sensor", "time"))
    >>> sunlight_exposure(sun, np.ones(300, bool)).value
    0.5
    """

    def share(lux: xr.DataArray) -> float:
        count = hours_above(lux, hours, limit_lux=sun_lux, step_hours=step_hours)
        return area_share(count.values > most_hours, area)

    return with_error(share, direct, standard_error)


def hours_above(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    limit_lux: float = SUN_LUX,
    step_hours: float = 1.0,
) -> xr.DataArray:
    """Hours in which each sensor gets more than a limit [h]."""
    above = (within_hours(illuminance, hours) > limit_lux).sum("time")
    return (above * step_hours).assign_attrs(units="h")


def area_share(
    good: Bool[np.ndarray, " sensor"], area: Float[np.ndarray, " area"] | None
) -> float:
    """Share of the area, or of the sensors, that is good, 0…1.

    Raises
    ------
    InputError : areas that are negative, all zero, or not one per sensor

    Examples
    --------
    >>> area_share(np.array([True, False]), np.array([3.0, 1.0]))
    0.75
    """
    if area is None:
        return float(np.mean(good))
    if area.shape != good.shape or np.any(area < 0) or not area.sum() > 0:
        raise InputError(
            f"{len(area)} areas for {len(good)} sensors; one of 0 or more each, and"
            " some above, expected [m²]"
        )
    return float(area[good].sum() / area.sum())


def with_error(
    share: Callable[[xr.DataArray], float],
    illuminance: xr.DataArray,
    standard_error: xr.DataArray | None,
) -> RoomShare:
    """Return a share and what it changes with the standard errors of its hours."""
    if standard_error is None:
        return RoomShare(share(illuminance))
    high, low = share(illuminance + standard_error), share(illuminance - standard_error)
    return RoomShare(share(illuminance), abs(high - low) / 2)
