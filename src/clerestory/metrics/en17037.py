"""EN 17037:2018, Daylight in buildings: provision, exposure to sunlight, glare.

The fourth criterion of the standard, the view out, is not assessed.

Daylight provision, method 2: for half of the daylight hours, the target illuminance is
reached on 50 % of the area and the minimum illuminance on 95 % of the area. Method 1:
equivalent limits of the daylight factor. Exposure to sunlight: hours of sun on a
cloudless day between 1 February and 21 March, with the sun above the minimum solar
altitude of the country, at a reference point on the inner face of the wall, at half the
width of the opening. Levels are 0 (none), 1 (minimum), 2 (medium) and 3 (high).
"""

from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.checks import positive, require
from clerestory.directions import unit
from clerestory.metrics.spatial_metrics import RoomShare, spatial_autonomy

LEVELS = ("none", "minimum", "medium", "high")

# Tables A.1 (vertical and inclined openings) and A.2 (horizontal openings)
TARGET_LUX = (300.0, 500.0, 750.0)
MINIMUM_LUX = (100.0, 300.0, 500.0)
TARGET_AREA, MINIMUM_AREA = 0.50, 0.95
SHARE_OF_HOURS = 0.5

# Table A.6: hours of sun on the chosen day; table A.7: limits of DGP, exceeded in at
# most 5 % of the occupied time
SUN_HOURS = (1.5, 3.0, 4.0)
GLARE_LIMITS = (0.45, 0.40, 0.35)
GLARE_SHARE = 0.05

# First and last permitted day for exposure to sunlight
FIRST_DAY, LAST_DAY = "02-01", "03-21"

# Minimum height of the reference point above the floor and above the sill [m]
_ABOVE_FLOOR, _ABOVE_SILL = 1.2, 0.3

# Tilt from horizontal below which the reference point is the centre of the opening
_FLAT_DEG = 15.0


class DaylightProvision(NamedTuple):
    """Daylight provision of a room, and the highest levels reached, 0…3.

    `target` and `minimum` are the fractions of the area that reach the target and the
    minimum illuminance of each level in half of the daylight hours.
    """

    target: tuple[RoomShare, ...]
    minimum: tuple[RoomShare, ...]
    target_level: int
    minimum_level: int

    @property
    def level(self) -> int:
        """Level of the room: the lower one of `target_level` and `minimum_level`."""
        return min(self.target_level, self.minimum_level)


def daylight_hours(
    diffuse_horizontal: Float[np.ndarray, " time"],
) -> Bool[np.ndarray, " time"]:
    """Daylight hours: the half of all hours with the highest diffuse irradiance.

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
    components: xr.DataArray | None = None,
    area: Float[np.ndarray, " sensor"] | None = None,
    roof: bool = False,
) -> DaylightProvision:
    """Return the daylight provision of a room by method 2.

    Parameters
    ----------
    illuminance, standard_error : arrays over (sensor, time) [lux]
    components : error components, see `metrics.replicates`
    hours : mask of the daylight hours, from `daylight_hours`
    area : area represented by each sensor [m²]; default: equal areas
    roof : whether the openings are horizontal, so that the target is required on 95 %
        of the area

    >>> lux = xr.DataArray([[600.0], [350.0]], dims=("sensor", "time"))
    >>> provision = daylight_provision(lux, np.ones(1, bool))
    >>> provision.target_level, provision.minimum_level
    (2, 2)
    """
    share = partial(
        spatial_autonomy,
        illuminance,
        hours,
        standard_error=standard_error,
        components=components,
        area=area,
        share_of_hours=SHARE_OF_HOURS,
    )

    target = tuple(share(target_lux=lux) for lux in TARGET_LUX)
    minimum = tuple(share(target_lux=lux) for lux in MINIMUM_LUX)
    wanted = MINIMUM_AREA if roof else TARGET_AREA
    return DaylightProvision(
        target, minimum, _level(target, wanted), _level(minimum, MINIMUM_AREA)
    )


def sunlight_level(sun_hours: float) -> int:
    """Level of exposure to sunlight for the given hours of sun on the chosen day.

    >>> [sunlight_level(hours) for hours in (1.0, 1.5, 3.9, 4.0)]
    [0, 1, 2, 3]
    """
    return sum(sun_hours >= limit for limit in SUN_HOURS)


def reference_point(
    corners: Float[np.ndarray, "corner 3"],
    normal: Float[np.ndarray, "3"],
    *,
    floor: float = 0.0,
    depth: float = 0.0,
) -> Float[np.ndarray, "3"]:
    """Return the reference point of an opening for exposure to sunlight [m].

    The point is at least 1.2 m above the floor and 0.3 m above the sill, or at half the
    height of an opening with a lower top edge, or at the centre of a roof window.

    `normal` is the normal into the room, `floor` the z coordinate of the floor, `depth`
    the distance from the plane of the opening to the inner face of the wall.

    >>> window = np.array([[1.0, 0, 0.8], [3, 0, 0.8], [3, 0, 2.2], [1, 0, 2.2]])
    >>> inwards = np.array([0.0, 1, 0])
    >>> reference_point(window, inwards).tolist()
    [2.0, 0.0, 1.2]
    >>> reference_point(window, inwards, floor=-0.2, depth=0.1).round(3).tolist()
    [2.0, 0.1, 1.1]
    """
    if abs(normal[2]) > np.cos(np.radians(_FLAT_DEG)):
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        return np.asarray(middle + depth * normal)
    across = unit(np.cross([0.0, 0.0, 1.0], normal))
    slope = np.cross(normal, across)
    wide, high = corners @ across, corners @ slope
    low, top = float(corners[:, 2].min()), float(corners[:, 2].max())
    height = max(floor + _ABOVE_FLOOR, low + _ABOVE_SILL)
    if height >= top:
        height = (low + top) / 2
    along = high.min() + (height - low) / slope[2]
    point = (wide.min() + wide.max()) / 2 * across + along * slope
    return np.asarray(point + (float(corners[0] @ normal) + depth) * normal)


def hours_of_sun(
    reached: Bool[np.ndarray, "opening step"], *, step_minutes: float = 1.0
) -> tuple[Float[np.ndarray, " opening"], float]:
    """Return the hours of sun at every opening and in the room with these openings.

    `reached` tells whether the sun reaches the reference point of each opening. A step
    with sun at several openings counts once for the room.

    >>> morning, noon = [True] * 90 + [False] * 90, [False] * 60 + [True] * 120
    >>> each, room = hours_of_sun(np.array([morning, noon]))
    >>> each.tolist(), room
    ([1.5, 2.0], 3.0)
    """
    positive(step_minutes, "time step", unit="min")
    share = step_minutes / 60
    return reached.sum(axis=1) * share, float(reached.any(axis=0).sum() * share)


def glare_level(
    dgp: Float[np.ndarray, " time"], occupied: Bool[np.ndarray, " time"]
) -> int:
    """Level of protection from glare: DGP exceeds the limit in at most 5 % of the time.

    >>> dgp = np.array([0.36] * 6 + [0.2] * 94)
    >>> glare_level(dgp, np.ones(100, bool))
    2
    """
    require(np.any(occupied), "no occupied time steps; at least one expected")
    shares = [float(np.mean(dgp[occupied] > limit)) for limit in GLARE_LIMITS]
    return sum(share <= GLARE_SHARE for share in shares)


def target_factors(
    median_diffuse_lux: float,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Target and minimum daylight factors of each level, by method 1.

    >>> [round(100 * d, 2) for d in target_factors(14_900.0)[0]]
    [2.01, 3.36, 5.03]
    """
    positive(median_diffuse_lux, "median diffuse illuminance", unit="lux")
    target = tuple(lux / median_diffuse_lux for lux in TARGET_LUX)
    return target, tuple(lux / median_diffuse_lux for lux in MINIMUM_LUX)


def _level(shares: tuple[RoomShare, ...], wanted: float) -> int:
    # Highest level for which all lower levels are also reached
    reached = [share.value >= wanted - 1e-12 for share in shares]
    return [*reached, False].index(False)
