"""BREEAM Hea 01, visual comfort: daylighting criteria.

By illuminance: the mean of the room and the illuminance at its darkest point for a
number of hours a year. By daylight factor: the mean, with a uniformity or a minimum.

Reference: BRE Global, BREEAM UK New Construction 2018 (SD5078), Hea 01, tables 5.1
and 5.2. Limits differ by building type; those of offices are the defaults.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.metrics.daylight_factor import room_factors


class IlluminanceCriterion(NamedTuple):
    """Result of the illuminance criterion.

    Attributes
    ----------
    mean_hours, worst_hours : hours in which the mean of the room and its darkest point
        reach their limits [h]
    passed : whether both do in enough hours
    """

    mean_hours: float
    worst_hours: float
    passed: bool


def illuminance_criterion(
    illuminance: xr.DataArray,
    *,
    mean_lux: float = 300.0,
    worst_lux: float = 90.0,
    hours: float = 2000.0,
    step_hours: float = 1.0,
) -> IlluminanceCriterion:
    """Return the result of the illuminance criterion.

    Parameters
    ----------
    illuminance : [lux], over (sensor, time), of one room and all hours
    mean_lux, worst_lux, hours : limits of the criterion
    step_hours : length of a time step [h]

    >>> lux = xr.DataArray(np.full((2, 2100), 350.0), dims=("sensor", "time"))
    >>> illuminance_criterion(lux).passed
    True
    """
    mean, worst = illuminance.mean("sensor"), illuminance.min("sensor")
    mean_hours = float((mean >= mean_lux).sum()) * step_hours
    worst_hours = float((worst >= worst_lux).sum()) * step_hours
    return IlluminanceCriterion(
        mean_hours, worst_hours, min(mean_hours, worst_hours) >= hours
    )


def factor_criterion(
    factor: Float[np.ndarray, " sensor"],
    *,
    mean: float = 0.02,
    uniformity: float = 0.3,
    minimum: float | None = None,
) -> bool:
    """Return whether daylight factors meet the criterion.

    Parameters
    ----------
    factor : of each sensor, 0…1
    minimum : at the darkest point, alternative to the uniformity; 0.3 of the mean if
        None

    >>> factor_criterion(np.array([0.01, 0.03, 0.05]))
    True
    """
    room = room_factors(factor)
    least = uniformity * mean if minimum is None else minimum
    even = room.uniformity >= uniformity or room.minimum >= least
    return room.mean >= mean and even
