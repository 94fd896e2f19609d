"""Spatial daylight autonomy (sDA) and annual sunlight exposure (ASE).

sDA300,50% is the fraction of the area with at least 300 lux in at least half of the
occupied hours; ASE1000,250h is the fraction of the area with more than 1000 lux of
direct sunlight in more than 250 occupied hours a year. Sensors are weighted by the area
they represent, or equally.

References: IES LM-83-12, Approved Method: IES spatial daylight autonomy
(sDA) and annual sunlight exposure (ASE).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.checks import not_negative, positive, same_length
from clerestory.metrics.climate_based_metrics import TARGET_LUX
from clerestory.metrics.occupied_hours import within_hours
from clerestory.metrics.replicates import metric_error, replicates

SUN_LUX = 1000.0
MOST_HOURS = 250.0
HALF_OF_THE_HOURS = 0.5


@final
@dataclass(frozen=True)
class RoomShare:
    """Fraction of the area of a room, and its values for all replicates.

    There are no replicates if the errors of the illuminance are unknown; see
    `metrics.replicates`.
    """

    value: float
    replicates: tuple[float, ...] = ()

    @property
    def error(self) -> float:
        """Standard error of the fraction; 0 if unknown."""
        return metric_error(self.replicates)


def spatial_autonomy(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    standard_error: xr.DataArray | None = None,
    components: xr.DataArray | None = None,
    area: Float[np.ndarray, " sensor"] | None = None,
    target_lux: float = TARGET_LUX,
    share_of_hours: float = HALF_OF_THE_HOURS,
) -> RoomShare:
    """Return the spatial daylight autonomy of a room (sDA).

    Parameters
    ----------
    illuminance, standard_error : values with operated blinds [lux], over (sensor, time)
    components : error components, see `metrics.replicates`
    hours : mask of the occupied hours; in LM-83, 8 to 18 h every day
    area : area represented by each sensor [m²]; default: equal areas

    >>> lux = xr.DataArray([[400.0, 100.0], [100.0, 100.0]], dims=("sensor", "time"))
    >>> spatial_autonomy(lux, np.ones(2, bool)).value
    0.5
    """

    def share(lux: xr.DataArray) -> float:
        often = (lux >= target_lux).mean("time").values
        return area_share(often >= share_of_hours - 1e-12, area)

    return _replicated(share, hours, illuminance, standard_error, components)


def sunlight_exposure(
    direct: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    standard_error: xr.DataArray | None = None,
    components: xr.DataArray | None = None,
    area: Float[np.ndarray, " sensor"] | None = None,
    step_hours: float = 1.0,
    sun_lux: float = SUN_LUX,
    most_hours: float = MOST_HOURS,
) -> RoomShare:
    """Return the annual sunlight exposure of a room (ASE).

    Parameters
    ----------
    direct : illuminance from the sun, without reflections and without blinds [lux],
        over (sensor, time)
    components : error components, see `metrics.replicates`
    hours : mask of the occupied hours; in LM-83, 8 to 18 h every day
    step_hours : length of a time step [h]

    >>> sun = xr.DataArray([[2000.0] * 300, [900.0] * 300], dims=("sensor", "time"))
    >>> sunlight_exposure(sun, np.ones(300, bool)).value
    0.5
    """

    def share(lux: xr.DataArray) -> float:
        often = (lux > sun_lux).sum("time").values * step_hours
        return area_share(often > most_hours, area)

    return _replicated(share, hours, direct, standard_error, components)


def hours_above(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    limit_lux: float = SUN_LUX,
    step_hours: float = 1.0,
) -> xr.DataArray:
    """Hours in which the illuminance of each sensor is above a limit [h]."""
    above = (within_hours(illuminance, hours) > limit_lux).sum("time")
    return (above * step_hours).assign_attrs(units="h")


def area_share(
    good: Bool[np.ndarray, " sensor"], area: Float[np.ndarray, " area"] | None
) -> float:
    """Fraction, 0…1, of the area, or of the sensors, that meets a criterion.

    >>> area_share(np.array([True, False]), np.array([3.0, 1.0]))
    0.75
    """
    if area is None:
        return float(np.mean(good))
    same_length(area, good, "areas", "sensors")
    not_negative(area, "area of a sensor", unit="m²")
    positive(area.sum(), "total area of the sensors", unit="m²")
    return float(area[good].sum() / area.sum())


def _replicated(
    share: Callable[[xr.DataArray], float],
    hours: Bool[np.ndarray, " time"],
    *given: xr.DataArray | None,
) -> RoomShare:
    # Fraction of the area for the illuminance of the selected hours, its standard
    # errors and its error components
    lux, *errors = (None if x is None else within_hours(x, hours) for x in given)
    assert lux is not None
    return RoomShare(share(lux), tuple(map(share, replicates(lux, *errors))))
