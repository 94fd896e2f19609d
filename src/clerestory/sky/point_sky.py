"""Sky at one moment, as a function of direction or as a sky vector.

Pictures are rendered with the function of direction. The sky vector, as in Radiance's
genskyvec, is a sky matrix of one time step.
"""

from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np
from scipy.sparse import csc_array

from clerestory.array_types import Directions, Values, Vector
from clerestory.bands import RGB, Bands
from clerestory.checks import not_negative, require, within
from clerestory.constants import GROUND_REFLECTANCE, LUMINOUS_EFFICACY, SKY_COLOUR
from clerestory.hemisphere.reinhart import reinhart
from clerestory.sky.luminance_distribution import (
    Distribution,
    FiveParameters,
    horizontal_integral,
)
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.perez import perez_sky
from clerestory.sky.sky_conditions import SkyConditions, SkyOptions, sky_conditions
from clerestory.sky.sky_state import DEFAULT_DEW_POINT_C, irradiance_of, sky_state
from clerestory.sky.solar_position import SunPosition, day_of_year
from clerestory.sky.solar_radiance import SUN_DIAMETER_DEG, SunPlacement, sun_radiance
from clerestory.sky.weather import Illuminance, Weather

# Sample points per patch edge of a sky vector
_SAMPLES = 4

# Day on which the distance to the sun equals the annual mean
_MEAN_DAY = np.datetime64("2023-04-04", "s")


@dataclass(frozen=True, eq=False)
class PointSky:
    """Sky, sun and ground at one moment.

    `scale` is the sky radiance at a relative luminance of 1, `ground` the ground
    radiance [W/(m²·sr)]; `colour` is a factor on the sky radiance in each band. `time`
    is local standard time, or NaT if unknown.
    """

    distribution: Distribution
    scale: float
    sun: Vector
    direct_normal: float
    ground: float
    colour: tuple[float, ...] = (1.0, 1.0, 1.0)
    time: np.datetime64 = np.datetime64("NaT", "s")  # noqa: RUF009
    bands: Bands = RGB

    def __post_init__(self) -> None:
        not_negative(self.scale, "radiance of the sky", unit="W/(m²·sr)")
        not_negative(self.direct_normal, "direct normal irradiance", unit="W/m²")
        not_negative(self.ground, "radiance of the ground", unit="W/(m²·sr)")
        not_negative(self.colour, "sky colour")
        require(
            len(self.colour) == len(self.bands),
            f"sky colour {self.colour}; one number for each of the bands {self.bands}"
            " expected",
        )

    def radiance(self, direction: Directions) -> Values:
        """Achromatic radiance of sky and ground, without sun [W/(m²·sr)]."""
        sky = self.scale * self.distribution(direction, self.sun)
        return np.where(direction[..., 2] > 0, sky, self.ground)

    def diffuse_horizontal(self) -> float:
        """Diffuse horizontal irradiance [W/m²]."""
        return self.scale * horizontal_integral(self.distribution, sun=self.sun)


def perez_point(
    weather: Weather,
    *,
    ground_reflectance: float = GROUND_REFLECTANCE,
    sky_colour: tuple[float, float, float] = SKY_COLOUR,
    **options: Unpack[SkyOptions],
) -> PointSky:
    """Return the Perez sky for weather of a single time step.

    The arguments are those of `sky_matrix`; `weather.select(slice(i, i + 1))` selects
    one step of a year.
    """
    require(
        len(weather) == 1, f"weather of {len(weather)} steps; a single step expected"
    )
    sky = _perez(sky_conditions(weather, **options), ground_reflectance, sky_colour)
    return replace(sky, time=weather.times[0])


def perez_moment(
    *,
    sun_altitude: float,
    sun_azimuth: float,
    diffuse_horizontal: float,
    direct_normal: float,
    with_sun: bool = True,
    ground_reflectance: float = GROUND_REFLECTANCE,
    sky_colour: tuple[float, float, float] = SKY_COLOUR,
    time: np.datetime64 = _MEAN_DAY,
) -> PointSky:
    """Return the Perez sky for a solar position and visible irradiances [W/m²].

    Azimuth is clockwise from north [rad]; visible irradiance is illuminance divided by
    179 lm/W; the day of `time` determines the distance to the sun. The ground reflects
    sunlight even without `with_sun`.
    """
    not_negative(diffuse_horizontal, "diffuse horizontal irradiance", unit="W/m²")
    not_negative(direct_normal, "direct normal irradiance", unit="W/m²")
    altitude_deg = np.degrees(sun_altitude)
    within(altitude_deg, "solar altitude", least=-90, most=90, unit="degrees")
    sun = SunPosition(np.array([sun_altitude]), np.array([sun_azimuth]))
    visible = np.array([direct_normal * (sun_altitude > 0)], dtype=float)
    sky = np.array([diffuse_horizontal], dtype=float)
    times = np.array([time], dtype="datetime64[s]")

    # The Perez parameters require irradiance of the whole solar spectrum: estimate it
    lux = Illuminance(LUMINOUS_EFFICACY * visible, LUMINOUS_EFFICACY * sky)
    irradiance = irradiance_of(lux, times=times, sun=sun)
    state = sky_state(
        *irradiance, altitude=sun.altitude, day_of_year=day_of_year(times)
    )
    dew_point = np.array([DEFAULT_DEW_POINT_C])
    conditions = SkyConditions(sun, state, visible, sky, dew_point)
    found = _perez(conditions, ground_reflectance, sky_colour)
    return found if with_sun else replace(found, direct_normal=0.0)


def _perez(
    conditions: SkyConditions,
    ground_reflectance: float,
    sky_colour: tuple[float, float, float],
) -> PointSky:
    sky = perez_sky(conditions.state, azimuth=conditions.sun.azimuth)
    diffuse = float(conditions.diffuse_horizontal[0])
    level = diffuse + float(conditions.direct_horizontal()[0])

    # Use the sun direction of the Perez model, with a zenith angle of at least 3°
    parameters = sky.parameters[:, 0].tolist()
    distribution = replace(FiveParameters(*parameters), centre=sky.sun[0])
    total = horizontal_integral(distribution, sun=sky.sun[0])
    if not total > 0:
        distribution, total = FiveParameters(0, 0, 0, 0, 0), np.pi
    return PointSky(
        distribution,
        diffuse / total,
        conditions.sun.directions()[0],
        float(conditions.direct_normal[0]),
        ground_reflectance * level / np.pi,
        sky_colour,
    )


def sky_vector(
    sky: PointSky,
    *,
    subdivision: int = 4,
    sun: SunPlacement = "spread",
    sun_diameter_deg: float = SUN_DIAMETER_DEG,
) -> SkyMatrix:
    """Return the mean radiance of every patch as a sky matrix of one column.

    The mean is taken over 16 points per patch with equal projected solid angles, which
    preserves the horizontal irradiance. `subdivision` is Reinhart's MF; for the sun,
    see `sun_radiance`.
    """
    partition = reinhart(subdivision)
    dome = partition.dome
    edge = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    u = np.stack(np.meshgrid(edge, edge, indexing="ij"), axis=-1).reshape(-1, 2)
    patch = np.repeat(np.arange(len(dome)), len(u))
    points = dome.sample(patch, np.tile(u, (len(dome), 1)))
    mean = sky.radiance(points).reshape(len(dome), -1).mean(axis=1)

    diffuse = np.append(sky.ground, mean).astype(np.float32)[:, None]
    tint = np.repeat(np.array(sky.colour)[:, None], len(dome), axis=1)
    direct = sun_radiance(
        np.array([sky.direct_normal]),
        sky.sun[None],
        partition=partition,
        placement=sun,
        diameter_deg=sun_diameter_deg,
    )
    return SkyMatrix(
        partition=partition,
        times=np.array([sky.time], dtype="datetime64[s]"),
        diffuse=diffuse,
        colour=np.column_stack([np.ones(len(tint)), tint]),
        sun=csc_array(direct),
        sun_colour=np.ones(len(tint)),
        attributes={"sun": sun},
        bands=sky.bands,
    )
