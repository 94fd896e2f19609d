"""BREEAM Hea 01, visual comfort: daylighting criteria.

Illuminance criterion: the mean illuminance of the room and the illuminance at the
darkest point reach their limits for a number of hours a year. Daylight factor
criterion: the mean daylight factor reaches a limit, and so does either the uniformity
or the minimum daylight factor.

Reference: BRE Global, BREEAM UK New Construction 2018 (SD5078), Hea 01, tables 5.1
and 5.2. Limits differ by building type, see `breeam_space_types`; the defaults are
those of offices.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.metrics.daylight_factor import DaylightFactors, room_factors

# Limits for offices: illuminance [lux] and hours a year; daylight factors
MEAN_LUX, WORST_LUX, HOURS = 300.0, 90.0, 2000.0
MEAN_FACTOR, UNIFORMITY = 0.02, 0.3


class IlluminanceCriterion(NamedTuple):
    """Hours a year in which the mean and the lowest illuminance reach their limits."""

    mean_hours: float
    worst_hours: float
    passed: bool


def illuminance_criterion(
    illuminance: xr.DataArray,
    *,
    mean_lux: float = MEAN_LUX,
    worst_lux: float = WORST_LUX,
    hours: float = HOURS,
    step_hours: float = 1.0,
) -> IlluminanceCriterion:
    """Return the result of the illuminance criterion for one room.

    The mean and the lowest illuminance of the sensors must reach `mean_lux` and
    `worst_lux`, each for the given number of hours a year.

    >>> lux = xr.DataArray(np.full((2, 2100), 350.0), dims=("sensor", "time"))
    >>> illuminance_criterion(lux).passed
    True
    """
    mean, worst = illuminance.mean("sensor"), illuminance.min("sensor")
    mean_hours, worst_hours = (
        float((lux >= limit).sum()) * step_hours
        for lux, limit in ((mean, mean_lux), (worst, worst_lux))
    )
    passed = min(mean_hours, worst_hours) >= hours
    return IlluminanceCriterion(mean_hours, worst_hours, passed)


def factor_criterion(
    factor: Float[np.ndarray, " sensor"],
    *,
    mean: float = MEAN_FACTOR,
    uniformity: float = UNIFORMITY,
    minimum: float | None = None,
) -> bool:
    """Return whether a room meets the daylight factor criterion.

    `mean`, `uniformity` and `minimum` are lower limits; `minimum` is an alternative to
    `uniformity`, by default `uniformity` times `mean`.

    >>> factor_criterion(np.array([0.01, 0.03, 0.05]))
    True
    """
    return factors_pass(
        room_factors(factor), mean=mean, uniformity=uniformity, minimum=minimum
    )


def factors_pass(
    room: DaylightFactors,
    *,
    mean: float = MEAN_FACTOR,
    uniformity: float = UNIFORMITY,
    minimum: float | None = None,
) -> bool:
    """Return whether daylight factors meet the criterion; see `factor_criterion`."""
    least = uniformity * mean if minimum is None else minimum
    even = room.uniformity >= uniformity or room.minimum >= least
    return room.mean >= mean and even
