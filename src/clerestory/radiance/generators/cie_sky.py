"""Radiance's gensky: CIE clear, intermediate, overcast and uniform skies.

References: Radiance, gensky (radiances, efficacies, normalization); R. Dogniaux (zenith
luminance of clear skies); R. G. Hopkinson (overcast). Values are not rounded.
"""

import warnings
from collections.abc import Mapping

import numpy as np

from clerestory.errors import ClerestoryWarning
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.sun_place import direction, read_moment, sun_source
from clerestory.scene.primitive import Primitive, primitive
from clerestory.sky.gensky import (
    HIGHEST_SUN,
    SUN_SOLID_ANGLE,
    CieSky,
    sun_radiance,
    zenith_radiance,
)

# Angular diameter of the sun [deg]
_SUN_ANGLE_DEG = 0.5

# Sky types of the options, and their numbers in skybright.cal
_KINDS: dict[str, CieSky] = {
    "s": "clear",
    "c": "overcast",
    "u": "uniform",
    "i": "intermediate",
}
_NUMBERS = {"clear": 1, "overcast": 2, "uniform": 3, "intermediate": 4}

# Options that are followed by a number
_VALUES = {
    "-t": "the turbidity",
    "-g": "the ground reflectance",
    "-b": "the zenith radiance",
    "-B": "the horizontal irradiance",
    "-r": "the radiance of the sun",
    "-R": "the irradiance of the sun",
}

# Sky irradiance on the horizontal / zenith radiance: polynomial in the solar altitude
_NORMAL = {
    "clear": (2.766521, 0.547665, -0.369832, 0.009237, 0.059229),
    "intermediate": (3.5556, -2.7152, -1.3081, 1.0660, 0.60227),
}


def gensky(words: WordReader) -> list[Primitive]:
    """Return the primitives of `gensky month day hour` or `gensky -ang alt azi`.

    Options: -s +s -c -u -i +i, -g -t, -b -B, -r -R, -a -o -m -y.
    """
    moment = read_moment(words)
    kind: CieSky = "clear"
    with_sun, given = True, {"-t": 2.45, "-g": 0.2}
    while words.left:
        option = words.option()
        if option[1:] in _KINDS:
            kind = _KINDS[option[1:]]
            with_sun = option[0] == "+" if kind in _NORMAL else with_sun
        elif option in _VALUES:
            # The last of -b and -B applies, and the last of -r and -R
            given.pop(option.swapcase(), None)
            given[option] = words.real(_VALUES[option])
        elif not moment.take(option, words):
            raise words.unknown(option)
    altitude, azimuth = moment.sun()
    if kind in _NORMAL and altitude > HIGHEST_SUN:
        warnings.warn(
            f"{words.program}: the sun's altitude is {np.degrees(altitude):.1f}°; the"
            " clear sky is that of 87°",
            ClerestoryWarning,
            stacklevel=2,
        )
        altitude = HIGHEST_SUN
    return _sky(kind, given, altitude, azimuth, with_sun=with_sun)


def _sky(
    kind: CieSky,
    given: Mapping[str, float],
    altitude: float,
    azimuth: float,
    *,
    with_sun: bool,
) -> list[Primitive]:
    sun = direction(altitude, azimuth)
    height = float(sun[2])

    # Zenith radiance, and radiance of a white horizontal plane lit by the sky alone
    near_sun, share = levels(kind, altitude, height)
    zenith = given.get("-b", zenith_radiance(kind, altitude, given["-t"]))
    zenith = given["-B"] / (share * np.pi) if "-B" in given else zenith
    ambient = zenith * share

    # Radiance of the sun; it lights the ground even if the output has no sun
    made = []
    if kind in _NORMAL and height > 0:
        radiance = given.get("-r", sun_radiance(kind, height))
        if "-R" in given:
            radiance = given["-R"] / (SUN_SOLID_ANGLE * height)
        ambient += SUN_SOLID_ANGLE / np.pi * max(radiance, 0) * height
        if with_sun and radiance > 0:
            made = sun_source(radiance, sun, angle_deg=_SUN_ANGLE_DEG)
    reals = [_NUMBERS[kind], zenith, ambient * given["-g"]]
    reals += [near_sun, *sun] if kind in _NORMAL else []
    sky = ("skybr", "skybright.cal")
    return [*made, primitive("void", "brightfunc", "skyfunc", reals, sky)]


def levels(kind: CieSky, altitude: float, height: float) -> tuple[float, float]:
    """Return the relative zenith radiance and the normalization factor of a sky.

    The normalization factor is the radiance of a white horizontal plane lit by the sky
    alone, divided by the zenith radiance. `height` is the sine of the sun's `altitude`
    [rad].
    """
    if kind == "uniform":
        return 1.0, 1.0
    if kind == "overcast":
        return 1.0, 7 / 9
    zenith_angle = np.pi / 2 - altitude
    if kind == "clear":
        shine = 0.91 + 10 * np.exp(-3 * zenith_angle) + 0.45 * height**2
        near_sun = 0.274 * shine
    else:
        near_sun = (2.739 + 0.9891 * np.sin(0.3119 + 2.6 * altitude)) * np.exp(
            -zenith_angle * (0.4441 + 1.48 * altitude)
        )
    x = (altitude - np.pi / 4) / (np.pi / 4)
    polynomial = np.polynomial.polynomial.polyval(x, _NORMAL[kind])
    return float(near_sun), float(polynomial / near_sun / np.pi)
