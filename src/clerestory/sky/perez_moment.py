"""Perez's sky of a moment that is known by its light alone, not by a weather file."""

from dataclasses import replace

import numpy as np

from clerestory.constants import GROUND_REFLECTANCE, LUMINOUS_EFFICACY, SKY_COLOUR
from clerestory.errors import InputError
from clerestory.sky.illuminance_conversion import irradiance_of
from clerestory.sky.point_sky import PointSky, perez_under
from clerestory.sky.sky_conditions import SkyConditions
from clerestory.sky.sky_state import sky_state
from clerestory.sky.solar_position import SunPosition, day_of_year
from clerestory.sky.weather import Illuminance

# The day on which the sun is at its mean distance, if none is given
_MEAN_DAY = np.datetime64("2023-04-04", "s")


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
    """Return Perez's sky for a place of the sun and what sun and sky send.

    Parameters
    ----------
    sun_altitude, sun_azimuth : of the sun, azimuth clockwise from north [rad]
    diffuse_horizontal : visible irradiance of the sky on the ground [W/m²], lux
        over 179
    direct_normal : visible irradiance facing the sun [W/m²]
    with_sun : whether the sun is part of the sky; the ground is lit by it either way
    ground_reflectance, sky_colour : as for `perez_point`
    time : the moment, whose day tells how far the sun is

    Raises
    ------
    InputError : irradiance that is negative or not finite, a sun beyond the zenith

    Examples
    --------
    >>> sky = perez_moment(
    ...     sun_altitude=0.7, sun_azimuth=3.1, diffuse_horizontal=90, direct_normal=400
    ... )
    >>> round(sky.diffuse_horizontal(), 6)
    90.0
    """
    if not (0 <= diffuse_horizontal < np.inf and 0 <= direct_normal < np.inf):
        raise InputError(
            f"irradiance {diffuse_horizontal} of the sky, {direct_normal} of the sun;"
            " numbers from 0 expected"
        )
    if not abs(sun_altitude) <= np.pi / 2:
        raise InputError(f"sun at {np.degrees(sun_altitude):g}°; -90 to 90 expected")
    sun = SunPosition(np.array([sun_altitude]), np.array([sun_azimuth]))
    visible = np.array([direct_normal * (sun_altitude > 0)], dtype=float)
    sky = np.array([diffuse_horizontal], dtype=float)
    times = np.array([time], dtype="datetime64[s]")

    # The state of the sky follows from the irradiance of the whole spectrum
    lux = Illuminance(LUMINOUS_EFFICACY * visible, LUMINOUS_EFFICACY * sky)
    irradiance = irradiance_of(lux, times=times, sun=sun)
    state = sky_state(
        *irradiance, altitude=sun.altitude, day_of_year=day_of_year(times)
    )
    found = perez_under(
        SkyConditions(sun, state, visible, sky),
        ground_reflectance=ground_reflectance,
        sky_colour=sky_colour,
    )
    return found if with_sun else replace(found, direct_normal=0.0)
