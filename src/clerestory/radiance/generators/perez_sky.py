"""Radiance's gendaylit: Perez all-weather sky for one moment.

As in gendaylit, the diffuse irradiance is a sum over the 145 Tregenza patches, and the
ratio of ground to zenith radiance is that of gensky's overcast, intermediate or clear
sky. Unlike in gendaylit, values are not rounded.

References: R. Perez et al., Solar Energy 44 (5), 1990 and 50 (3), 1993; D. G. Erbs,
S. A. Klein, J. A. Duffie, Solar Energy 28 (4), 1982 (-E); Radiance, gendaylit (limits).
"""

import warnings

import numpy as np

from clerestory.array_types import Vector
from clerestory.constants import SUN_DIAMETER
from clerestory.errors import ClerestoryWarning
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.cie_sky import levels
from clerestory.radiance.generators.perez_light import DEW_POINT_C, Air, Light, Request
from clerestory.radiance.generators.sun_place import (
    Moment,
    direction,
    read_moment,
    sun_source,
)
from clerestory.scene.primitive import Primitive, primitive
from clerestory.sky.gensky import HIGHEST_SUN, CieSky
from clerestory.sky.luminance_distribution import FiveParameters
from clerestory.sky.perez import perez_sky

_DEW_POINTS = (-40.0, 40.0)

# Solid angle of the sun [sr] in the ground irradiance, as in gendaylit
_SUN_ON_GROUND = 6.8e-5

# Tregenza rings: zenith angle [deg] and number of patches
_RINGS = ((84, 30), (72, 30), (60, 24), (48, 24), (36, 18), (24, 12), (12, 6), (0, 1))


def gendaylit(words: WordReader) -> list[Primitive]:
    """Return the primitives of `gendaylit month day hour` or `gendaylit -ang alt azi`.

    Options: -P -W -L -G -E, -O, -s +s -c, -g, -d, -w, -a -o -m -y. At night the sky is
    black, with a warning.
    """
    moment = read_moment(words)
    request, quiet = Request(), False
    while words.left:
        option = words.option()
        if option == "-w":
            quiet = True
        elif not (moment.take(option, words) or _take(request, option, words)):
            raise words.unknown(option)
    return _sky(request, moment, words, quiet=quiet)


def _take(request: Request, option: str, words: WordReader) -> bool:
    match option:
        case "-P" | "-W" | "-L" | "-G":
            request.by = option
            request.given = (words.real("a number"), words.real("a number"))
        case "-E":
            request.by, request.given = option, (words.real("an irradiance"),)
        case "-O":
            request.output = words.whole("the output type", 0, 2)
        case "-s" | "+s" | "-c":
            request.sun = option == "+s"
        case "-g":
            request.ground = words.real("the ground reflectance")
        case "-d":
            dew = words.real("a dew point")
            known = _DEW_POINTS[0] <= dew <= _DEW_POINTS[1]
            request.dew_point_c = dew if known else DEW_POINT_C
        case _:
            return False
    return True


def _sky(
    request: Request, moment: Moment, words: WordReader, *, quiet: bool
) -> list[Primitive]:
    altitude, azimuth = moment.sun()
    sun = direction(min(altitude, HIGHEST_SUN), azimuth)
    air = Air(min(altitude, HIGHEST_SUN), moment.day_of_year, request.dew_point_c)
    light = None if altitude <= 0 else air.light(request, words)
    if light is None:
        if not quiet:
            warnings.warn(
                f"{words.program}: no light at a sun altitude of"
                f" {np.degrees(altitude):.1f}°; the sky is black",
                ClerestoryWarning,
                stacklevel=2,
            )
        return [_sky_pattern([0.0] * 7, sun)]
    return _lit_sky(request, air, light, sun, words)


def _lit_sky(
    request: Request, air: Air, light: Light, sun: Vector, words: WordReader
) -> list[Primitive]:
    state = air.state(light, request)
    shape = perez_sky(state, azimuth=np.zeros(1)).parameters[:, 0].tolist()
    if shape[1] > 0:
        raise words.error(
            f"Perez's parameter b is {shape[1]:.3g}, for which the model is undefined;"
            " other irradiances expected"
        )
    sent = air.output(light, state, request, words)
    distribution = FiveParameters(*shape)
    towards = np.array([np.sin(air.zenith), 0.0, np.cos(air.zenith)])
    scale = sent[1] / _tregenza_integral(distribution, towards)
    radiance = sent[0] / (2 * np.pi * (1 - np.cos(SUN_DIAMETER / 2)))

    # Ground radiance, as under gensky's sky of similar clearness
    clearness = float(state.clearness[0])
    kind: CieSky = "overcast" if clearness <= 1 else "intermediate"
    kind = "clear" if clearness >= 6 else kind
    share = levels(kind, air.altitude, float(sun[2]))[1]
    up = np.array([0.0, 0.0, 1.0])
    ground = scale * float(distribution(up, towards)) * share
    shown = request.sun and clearness > 1
    ground += _SUN_ON_GROUND / np.pi * radiance * float(sun[2]) if shown else 0.0
    made = [_sky_pattern([scale, ground * request.ground, *shape], sun)]
    if shown and radiance > 0:
        made += sun_source(radiance, sun, angle_deg=np.degrees(SUN_DIAMETER))
    return made


def _sky_pattern(reals: list[float], sun: Vector) -> Primitive:
    strings = ("skybright", "perezlum.cal")
    return primitive("void", "brightfunc", "skyfunc", [*reals, *sun], strings)


def _tregenza_integral(distribution: FiveParameters, sun: Vector) -> float:
    # Horizontal irradiance, summed over 145 patch centres with equal solid angles
    theta = np.radians(np.repeat([t for t, _ in _RINGS], [n for _, n in _RINGS]))
    phi = np.concatenate([2 * np.pi * np.arange(n) / n for _, n in _RINGS])
    sine, cosine = np.sin(theta), np.cos(theta)
    direction = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1)
    return float((distribution(direction, sun) * cosine).sum() * 2 * np.pi / len(theta))
