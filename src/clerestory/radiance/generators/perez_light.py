"""Irradiance options of gendaylit, and parameters of the Perez sky.

References: R. Perez et al., Solar Energy 44 (5), 1990; D. G. Erbs, S. A. Klein, J. A.
Duffie, Solar Energy 28 (4), 1982 (-E); Radiance, gendaylit (limits, order of steps).
"""

from dataclasses import dataclass

import numpy as np

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.formats.word_reader import WordReader
from clerestory.sky.sky_state import (
    SOLAR_CONSTANT,
    SkyState,
    orbit_factor,
    visible_irradiance,
)

# Limits of Perez's sky clearness and brightness; boundaries of the clearness bins
_CLEARNESS = (1.0, 12.009)
_BRIGHTNESS = (0.01, 0.6)
_CATEGORIES = np.array([1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200])

# Dew point at 2 cm of precipitable water [°C]
DEW_POINT_C = 10.97353115

# Maximum direct normal illuminance: extraterrestrial solar illuminance [lx]
_MOST_LUX = 127_500.0

# Iterations of the conversion from illuminance to irradiance
_ROUNDS = 9


@dataclass
class Request:
    """Values of the command's options.

    Attributes
    ----------
    by : option that gives the irradiance: -P, -W, -L, -G or -E
    given : arguments of that option
    output : output quantity: 0 visible radiance, 1 solar radiance, 2 luminance
    sun : whether the output includes the sun
    ground : reflectance of the ground
    dew_point_c : dew point [°C]
    """

    by: str = "-P"
    given: tuple[float, ...] = (0.0, 0.0)
    output: int = 0
    sun: bool = True
    ground: float = 0.2
    dew_point_c: float = DEW_POINT_C


@dataclass(frozen=True)
class Light:
    """Direct normal and diffuse horizontal irradiance [W/m²] or illuminance [lx]."""

    direct: float
    diffuse: float


@dataclass(frozen=True)
class Air:
    """Properties of the atmosphere and the sun.

    Attributes
    ----------
    altitude : altitude of the sun [rad]
    day_of_year : day of the year, for the earth-sun distance
    dew_point_c : dew point [°C]
    """

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
        """Relative air mass (Kasten 1966)."""
        haze = 0.15 * (93.885 - np.degrees(self.zenith)) ** -1.253
        return float(1 / (np.cos(self.zenith) + haze))

    @property
    def bend(self) -> float:
        """Zenith-angle term in Perez's sky clearness."""
        return 1.041 * self.zenith**3

    def light(self, request: Request, words: WordReader) -> Light | None:
        """Return the irradiance given by the options; None if diffuse is zero."""
        first, second = request.given[0], request.given[-1]
        match request.by:
            case "-P":
                diffuse = np.clip(second, *_BRIGHTNESS) / self.mass * self.outside
                clear = np.clip(first, *_CLEARNESS)
                light = Light(diffuse * (clear - 1) * (1 + self.bend), diffuse)
            case "-W":
                light = Light(first, second)
            case "-G":
                light = Light(first / np.sin(self.altitude), second)
            case "-E":
                light = self._erbs(first)
            case _:
                light = self._from_lux(first, second, request)
        light = Light(max(float(light.direct), 0.0), max(float(light.diffuse), 0.0))
        if light.direct > SOLAR_CONSTANT:
            raise words.error(
                f"direct normal irradiance {light.direct:.0f} W/m²;"
                f" at most {SOLAR_CONSTANT:.0f} expected"
            )
        return None if light.diffuse <= 0 else light

    def state(self, light: Light, request: Request) -> SkyState:
        """Return the sky clearness and brightness."""
        clear, bright = request.given if request.by == "-P" else (None, None)
        if clear is None or bright is None:
            ratio = (light.diffuse + light.direct) / light.diffuse
            clear = (ratio + self.bend) / (1 + self.bend)
            bright = light.diffuse * self.mass / self.outside
        clearness = np.clip(np.array([clear]), *_CLEARNESS)
        return SkyState(
            np.array([self.zenith]),
            clearness,
            np.clip(np.array([bright]), *_BRIGHTNESS),
            np.searchsorted(_CATEGORIES, clearness, side="right"),
        )

    def output(
        self, light: Light, state: SkyState, request: Request, words: WordReader
    ) -> Light:
        """Return visible or solar irradiance, or illuminance, as selected by -O."""
        if request.output == 1:
            return light
        if request.by == "-L":
            lux = Light(*(max(v, 0.0) for v in request.given))
        else:
            lux = self._to_lux(light, state)
        if lux.direct > _MOST_LUX:
            raise words.error(
                f"direct normal illuminance {lux.direct:.0f} lx;"
                f" at most {_MOST_LUX:.0f} expected"
            )
        per = 1.0 if request.output == 2 else LUMINOUS_EFFICACY
        return Light(lux.direct / per, lux.diffuse / per)

    def _to_lux(self, light: Light, state: SkyState) -> Light:
        direct, diffuse = visible_irradiance(
            np.array([light.direct]),
            np.array([light.diffuse]),
            state=state,
            dew_point_c=np.array([self.dew_point_c]),
        )
        return Light(
            float(direct[0]) * LUMINOUS_EFFICACY, float(diffuse[0]) * LUMINOUS_EFFICACY
        )

    def _from_lux(self, direct: float, diffuse: float, request: Request) -> Light:
        # The luminous efficacy depends on the irradiance: fixed-point iteration
        per = SOLAR_CONSTANT / _MOST_LUX
        light = Light(max(direct, 0) * per, max(diffuse, 0) * per)
        for _ in range(_ROUNDS):
            if light.diffuse <= 0:
                break
            one = self._to_lux(Light(1.0, 1.0), self.state(light, request))
            light = Light(
                max(direct, 0) / one.direct if one.direct >= 0.1 else 0.0,
                max(diffuse, 0) / max(one.diffuse, 1e-9),
            )
        return light

    def _erbs(self, level: float) -> Light:
        # Diffuse fraction as a function of the clearness index
        outside = self.outside * np.sin(self.altitude)
        level = max(level, 0.0) if level <= outside else 0.999 * outside
        k = level / outside
        if k <= 0.22:
            share = 1 - 0.09 * k
        elif k <= 0.8:
            share = 0.9511 - 0.1604 * k + 4.388 * k**2 - 16.638 * k**3 + 12.336 * k**4
        else:
            share = 0.165
        diffuse = level * share
        return Light((level - diffuse) / np.sin(self.altitude), diffuse)
