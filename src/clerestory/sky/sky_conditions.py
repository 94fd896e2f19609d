"""Sky conditions: solar position, Perez parameters and visible irradiance per step.

Sky matrices and skies as functions of direction are computed from sky conditions.
"""

import warnings
from dataclasses import dataclass
from typing import Literal, TypedDict

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Series
from clerestory.brief_repr import brief
from clerestory.checks import finite, one_of, require, within
from clerestory.constants import LUMINOUS_EFFICACY, SUN_DIAMETER
from clerestory.errors import ClerestoryWarning
from clerestory.sky.sky_state import (
    DEFAULT_DEW_POINT_C,
    SkyState,
    sky_state,
    visible_irradiance,
)
from clerestory.sky.solar_position import SunFormula, SunPosition, day_of_year, sun_at
from clerestory.sky.weather import Weather

Spectrum = Literal["visible", "solar"]

# Irradiance up to which a time step is night [W/m²], as in gendaymtx
_NIGHT = 1e-4

# Direct normal irradiance at night above which a warning is issued [W/m²]
_BRIGHT = 20.0

# Number of Newton iterations, enough for sunrise times within a few seconds
_ITERATIONS = 3

# Range of dew points on Earth [°C]
_DEW_POINTS = (-60.0, 35.0)


@dataclass(frozen=True, eq=False)
class SkyConditions:
    """Solar position in scene coordinates, Perez parameters and irradiance per step.

    Irradiance [W/m²] is either visible or solar (whole spectrum), and zero at night.
    Unknown dew points [°C] are replaced by 11 °C.
    """

    sun: SunPosition
    state: SkyState
    direct_normal: Series
    diffuse_horizontal: Series
    dew_point_c: Series

    __repr__ = brief

    @property
    def lit(self) -> Bool[np.ndarray, " time"]:
        """Whether direct or diffuse irradiance is above zero at each time step."""
        return np.asarray(self.direct_normal + self.diffuse_horizontal > 0)

    def direct_horizontal(self) -> Series:
        """Direct horizontal irradiance [W/m²]."""
        return np.asarray(self.direct_normal * np.maximum(np.sin(self.sun.altitude), 0))


class SkyOptions(TypedDict, total=False):
    """Keyword arguments that other functions pass to `sky_conditions`."""

    rotation_deg: float
    sun_formula: SunFormula
    dew_point_c: float | None
    spectrum: Spectrum


def sky_conditions(
    weather: Weather,
    *,
    rotation_deg: float = 0.0,
    sun_formula: SunFormula = "spa",
    dew_point_c: float | None = None,
    spectrum: Spectrum = "visible",
) -> SkyConditions:
    """Return the sky conditions at each time step of the weather.

    Parameters
    ----------
    rotation_deg : azimuth of the scene's y axis, clockwise from north [°]
    sun_formula : formula of the solar position: "spa", or "radiance" for comparisons
    dew_point_c : dew point of all steps [°C]; default: from the weather data, or 11 °C
    spectrum : "visible": irradiance is illuminance divided by 179 lm/W; "solar":
        irradiance of the whole solar spectrum, as in weather data
    """
    one_of(spectrum, "spectrum", choices=("visible", "solar"))
    sun = sun_over(weather, rotation_deg=rotation_deg, sun_formula=sun_formula)
    _warn_of_light_at_night(weather, sun)

    # Perez parameters and visible irradiance
    direct, diffuse = weather.direct_normal, weather.diffuse_horizontal
    state = sky_state(
        direct, diffuse, altitude=sun.altitude, day_of_year=day_of_year(weather.times)
    )
    night = direct + diffuse <= _NIGHT
    dew_point = _dew_point(weather, dew_point_c)
    if spectrum == "visible" and weather.illuminance is not None:
        direct = weather.illuminance.direct_normal / LUMINOUS_EFFICACY
        diffuse = weather.illuminance.diffuse_horizontal / LUMINOUS_EFFICACY
    elif spectrum == "visible":
        direct, diffuse = visible_irradiance(
            direct, diffuse, state=state, dew_point_c=dew_point
        )
    return SkyConditions(
        sun,
        state,
        np.where(night, 0, direct),
        np.where(night, 0, diffuse),
        dew_point,
    )


def sun_over(
    weather: Weather, *, rotation_deg: float = 0.0, sun_formula: SunFormula = "spa"
) -> SunPosition:
    """Return the solar position at each time step of the weather.

    The position is computed at the centre of the time step or, in steps with sunrise or
    sunset, at the centre of the interval with the sun above the horizon. Radiance's
    formula is always evaluated at the centre of the time step, as in gendaymtx.
    """
    finite(rotation_deg, "rotation", unit="degrees")
    sun = sun_at(weather.site, weather.times, formula=sun_formula)
    if sun_formula == "spa":
        sun = _at_sunrise_and_sunset(weather, sun)
    return SunPosition(sun.altitude, sun.azimuth - np.radians(rotation_deg))


def daylight_steps(weather: Weather, *, sun_formula: SunFormula = "spa") -> Weather:
    """Return the weather of time steps with part of the sun above the horizon."""
    up = sun_over(weather, sun_formula=sun_formula).altitude > -SUN_DIAMETER / 2
    require(
        up.any(),
        "the sun is below the horizon at all steps; weather with daytime expected",
        file=weather.source or None,
    )
    return weather.select(up)


def _at_sunrise_and_sunset(weather: Weather, sun: SunPosition) -> SunPosition:
    # Only time steps with the sun near the horizon can contain sunrise or sunset
    half = np.timedelta64(round(weather.step_minutes * 30), "s")
    near = np.flatnonzero(np.abs(sun.altitude) < _reach(weather))
    if len(near) == 0:
        return sun
    centre = weather.times[near]
    first = sun_at(weather.site, centre - half).altitude
    last = sun_at(weather.site, centre + half).altitude
    cross = first * last < 0
    near, centre, first, last = near[cross], centre[cross], first[cross], last[cross]

    # Find sunrise or sunset by Newton's method, in time from -1 to 1 across the step
    def moved_to(share: Float[np.ndarray, " step"]) -> SunPosition:
        seconds = np.round(share * half.astype(float)).astype("timedelta64[s]")
        return sun_at(weather.site, centre + seconds)

    slope = (last - first) / 2
    horizon = (first + last) / (first - last)
    for _ in range(_ITERATIONS):
        horizon = np.clip(horizon - moved_to(horizon).altitude / slope, -1, 1)
    moved = moved_to(np.where(last > 0, (1 + horizon) / 2, (horizon - 1) / 2))
    altitude, azimuth = sun.altitude.copy(), sun.azimuth.copy()
    altitude[near], azimuth[near] = moved.altitude, moved.azimuth
    return SunPosition(altitude, azimuth)


def _reach(weather: Weather) -> float:
    # Largest change of solar altitude in half a time step, plus one degree [rad]
    return float(np.radians(15 * weather.step_minutes / 60 / 2 + 1))


def _warn_of_light_at_night(weather: Weather, sun: SunPosition) -> None:
    reach = _reach(weather)
    odd = (weather.direct_normal > _BRIGHT) & (sun.altitude < -reach)
    if np.any(odd):
        first = weather.times[np.argmax(odd)]
        warnings.warn(
            f"{weather.source or weather.place}: direct sun in"
            f" {np.count_nonzero(odd)} steps with the sun more than"
            f" {np.degrees(reach):.1f}° below the horizon (first: {first}): are time"
            " zone and longitude right?",
            ClerestoryWarning,
            stacklevel=4,
        )


def _dew_point(weather: Weather, fixed: float | None) -> Series:
    if fixed is not None:
        least, most = _DEW_POINTS
        within(fixed, "dew point", least=least, most=most, unit="°C")
        return np.full(len(weather), float(fixed))
    if weather.dew_point_c is None:
        return np.full(len(weather), DEFAULT_DEW_POINT_C)
    dew_point = np.where(
        np.isfinite(weather.dew_point_c), weather.dew_point_c, DEFAULT_DEW_POINT_C
    )
    return np.clip(dew_point, *_DEW_POINTS)
