"""The suns that occur: their true places, instead of the patches of a sky.

A direct-sun matrix traced for 5185 fixed suns spends most of its time on suns
that never shine. Here every lit step has its own sun, and steps whose suns lie
within a stated angle share one: the strongest keeps its exact place.
"""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array, csc_array

from clerestory.constants import SUN_DIAMETER
from clerestory.errors import InputError, MatrixError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import Axis, time_axis, unknown_axis
from clerestory.sky.sky_conditions import Spectrum, sky_conditions
from clerestory.sky.solar_position import SunFormula
from clerestory.sky.solar_radiance import sun_radiance
from clerestory.sky.weather import Weather

# Angle [°] beyond which two suns are no longer much the same
_WIDEST_TOLERANCE_DEG = 10.0


@dataclass(frozen=True, eq=False)
class SunMatrix:
    """Direct normal irradiance from every sun over time.

    Attributes
    ----------
    directions : unit vectors to the suns
    times : centres of the steps, local standard time
    direct_normal : [W/m²], (sun, time), with at most one sun a step
    attributes : how it was made

    Raises
    ------
    MatrixError : the shapes disagree
    """

    directions: Float[np.ndarray, "sun 3"]
    times: np.ndarray
    direct_normal: csc_array
    attributes: Mapping[str, str | float]

    def __post_init__(self) -> None:
        if self.direct_normal.shape != (len(self.directions), len(self.times)):
            raise MatrixError(
                f"irradiance of shape {self.direct_normal.shape};"
                f" {len(self.directions)} suns by {len(self.times)} steps expected"
            )

    def __len__(self) -> int:
        return len(self.directions)

    @property
    def rows(self) -> Axis:
        """The suns."""
        return unknown_axis(len(self))

    @property
    def columns(self) -> Axis:
        """The time steps."""
        return time_axis(self.times)

    def select(self, steps: slice | np.ndarray) -> "SunMatrix":
        """Return some of the time steps, by slice or boolean mask, with all suns."""
        chosen = np.arange(len(self.times))[steps]
        return replace(
            self, times=self.times[chosen], direct_normal=self.direct_normal[:, chosen]
        )

    def radiance(self, diameter: float = SUN_DIAMETER) -> csc_array:
        """Radiance [W/(m²·sr)] of suns of the given apparent diameter [rad]."""
        return csc_array(self.direct_normal / (np.pi * (diameter / 2) ** 2))


def sun_matrix(
    weather: Weather,
    *,
    tolerance_deg: float = 0.0,
    rotation_deg: float = 0.0,
    sun_formula: SunFormula = "spa",
    dew_point_c: float | None = None,
    spectrum: Spectrum = "visible",
) -> SunMatrix:
    """Return the suns of all steps with direct light, and their irradiance.

    Steps whose sun stands below the horizon have none; their number is the
    attribute "steps_below_horizon".

    Parameters
    ----------
    weather : irradiance over time
    tolerance_deg : steps share a sun that is not farther than this from their
        own; 0 keeps every sun
    rotation_deg, sun_formula, dew_point_c, spectrum : as for `sky_matrix`

    Raises
    ------
    InputError : an argument outside its range
    """
    if not 0 <= tolerance_deg <= _WIDEST_TOLERANCE_DEG:
        raise InputError(
            f"tolerance of {tolerance_deg}°; 0 to {_WIDEST_TOLERANCE_DEG:g} expected"
        )
    conditions = sky_conditions(
        weather,
        rotation_deg=rotation_deg,
        sun_formula=sun_formula,
        dew_point_c=dew_point_c,
        spectrum=spectrum,
    )
    shining = conditions.direct_normal > 0
    up = conditions.sun.altitude > -SUN_DIAMETER / 2
    steps = np.flatnonzero(shining & up)
    irradiance = conditions.direct_normal[steps]
    directions = conditions.sun.directions()[steps]
    leader = share_suns(directions, irradiance, tolerance=np.radians(tolerance_deg))
    kept, sun = np.unique(leader, return_inverse=True)
    matrix = coo_array((irradiance, (sun, steps)), shape=(len(kept), len(weather)))
    return SunMatrix(
        directions[kept],
        weather.times,
        csc_array(matrix),
        {
            "source": weather.source,
            "sun_formula": sun_formula,
            "tolerance_deg": tolerance_deg,
            "rotation_deg": rotation_deg,
            "spectrum": spectrum,
            "steps_below_horizon": float(np.count_nonzero(shining & ~up)),
        },
    )


def patch_suns(
    weather: Weather,
    *,
    subdivision: int = 6,
    rotation_deg: float = 0.0,
    sun_formula: SunFormula = "spa",
    dew_point_c: float | None = None,
    spectrum: Spectrum = "visible",
) -> SunMatrix:
    """Return the suns in the middle of all sky patches: 5185 for subdivision 6.

    Each step's sun is taken to the patch whose centre is nearest, as direct-sun
    matrices of the five-phase method do.

    Parameters
    ----------
    weather : irradiance over time
    subdivision : Reinhart's MF, 1 to 6
    rotation_deg, sun_formula, dew_point_c, spectrum : as for `sky_matrix`
    """
    conditions = sky_conditions(
        weather,
        rotation_deg=rotation_deg,
        sun_formula=sun_formula,
        dew_point_c=dew_point_c,
        spectrum=spectrum,
    )
    partition = reinhart(subdivision)
    radiance = sun_radiance(
        conditions.direct_normal,
        conditions.sun.directions(),
        partition=partition,
        placement="disc",
    )
    solid_angle = np.pi * (SUN_DIAMETER / 2) ** 2
    return SunMatrix(
        partition.dome.centres(),
        weather.times,
        csc_array(radiance[1:] * solid_angle),
        {
            "source": weather.source,
            "sun_formula": sun_formula,
            "subdivision": float(subdivision),
            "rotation_deg": rotation_deg,
            "spectrum": spectrum,
        },
    )


def share_suns(
    directions: Float[np.ndarray, "step 3"],
    weight: Float[np.ndarray, " step"],
    *,
    tolerance: float,
) -> Int[np.ndarray, " step"]:
    """Return, for each step, the step whose sun it takes.

    The heaviest step keeps its sun, and all within `tolerance` [rad] of it take
    it; then the heaviest of those left, and so on.
    """
    count = len(directions)
    if count == 0 or tolerance == 0:
        return np.arange(count)
    # Search trees take long to load, which only tolerances should wait for
    tree = importlib.import_module("scipy.spatial").cKDTree(directions)
    near = tree.query_ball_point(directions, 2 * np.sin(tolerance / 2))
    leader = np.full(count, -1)
    for step in np.argsort(-weight, kind="stable"):
        if leader[step] < 0:
            followers = np.array(near[step])
            leader[followers[leader[followers] < 0]] = step
    return leader
