"""Perez sky parameters: clearness, brightness and luminous efficacy.

Irradiance in weather data covers the whole solar spectrum. Visible irradiance, as
in Radiance, is illuminance divided by 179 lm/W; illuminance is computed by the Perez
model of the luminous efficacy of direct and diffuse irradiance.

Reference: R. Perez, P. Ineichen, R. Seals, J. Michalsky, R. Stewart, Modeling
daylight availability and irradiance components from direct and global
irradiance, Solar Energy 44 (5), 1990. Limits of the parameters as in gendaymtx.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from clerestory.array_types import Series
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.sky.solar_position import SunPosition
from clerestory.sky.solar_position import day_of_year as day_number
from clerestory.sky.weather import Illuminance

SOLAR_CONSTANT = 1367.0  # [W/m²], as in gendaymtx

# Default dew point [°C], as in gendaymtx
DEFAULT_DEW_POINT_C = 11.0

# Limits of the solar zenith angle [rad]
_ZENITH_LIMITS = (np.radians(3.0), np.pi / 2)

# Table 1: lower limits of clearness categories 2…8
CLEARNESS_LIMITS = np.array([1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200])
_MAX_CLEARNESS = 11.9
BRIGHTNESS_LIMITS = (0.01, 0.6)

# Table 4: coefficients a, b, c, d of the luminous efficacy, by category
_DIFFUSE = np.array(
    [
        [97.24, -0.46, 12.00, -8.91],
        [107.22, 1.15, 0.59, -3.95],
        [104.97, 2.96, -5.53, -8.77],
        [102.39, 5.59, -13.95, -13.90],
        [100.71, 5.94, -22.75, -23.74],
        [106.42, 3.83, -36.15, -28.83],
        [141.88, 1.90, -53.24, -14.03],
        [152.23, 0.35, -45.27, -7.98],
    ]
)
_DIRECT = np.array(
    [
        [57.20, -4.55, -2.98, 117.12],
        [98.99, -3.46, -1.21, 12.38],
        [109.83, -4.90, -1.71, -8.81],
        [110.34, -5.84, -1.99, -4.56],
        [106.36, -3.97, -1.75, -6.16],
        [107.19, -1.25, -1.51, -26.73],
        [105.75, 0.77, -1.26, -34.44],
        [101.18, 1.58, -1.10, -8.29],
    ]
)

# Initial luminous efficacy, typical of an average sky [lm/W]
_MEAN_EFFICACY = 110.0
_ITERATIONS = 40

# Bounds of the luminous efficacy of daylight [lm/W]
_EFFICACIES = (20.0, 250.0)


@dataclass(frozen=True, eq=False)
class SkyState:
    """Parameters of the Perez models at each time step.

    The parameters are solar zenith angle [rad], limited to 3°…90°, sky clearness ε, sky
    brightness Δ, and clearness category, from 0 (overcast) to 7 (clear).
    """

    zenith: Series
    clearness: Series
    brightness: Series
    category: Int[np.ndarray, " time"]


def sky_state(
    direct_normal: Series,
    diffuse_horizontal: Series,
    *,
    altitude: Series,
    day_of_year: Int[np.ndarray, " time"],
) -> SkyState:
    """Return the Perez parameters of the sky (Perez et al. 1990, eqs. 1 and 2)."""
    zenith = np.clip(np.pi / 2 - altitude, *_ZENITH_LIMITS)

    # Clearness, at its upper limit if there is no diffuse irradiance
    correction = 1.041 * zenith**3
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ratio = np.where(direct_normal > 0, direct_normal / diffuse_horizontal, 0.0)
    clearness = np.minimum((1 + ratio + correction) / (1 + correction), _MAX_CLEARNESS)

    # Brightness
    extraterrestrial = SOLAR_CONSTANT * orbit_factor(day_of_year)
    brightness = diffuse_horizontal * air_mass(zenith) / extraterrestrial
    brightness = np.clip(brightness, *BRIGHTNESS_LIMITS)
    category = np.searchsorted(CLEARNESS_LIMITS, clearness, side="right")
    return SkyState(zenith, clearness, brightness, category)


def visible_irradiance(
    direct_normal: Series,
    diffuse_horizontal: Series,
    *,
    state: SkyState,
    dew_point_c: Series,
) -> tuple[Series, Series]:
    """Return visible direct normal and diffuse horizontal irradiance [W/m²].

    Visible irradiance is irradiance times luminous efficacy (Perez et al. 1990, eqs. 7
    and 8), divided by 179 lm/W.
    """
    water = precipitable_water_cm(dew_point_c)
    a, b, c, d = _DIFFUSE[state.category].T
    efficacy = a + b * water + c * np.cos(state.zenith) + d * np.log(state.brightness)
    diffuse = diffuse_horizontal * np.maximum(efficacy, 0)

    a, b, c, d = _DIRECT[state.category].T
    exponential = np.exp(5.73 * state.zenith - 5)
    efficacy = a + b * water + c * exponential + d * state.brightness
    direct = direct_normal * np.maximum(efficacy, 0)
    return direct / LUMINOUS_EFFICACY, diffuse / LUMINOUS_EFFICACY


def precipitable_water_cm(dew_point_c: Series) -> Series:
    """Precipitable water [cm] from the dew point (Perez et al. 1990, eq. 3)."""
    return np.asarray(np.exp(0.07 * dew_point_c - 0.075))


def irradiance_of(
    illuminance: Illuminance,
    *,
    times: np.ndarray,
    sun: SunPosition,
    dew_point_c: Series | None = None,
) -> tuple[Series, Series]:
    """Return direct normal and diffuse horizontal irradiance [W/m²] from illuminance.

    The luminous efficacy depends on the irradiance, so the irradiance is computed by
    fixed-point iteration. The efficacy is discontinuous between clearness categories:
    for some illuminances there are two solutions, for a few there is none. Unknown dew
    points (NaN or None) are replaced by 11 °C.
    """
    lux = np.stack([illuminance.direct_normal, illuminance.diffuse_horizontal])
    dew_point = np.full(lux.shape[1], np.nan) if dew_point_c is None else dew_point_c
    dew_point = np.where(np.isfinite(dew_point), dew_point, DEFAULT_DEW_POINT_C)
    efficacy = np.full(lux.shape, _MEAN_EFFICACY)
    day = day_number(times)
    for iteration in range(_ITERATIONS):
        irradiance = lux / efficacy
        state = sky_state(*irradiance, altitude=sun.altitude, day_of_year=day)
        visible = visible_irradiance(*irradiance, state=state, dew_point_c=dew_point)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = LUMINOUS_EFFICACY * np.stack(visible) / irradiance
        found = np.where(lux > 0, found, _MEAN_EFFICACY)

        # Under-relax later iterations to prevent oscillation of the clearness category
        share = 1.0 if iteration < _ITERATIONS / 4 else 0.5
        efficacy = np.clip(efficacy + share * (found - efficacy), *_EFFICACIES)
    direct, diffuse = lux / efficacy
    return direct, diffuse


def orbit_factor(day_of_year: Int[np.ndarray, " time"]) -> Series:
    """Squared ratio of mean to actual distance between sun and earth (Spencer 1971)."""
    angle = 2 * np.pi / 365 * (day_of_year - 1)
    factor = 1.00011 + 0.034221 * np.cos(angle) + 0.00128 * np.sin(angle)
    return np.asarray(
        factor + 0.000719 * np.cos(2 * angle) + 0.000077 * np.sin(2 * angle)
    )


def air_mass(zenith: Series) -> Series:
    """Relative air mass (Kasten 1966) by solar zenith angle [rad]."""
    term = 0.15 * (93.885 - np.degrees(zenith)) ** -1.253
    return np.asarray(1 / (np.cos(zenith) + term))
