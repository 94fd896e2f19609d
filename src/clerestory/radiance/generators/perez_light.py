"""Irradiance options of gendaylit, and parameters of the Perez sky.

References: R. Perez et al., Solar Energy 44 (5), 1990; D. G. Erbs, S. A. Klein, J. A.
Duffie, Solar Energy 28 (4), 1982 (-E); Radiance, gendaylit (limits, order of steps).
"""

from dataclasses import dataclass

import numpy as np

from clerestory.array_types import Vector2
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.formats.word_reader import WordReader
from clerestory.sky.sky_state import (
    BRIGHTNESS_LIMITS,
    CLEARNESS_LIMITS,
    SOLAR_CONSTANT,
    SkyState,
    air_mass,
    orbit_factor,
    visible_irradiance,
)

# Direct normal and diffuse horizontal irradiance [W/m²] or illuminance [lx]
Light = Vector2

# Limits of Perez's sky clearness
_CLEARNESS = (1.0, 12.009)

# Dew point for 2 cm of precipitable water [°C]
DEW_POINT_C = 10.97353115

# Maximum direct normal illuminance: the extraterrestrial illuminance [lx]
_MOST_LUX = 127_500.0

# Number of iterations of the conversion from illuminance to irradiance
_ROUNDS = 9


@dataclass
class Request:
    """Values of the options of gendaylit.

    `by` is the option that gives the irradiance: -P, -W, -L, -G or -E. `output` is 0
    for visible radiance, 1 for solar radiance and 2 for luminance.
    """

    by: str = "-P"
    given: tuple[float, ...] = (0.0, 0.0)
    output: int = 0
    sun: bool = True
    ground: float = 0.2
    dew_point_c: float = DEW_POINT_C


@dataclass(frozen=True)
class Air:
    """Solar altitude [rad], day of the year and dew point [°C]."""

    altitude: float
    day_of_year: int
    dew_point_c: float

    @property
    def zenith(self) -> float:
        """Zenith angle of the sun [rad]."""
        return float(np.pi / 2 - self.altitude)

    @property
    def outside(self) -> float:
        """Extraterrestrial normal irradiance [W/m²]."""
        return SOLAR_CONSTANT * float(orbit_factor(np.array([self.day_of_year]))[0])

    @property
    def mass(self) -> float:
        """Relative air mass."""
        return float(air_mass(np.array([self.zenith]))[0])

    @property
    def bend(self) -> float:
        """Zenith angle term 1.041 ζ³ of Perez's sky clearness."""
        return 1.041 * self.zenith**3

    def light(self, request: Request, words: WordReader) -> Light | None:
        """Return direct and diffuse irradiance [W/m²]; None if diffuse is zero."""
        first, second = request.given[0], request.given[-1]
        match request.by:
            case "-P":
                diffuse = np.clip(second, *BRIGHTNESS_LIMITS) / self.mass * self.outside
                clear = np.clip(first, *_CLEARNESS)
                light = np.array([(clear - 1) * (1 + self.bend), 1.0]) * diffuse
            case "-W":
                light = np.array([first, second])
            case "-G":
                light = np.array([first / np.sin(self.altitude), second])
            case "-E":
                light = self._erbs(first)
            case _:
                light = self._from_lux(np.array([first, second]), request)
        light = np.maximum(light, 0.0)
        if light[0] > SOLAR_CONSTANT:
            raise words.error(
                f"direct normal irradiance is {light[0]:.0f} W/m²;"
                f" at most {SOLAR_CONSTANT:.0f} W/m² expected"
            )
        return light if light[1] > 0 else None

    def state(self, light: Light, request: Request) -> SkyState:
        """Return Perez's sky clearness and sky brightness."""
        if request.by == "-P":
            clear, bright = request.given
        else:
            clear = (light.sum() / light[1] + self.bend) / (1 + self.bend)
            bright = light[1] * self.mass / self.outside
        clearness = np.clip(np.array([clear]), *_CLEARNESS)
        return SkyState(
            np.array([self.zenith]),
            clearness,
            np.clip(np.array([bright]), *BRIGHTNESS_LIMITS),
            np.searchsorted(CLEARNESS_LIMITS, clearness, side="right"),
        )

    def output(
        self, light: Light, state: SkyState, request: Request, words: WordReader
    ) -> Light:
        """Return visible irradiance, solar irradiance or illuminance (option -O)."""
        if request.output == 1:
            return light
        if request.by == "-L":
            lux = np.maximum(request.given, 0.0)
        else:
            lux = self._to_lux(light, state)
        if lux[0] > _MOST_LUX:
            raise words.error(
                f"direct normal illuminance is {lux[0]:.0f} lx;"
                f" at most {_MOST_LUX:.0f} lx expected"
            )
        return lux / (1.0 if request.output == 2 else LUMINOUS_EFFICACY)

    def _to_lux(self, light: Light, state: SkyState) -> Light:
        dew = np.array([self.dew_point_c])
        visible = visible_irradiance(light[:1], light[1:], state=state, dew_point_c=dew)
        return np.concatenate(visible) * LUMINOUS_EFFICACY

    def _from_lux(self, lux: Light, request: Request) -> Light:
        # The luminous efficacy depends on the irradiance: fixed-point iteration
        lux = np.maximum(lux, 0)
        light = lux * SOLAR_CONSTANT / _MOST_LUX
        for _ in range(_ROUNDS):
            if light[1] <= 0:
                break
            direct, diffuse = self._to_lux(np.ones(2), self.state(light, request))
            # The direct irradiance is 0 if the luminous efficacy is about 0
            direct = direct if direct >= 0.1 else np.inf
            light = lux / np.array([direct, max(diffuse, 1e-9)])
        return light

    def _erbs(self, level: float) -> Light:
        # Erbs's diffuse fraction as a function of the clearness index
        sine = np.sin(self.altitude)
        outside = self.outside * sine
        level = max(level, 0.0) if level <= outside else 0.999 * outside
        k = level / outside
        if k <= 0.22:
            share = 1 - 0.09 * k
        elif k <= 0.8:
            share = 0.9511 - 0.1604 * k + 4.388 * k**2 - 16.638 * k**3 + 12.336 * k**4
        else:
            share = 0.165
        return np.array([(1 - share) / sine, share]) * level
