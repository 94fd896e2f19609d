"""Radiance's ies2rad: luminaires from IES or EULUMDAT files.

Unlike ies2rad, the generator writes no data file: the `brightdata` pattern refers to
the photometric file. Lamps are white unless -c gives another colour.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError
from clerestory.formats.photometry.luminaire import Luminaire
from clerestory.formats.photometry.read import read_luminaire
from clerestory.formats.photometry.shining import faces, shining_surfaces
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.data_array import DataArray
from clerestory.radiance.primitives import specification
from clerestory.scene.primitive import Primitive, primitive
from clerestory.scene.surface import transformed
from clerestory.scene.transform import Transform

# Number of units of length per metre, by letter of option -d
_UNITS = {"m": 1.0, "c": 100.0, "f": 1 / 0.3048, "i": 12 / 0.3048}
_DIMENSION = re.compile(r"-d([mcfi])(?:/(\d+\.?\d*))?")

# Ignored options that have one argument
_NAMED = ("-p", "-l", "-f", "-u")


@dataclass
class _Request:
    # Values of the options of ies2rad
    file: str = ""
    name: str = ""
    scale: float = 1.0
    factor: float = 1.0
    colour: npt.ArrayLike = (1.0, 1.0, 1.0)


def ies2rad(words: WordReader, find: Callable[[str], Path]) -> list[Primitive]:
    """Return the primitives of `ies2rad [-dU] [-m factor] [-c r g b] [-o name] file`.

    The options -s, -p, -l, -f, -u and `-t default` are ignored.
    """
    request = _Request()
    while words.left:
        _take(request, words.word("a file"), words)
    if not request.file:
        raise words.error("the command has no file; an IES or EULUMDAT file expected")
    path = find(request.file)
    lamp = read_luminaire(path)
    name = request.name or path.stem
    made = [
        _distribution(lamp, path, request.factor, name),
        primitive(f"{name}_dist", "light", f"{name}_light", request.colour),
    ]
    size = Transform(np.diag([*[request.scale] * 3, 1.0]), request.scale)
    for part in shining_surfaces(lamp, material=f"{name}_light", name=name):
        shape = specification(transformed(part, size))
        made.append(primitive(part.material, shape.kind, part.name, shape.reals))
    return made


def _take(request: _Request, word: str, words: WordReader) -> None:
    unit = _DIMENSION.fullmatch(word)
    if unit is not None:
        request.scale = _UNITS[unit[1]] * float(unit[2] or 1)
    elif word == "-m":
        request.factor = words.positive("the multiplier")
    elif word == "-c":
        request.colour = words.several(3, "a colour")
    elif word == "-o":
        request.name = words.word("a name")
    elif word == "-t":
        if words.word("a type of lamp") != "default":
            raise words.error("lamp types are not supported; -c r g b expected")
    elif word in _NAMED:
        words.word("a name")
    elif word.startswith("-") and word != "-s":
        raise words.unknown(word)
    elif word != "-s":
        request.file = word


def _distribution(lamp: Luminaire, path: Path, factor: float, name: str) -> Primitive:
    # Pattern of the radiance: radiant intensity divided by projected area
    shape = lamp.shape
    reals: tuple[float, ...]
    if shape.kind == "sphere":
        correction, reals = "corr", (factor / (np.pi / 4 * shape.x**2),)
    elif faces(lamp).sides and shape.kind == "cylinder":
        correction, reals = "cylcorr", (factor, shape.x, shape.z)
    elif faces(lamp).sides:
        correction, reals = "boxcorr", (factor, shape.x, shape.y, shape.z)
    else:
        share = np.pi / 4 if shape.kind == "cylinder" else 1.0
        correction, reals = "flatcorr", (factor / (share * shape.x * shape.y),)
    strings = (correction, str(path.resolve()), "source.cal", *table_coordinates(lamp))
    return primitive("void", "brightdata", f"{name}_dist", reals, strings)


def intensity_table(luminaire: Luminaire) -> DataArray:
    """Return a table of the radiant intensity [W/sr] over the photometric angles."""
    value = luminaire.intensity / LUMINOUS_EFFICACY
    if len(luminaire.horizontal_deg) == 1:
        return DataArray((luminaire.vertical_deg,), value[0])
    return DataArray((luminaire.horizontal_deg, luminaire.vertical_deg), value)


def table_coordinates(luminaire: Luminaire) -> tuple[str, ...]:
    """Return the functions of source.cal that compute the photometric angles."""
    if luminaire.photometry == "A":
        raise InputError(
            f'luminaire "{luminaire.name}" has photometry of type A; B or C expected'
        )
    if luminaire.photometry == "B":
        return ("srcB_horiz", "srcB_vert")
    if len(luminaire.horizontal_deg) == 1:
        return ("src_theta",)
    return ("src_phi", "src_theta")
