"""Radiance's gensky: CIE clear, intermediate, overcast and uniform skies.

References: Radiance, gensky (radiances, efficacies, normalization); R. Dogniaux (zenith
luminance of clear skies); R. G. Hopkinson (overcast). Values are not rounded.
"""

import warnings
from dataclasses import dataclass

import numpy as np

from clerestory.errors import ClerestoryWarning
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.scene_text import primitive
from clerestory.radiance.generators.sun_place import Moment, direction, read_moment
from clerestory.sky.gensky import (
    HIGHEST_SUN,
    SUN_SOLID_ANGLE,
    CieSky,
    sun_radiance,
    zenith_radiance,
)

# Angular diameter of the sun [deg]
_SUN_ANGLE_DEG = 0.5

# Sky types as numbered in skybright.cal
CLEAR, OVERCAST, UNIFORM, INTERMEDIATE = 1, 2, 3, 4
_NAMES: dict[int, CieSky] = {
    CLEAR: "clear",
    OVERCAST: "overcast",
    UNIFORM: "uniform",
    INTERMEDIATE: "intermediate",
}

# Horizontal irradiance / zenith radiance: polynomial in the scaled sun altitude
_NORMAL = {
    CLEAR: (2.766521, 0.547665, -0.369832, 0.009237, 0.059229),
    INTERMEDIATE: (3.5556, -2.7152, -1.3081, 1.0660, 0.60227),
}


@dataclass
class _Request:
    # Values of the command's options
    kind: int = CLEAR
    sun: bool = True
    zenith: float | None = None
    horizontal: float | None = None
    sun_radiance: float | None = None
    sun_horizontal: float | None = None
    turbidity: float = 2.45
    ground: float = 0.2


def gensky(words: WordReader) -> list[str]:
    """Return the primitives of `gensky month day hour` or `gensky -ang alt azi`.

    Options: -s +s -c -u -i +i, -g -t, -b -B, -r -R, -a -o -m -y.
    """
    moment = read_moment(words)
    request = _Request()
    while words.left:
        option = words.option()
        if not (moment.take(option, words) or _take(request, option, words)):
            raise words.unknown(option)
    return _sky(request, moment, words)


def _take(request: _Request, option: str, words: WordReader) -> bool:
    kinds = {"s": CLEAR, "c": OVERCAST, "u": UNIFORM, "i": INTERMEDIATE}
    letter = option[1:]
    if letter in kinds:
        request.kind = kinds[letter]
        request.sun = option[0] == "+" if letter in "si" else request.sun
        return True
    match option:
        case "-t":
            request.turbidity = words.real("the turbidity")
        case "-g":
            request.ground = words.real("the ground reflectance")
        case "-b":
            request.zenith, request.horizontal = words.real("a radiance"), None
        case "-B":
            request.horizontal, request.zenith = words.real("an irradiance"), None
        case "-r":
            request.sun_radiance = words.real("a radiance")
            request.sun_horizontal = None
        case "-R":
            request.sun_horizontal = words.real("an irradiance")
            request.sun_radiance = None
        case _:
            return False
    return True


def _sky(request: _Request, moment: Moment, words: WordReader) -> list[str]:
    altitude, azimuth = moment.sun()
    kind = request.kind
    overcast = kind in (OVERCAST, UNIFORM)
    if not overcast and altitude > HIGHEST_SUN:
        warnings.warn(
            f"{words.program}: the sun's altitude is {np.degrees(altitude):.1f}°; the"
            " clear sky is that of 87°",
            ClerestoryWarning,
            stacklevel=2,
        )
        altitude = HIGHEST_SUN
    sun = direction(altitude, azimuth)

    # Zenith radiance, and radiance of a white horizontal plane lit by the sky alone
    near_sun, share = levels(kind, altitude, float(sun[2]))
    zenith = request.zenith
    if request.horizontal is not None:
        zenith = request.horizontal / (share * np.pi)
    elif zenith is None:
        zenith = zenith_radiance(_NAMES[kind], altitude, request.turbidity)
    ambient = zenith * share

    # Radiance of the sun; the sun lights the ground even if omitted from the output
    radiance = None if overcast else _sun_radiance(request, float(sun[2]))
    made = []
    if radiance is not None:
        ambient += SUN_SOLID_ANGLE / np.pi * radiance * float(sun[2])
        if request.sun:
            made = [
                primitive("void", "light", "solar", reals=(radiance,) * 3),
                primitive("solar", "source", "sun", reals=(*sun, _SUN_ANGLE_DEG)),
            ]
    reals = [kind, zenith, ambient * request.ground]
    reals += [] if overcast else [near_sun, *sun]
    sky = ("skybr", "skybright.cal")
    return [*made, primitive("void", "brightfunc", "skyfunc", strings=sky, reals=reals)]


def levels(kind: int, altitude: float, height: float) -> tuple[float, float]:
    """Return the relative zenith radiance and the normalization factor of a sky.

    The normalization factor is the radiance of a white horizontal plane divided by the
    zenith radiance.

    Parameters
    ----------
    kind : CLEAR, OVERCAST, UNIFORM or INTERMEDIATE
    altitude, height : altitude of the sun [rad], and its sine

    Examples
    --------
    >>> levels(OVERCAST, 0.5, 0.48)
    (1.0, 0.7777777777777778)
    """
    if kind == UNIFORM:
        return 1.0, 1.0
    if kind == OVERCAST:
        return 1.0, 7 / 9
    zenith_angle = np.pi / 2 - altitude
    if kind == CLEAR:
        shine = 0.91 + 10 * np.exp(-3 * zenith_angle) + 0.45 * height**2
        near_sun = 0.274 * shine
    else:
        near_sun = (2.739 + 0.9891 * np.sin(0.3119 + 2.6 * altitude)) * np.exp(
            -zenith_angle * (0.4441 + 1.48 * altitude)
        )
    x = (altitude - np.pi / 4) / (np.pi / 4)
    polynomial = np.polynomial.polynomial.polyval(x, _NORMAL[kind])
    return float(near_sun), float(polynomial / near_sun / np.pi)


def _sun_radiance(request: _Request, height: float) -> float | None:
    # None if the sun is below the horizon or has no radiance
    if height <= 0:
        return None
    given = request.sun_radiance
    if request.sun_horizontal is not None:
        given = request.sun_horizontal / (SUN_SOLID_ANGLE * height)
    if given is None:
        return sun_radiance(_NAMES[request.kind], height)
    return given if given > 0 else None
