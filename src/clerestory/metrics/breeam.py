"""BREEAM's Hea 01, visual comfort: two ways to show enough daylight.

By illuminance: a mean over the room, and a lower one at its worst point, for so many
hours a year. By daylight factor: a mean, with a uniformity or a minimum.

Reference: BRE Global, BREEAM UK New Construction 2018 (SD5078), Hea 01, tables 5.1
and 5.2. Numbers differ by building type: they are arguments, offices by default.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.metrics.daylight_factor import room_factors


class IlluminanceCriterion(NamedTuple):
    """Whether a room has enough daylight over the year.

    Attributes
    ----------
    mean_hours, worst_hours : hours in which the mean of the room and its worst point
        reach what they should [h]
    passed : both in enough hours
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
    """Return whether the mean and the worst point of a room are bright enough.

    Parameters
    ----------
    illuminance : [lux], over (sensor, time), of one room and all hours
    mean_lux, worst_lux, hours : what is asked for
    step_hours : length of a time step [h]

    Examples
    --------
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
    """Return whether daylight factors are high and even enough.

    Parameters
    ----------
    factor : of each sensor, as shares
    minimum : at the worst point, in place of the uniformity; 0.3 of the mean if None

    >>> factor_criterion(np.array([0.01, 0.03, 0.05]))
    True
    """
    room = room_factors(factor)
    least = uniformity * mean if minimum is None else minimum
    even = room.uniformity >= uniformity or room.minimum >= least
    return room.mean >= mean and even
