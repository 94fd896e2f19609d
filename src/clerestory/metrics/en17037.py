"""EN 17037:2018, Daylight in buildings: provision, sunlight and glare.

Provision by method 2: over the half of the year with most daylight, half of the time,
the target illuminance on half of the area and the minimum illuminance on 95 % of it.
Method 1 asks daylight factors for the same. Levels are 0 (none), 1 minimum, 2 medium,
3 high.
"""

from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.errors import InputError
from clerestory.metrics.spatial_metrics import RoomShare, area_share, with_error

LEVELS = ("none", "minimum", "medium", "high")

# Table A.1 (side-lit) and A.2 (horizontal openings) of the standard.
TARGET_LUX = (300.0, 500.0, 750.0)
MINIMUM_LUX = (100.0, 300.0, 500.0)
TARGET_AREA, MINIMUM_AREA = 0.50, 0.95
SHARE_OF_HOURS = 0.5

# Table A.6: hours of sun on the day looked at; table A.7: DGP not exceeded in 5 %.
SUN_HOURS = (1.5, 3.0, 4.0)
GLARE_LIMITS = (0.45, 0.40, 0.35)
GLARE_SHARE = 0.05


class DaylightProvision(NamedTuple):
    """How well a room is provided with daylight.

    Attributes
    ----------
    target, minimum : share of the area that reaches the lux of each level
    target_level, minimum_level : highest level reached, 0…3
    """

    target: tuple[RoomShare, RoomShare, RoomShare]
    minimum: tuple[RoomShare, RoomShare, RoomShare]
    target_level: int
    minimum_level: int

    @property
    def level(self) -> int:
        """Level of the room: both have to be reached."""
        return min(self.target_level, self.minimum_level)


def daylight_hours(
    diffuse_horizontal: Float[np.ndarray, " time"],
) -> Bool[np.ndarray, " time"]:
    """The half of the year with the most daylight, 4380 of 8760 hours.

    Parameters
    ----------
    diffuse_horizontal : illuminance or irradiance of the sky on the horizontal

    Examples
    --------
    >>> daylight_hours(np.array([0.0, 5.0, 9.0, 0.0])).tolist()
    [False, True, True, False]
    """
    order = np.argsort(-diffuse_horizontal, kind="stable")
    chosen = np.zeros(len(order), dtype=bool)
    chosen[order[: len(order) // 2]] = True
    return chosen


def daylight_provision(
    illuminance: xr.DataArray,
    hours: Bool[np.ndarray, " time"],
    *,
    standard_error: xr.DataArray | None = None,
    area: Float[np.ndarray, " sensor"] | None = None,
    roof: bool = False,
) -> DaylightProvision:
    """Return the levels of a room by method 2.

    Parameters
    ----------
    illuminance, standard_error : [lux], over (sensor, time)
    hours : `daylight_hours`
    area : that each sensor stands for [m²]
    roof : lit from above: the target then counts on 95 % of the area

    Examples
    --------
    >>> lux = xr.DataArray([[600.0], [350.0]], dims=("sensor", "time"))
    >>> provision = daylight_provision(lux, np.ones(1, bool))
    >>> provision.target_level, provision.minimum_level
    (2, 2)
    """
    if len(hours) != illuminance.sizes["time"] or not np.any(hours):
        raise InputError(
            f"{len(hours)} hours for {illuminance.sizes['time']} steps; one per step,"
            " some of them chosen, expected"
        )
    chosen = np.flatnonzero(hours)
    data = illuminance.isel(time=chosen)
    error = None if standard_error is None else standard_error.isel(time=chosen)

    def shares(lux: tuple[float, ...]) -> tuple[RoomShare, RoomShare, RoomShare]:
        first, second, third = (
            with_error(partial(_share, limit=limit, area=area), data, error)
            for limit in lux
        )
        return first, second, third

    target, minimum = shares(TARGET_LUX), shares(MINIMUM_LUX)
    wanted = MINIMUM_AREA if roof else TARGET_AREA
    return DaylightProvision(
        target, minimum, _level(target, wanted), _level(minimum, MINIMUM_AREA)
    )


def sunlight_level(sun_hours: float) -> int:
    """Level of exposure to sunlight of a room, from its hours of sun on one day.

    Parameters
    ----------
    sun_hours : on a day between 1 February and 21 March, at the reference point

    >>> [sunlight_level(hours) for hours in (1.0, 1.5, 3.9, 4.0)]
    [0, 1, 2, 3]
    """
    return sum(sun_hours >= limit for limit in SUN_HOURS)


def glare_level(
    dgp: Float[np.ndarray, " time"], occupied: Bool[np.ndarray, " time"]
) -> int:
    """Level of protection from glare: DGP exceeds the limit in 5 % of the time at most.

    >>> dgp = np.array([0.36] * 6 + [0.2] * 94)
    >>> glare_level(dgp, np.ones(100, bool))
    2
    """
    if not np.any(occupied):
        raise InputError("nobody is ever there; occupied steps expected")
    shares = [float(np.mean(dgp[occupied] > limit)) for limit in GLARE_LIMITS]
    return sum(share <= GLARE_SHARE for share in shares)


def target_factors(
    median_diffuse_lux: float,
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Daylight factors that method 1 asks for, target and minimum, per level.

    Parameters
    ----------
    median_diffuse_lux : outdoors on the horizontal, in the daylight hours

    >>> [round(100 * d, 2) for d in target_factors(14_900.0)[0]]
    [2.01, 3.36, 5.03]
    """
    if not median_diffuse_lux > 0:
        raise InputError(f"{median_diffuse_lux:g} lux outdoors; more than 0 expected")
    a, b, c = (lux / median_diffuse_lux for lux in TARGET_LUX)
    d, e, f = (lux / median_diffuse_lux for lux in MINIMUM_LUX)
    return (a, b, c), (d, e, f)


def _share(
    lux: xr.DataArray, *, limit: float, area: Float[np.ndarray, " sensor"] | None
) -> float:
    often = (lux >= limit).mean("time").values
    return area_share(often >= SHARE_OF_HOURS - 1e-12, area)


def _level(shares: tuple[RoomShare, ...], wanted: float) -> int:
    # The highest level that is reached, as long as those below it are
    level = 0
    for share in shares:
        if share.value < wanted - 1e-12:
            break
        level += 1
    return level
