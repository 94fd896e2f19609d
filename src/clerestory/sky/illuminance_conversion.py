"""Irradiance from measured illuminance, by inversion of the Perez efficacy model.

The luminous efficacy depends on the irradiance, so the irradiance is computed by
fixed-point iteration. The efficacy is discontinuous between clearness categories: for
some illuminances there are two solutions, for a few there is none. Sky matrices are
scaled to the measured illuminance.
"""

import numpy as np
from jaxtyping import Float

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.sky.sky_state import (
    DEFAULT_DEW_POINT_C,
    sky_state,
    visible_irradiance,
)
from clerestory.sky.solar_position import SunPosition, day_of_year
from clerestory.sky.weather import Illuminance

# Initial luminous efficacy: that of an average sky [lm/W]
_MEAN_EFFICACY = 110.0
_ITERATIONS = 40

# Bounds of the luminous efficacy of daylight [lm/W]
_EFFICACIES = (20.0, 250.0)


def irradiance_of(
    illuminance: Illuminance,
    *,
    times: np.ndarray,
    sun: SunPosition,
    dew_point_c: Float[np.ndarray, " time"] | None = None,
) -> tuple[Float[np.ndarray, " time"], Float[np.ndarray, " time"]]:
    """Return direct normal and diffuse horizontal irradiance [W/m²].

    Unknown dew points (NaN or None) are 11 °C.

    Skylight has a higher luminous efficacy than sunlight.

    >>> noon = np.array(["2023-06-21T12:00"], "datetime64[s]")
    >>> lux = Illuminance(np.array([80_000.0]), np.array([15_000.0]))
    >>> high = SunPosition(np.radians([60.0]), np.radians([180.0]))
    >>> direct, diffuse = irradiance_of(lux, times=noon, sun=high)
    >>> round(80_000 / float(direct[0])), round(15_000 / float(diffuse[0]))
    (103, 132)
    """
    lux = np.stack([illuminance.direct_normal, illuminance.diffuse_horizontal])
    dew_point = np.full(lux.shape[1], DEFAULT_DEW_POINT_C)
    if dew_point_c is not None:
        dew_point = np.where(np.isfinite(dew_point_c), dew_point_c, dew_point)
    efficacy = np.full(lux.shape, _MEAN_EFFICACY)
    day = day_of_year(times)
    for iteration in range(_ITERATIONS):
        irradiance = lux / efficacy
        state = sky_state(*irradiance, altitude=sun.altitude, day_of_year=day)
        visible = visible_irradiance(*irradiance, state=state, dew_point_c=dew_point)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = LUMINOUS_EFFICACY * np.stack(visible) / irradiance
        found = np.where(lux > 0, found, _MEAN_EFFICACY)

        # Under-relax later iterations to prevent oscillation between two categories
        share = 1.0 if iteration < _ITERATIONS / 4 else 0.5
        efficacy = np.clip(efficacy + share * (found - efficacy), *_EFFICACIES)
    direct, diffuse = lux / efficacy
    return direct, diffuse
