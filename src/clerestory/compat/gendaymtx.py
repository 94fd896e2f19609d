"""gendaymtx: sky matrices of weather files, with Radiance's formulas.

References: G. Ward, manual page of gendaymtx(1).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from clerestory.checks import one_of, require
from clerestory.compat.streams import ENCODINGS, Streams
from clerestory.compat.words import Grammar, Word, reals, whole
from clerestory.matrix.radiance_format import Encoding
from clerestory.sky.sky_conditions import Spectrum, daylight_steps
from clerestory.sky.sky_matrix import Include, sky_matrix
from clerestory.sky.solar_radiance import SUN_DIAMETER_DEG, SunPlacement
from clerestory.sky.weather_formats import read_weather

PROGRAM = "gendaymtx"
_GRAMMAR = Grammar(
    PROGRAM,
    {
        **dict.fromkeys(("-v", "-h", "-A", "-d", "-s", "-u"), 0),
        **dict.fromkeys(("-r", "-m", "-5"), 1),
        **dict.fromkeys(("-g", "-c"), 3),
    },
    ("-o", "-O"),
)


@dataclass(frozen=True)
class _Call:
    # Options of a command line
    name: str = "-"
    include: Include = "all"
    subdivision: int = 1
    ground: tuple[float, ...] = (0.2,)
    colour: tuple[float, ...] | None = None
    rotation_deg: float = 0.0
    sun: SunPlacement = "spread"
    sun_deg: float = SUN_DIAMETER_DEG
    spectrum: Spectrum = "visible"
    encoding: Encoding = "ascii"
    header: bool = True
    daylight_only: bool = False
    mean: bool = False


def gendaymtx(words: Sequence[str], streams: Streams) -> None:
    """Run gendaymtx with the words of its command line."""
    call = _Call()
    for word in _GRAMMAR.words(words):
        call = _changed(call, word)
    weather = read_weather(streams.path(call.name))
    if call.daylight_only:
        weather = daylight_steps(weather, sun_formula="radiance")
    sky = sky_matrix(
        weather,
        subdivision=call.subdivision,
        include=call.include,
        sun=call.sun,
        sun_diameter_deg=call.sun_deg,
        ground_reflectance=call.ground if len(call.ground) > 1 else call.ground[0],
        sky_colour=call.colour,
        rotation_deg=call.rotation_deg,
        sun_formula="radiance",
        spectrum=call.spectrum,
    )
    sky = sky.mean() if call.mean else sky
    matrix = sky.to_transfer_matrix()
    place = sky.attributes["latitude_deg"], sky.attributes["longitude_deg"]
    streams.write_matrix(
        matrix,
        encoding=call.encoding,
        header=call.header,
        variables={"LATLONG": f"{place[0]} {place[1]}"},
    )


def _changed(call: _Call, word: Word) -> _Call:
    # Call with an option or the weather file added
    match word.name:
        case "":
            require(
                call.name == "-",
                f"{PROGRAM}: several weather files given; one expected",
            )
            return replace(call, name=word.text)
        case "-d" | "-s":
            return replace(call, include="sun" if word.name == "-d" else "sky")
        case "-m":
            return replace(call, subdivision=whole(word, PROGRAM, least=1))
        case "-5":
            [diameter] = reals(word, PROGRAM)
            placement: SunPlacement = "disc" if diameter else "patch"
            return replace(call, sun=placement, sun_deg=diameter or SUN_DIAMETER_DEG)
        case "-r":
            return replace(call, rotation_deg=reals(word, PROGRAM)[0])
        case "-g":
            return replace(call, ground=reals(word, PROGRAM))
        case "-c":
            return replace(call, colour=reals(word, PROGRAM))
        case "-o":
            one_of(word.text, f"{PROGRAM} -o", choices=("f", "d"))
            return replace(call, encoding=ENCODINGS[word.text])
        case "-O":
            one_of(word.text, f"{PROGRAM} -O", choices=("0", "1"))
            return replace(call, spectrum="solar" if word.text == "1" else "visible")
        case "-h":
            return replace(call, header=word.on if word.sign else False)
        case "-A":
            return replace(call, mean=True)
        case "-u":
            return replace(call, daylight_only=True)
        case _:
            return call
