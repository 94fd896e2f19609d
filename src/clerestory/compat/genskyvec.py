"""genskyvec: sky vector of a sky description, such as that of gensky or gendaylit.

The sun is spread over the nearest patches as in gendaymtx.

References: G. Ward, manual page of genskyvec(1).
"""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Values
from clerestory.checks import one_of, require
from clerestory.compat.streams import ENCODINGS, Streams
from clerestory.compat.words import Grammar, Word, reals, whole
from clerestory.constants import SKY_COLOUR
from clerestory.errors import located
from clerestory.files import read_text
from clerestory.matrix.radiance_format import Encoding
from clerestory.radiance.generated_sky import DOMES
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Emitter, Scene
from clerestory.scene.surface import DistantSource
from clerestory.sky.point_sky import PointSky, sky_vector

PROGRAM = "genskyvec"
_GRAMMAR = Grammar(PROGRAM, {"-m": 1, "-c": 3, "-d": 0, "-h": 0}, ("-o",))

# Sources wider than this are sky and ground [°]
_DOME_DEG = 90.0


@dataclass(frozen=True)
class _Call:
    # Options of a command line
    subdivision: int = 4
    colour: tuple[float, ...] = SKY_COLOUR
    sun_only: bool = False
    header: bool = True
    encoding: Encoding = "ascii"


def genskyvec(words: Sequence[str], streams: Streams) -> None:
    """Run genskyvec with the words of its command line."""
    call = _Call()
    for word in _GRAMMAR.words(words):
        call = _changed(call, word)
    sky = _described(read_text(streams.source), call)
    column = sky_vector(sky, subdivision=call.subdivision)
    streams.write_matrix(
        column.to_transfer_matrix(), encoding=call.encoding, header=call.header
    )


def _changed(call: _Call, word: Word) -> _Call:
    match word.name:
        case "-m":
            mf = whole(word, PROGRAM, least=1)
            require(mf <= 6, f"{PROGRAM}: -m is {mf}; a number from 1 to 6 expected")
            return replace(call, subdivision=mf)
        case "-c":
            return replace(call, colour=reals(word, PROGRAM))
        case "-d":
            return replace(call, sun_only=True)
        case "-h":
            return replace(call, header=word.on if word.sign else False)
        case "-o":
            one_of(word.text, f"{PROGRAM} -o", choices=tuple(ENCODINGS))
            return replace(call, encoding=ENCODINGS[word.text])
        case _:
            require(
                False,
                f"{PROGRAM}: {word.text!r} is a file; the sky on standard input and no"
                " file expected",
            )
            return call


def _described(text: str, call: _Call) -> PointSky:
    # Sky of a description, which is completed by sources for its function "skyfunc"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "sky.rad")
        domes = DOMES if "skyfunc" in text and "glow" not in text else ""
        file.write_text(f"{text}\n{domes}", encoding="utf-8")
        with located(file="standard input"):
            scene = read_rad(file)
    suns = [each for each in scene.distant if each.angle_deg < _DOME_DEG]
    wide = [each for each in scene.distant if each.angle_deg >= _DOME_DEG]
    require(
        len(suns) <= 1 and (suns or wide),
        f"{PROGRAM}: {len(suns)} suns and {len(wide)} skies in the description; the"
        " output of gensky or gendaylit expected",
    )
    dark = call.sun_only
    above = [] if dark else [each for each in wide if each.direction[2] > 0]
    below = [] if dark else [each for each in wide if each.direction[2] < 0]

    def luminance(direction: Directions, _sun: Values) -> Values:
        return _radiance(scene, above, direction)

    nadir = np.array([[0.0, 0.0, -1.0]])
    return PointSky(
        luminance,
        1.0,
        suns[0].direction if suns else np.array([0.0, 0.0, 1.0]),
        sum(_normal_irradiance(scene, each) for each in suns),
        float(_radiance(scene, below, nadir)[0]),
        call.colour,
    )


def _radiance(
    scene: Scene, sources: Sequence[DistantSource], direction: Directions
) -> Float[np.ndarray, " direction"]:
    # Mean of the channels of the radiance from each direction
    total = np.zeros(direction.shape[:-1])
    for source in sources:
        material = scene.materials[source.material]
        if not isinstance(material, Emitter):
            continue
        radiance = np.broadcast_to(material.radiance, direction.shape)
        if material.pattern is not None:
            radiance = radiance * material.pattern.value(direction)
        total += radiance.mean(axis=-1)
    return total


def _normal_irradiance(scene: Scene, sun: DistantSource) -> float:
    half = np.radians(sun.angle_deg / 2)
    radiance = float(_radiance(scene, [sun], sun.direction[None])[0])
    return radiance * np.pi * float(np.sin(half)) ** 2
