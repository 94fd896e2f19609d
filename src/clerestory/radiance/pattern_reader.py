"""Reader of patterns, textures and mixture fractions in scene files.

The function files of Radiance's library are replaced by `cal.program`, unless the
folder of the scene file or the current directory has a file of the same name. Other
function files are searched for in these folders and in RAYPATH.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from clerestory.array_types import Vector
from clerestory.checks import require
from clerestory.errors import located
from clerestory.files import is_file, read_text
from clerestory.formats.photometry.read import LUMINAIRE_SUFFIXES, read_luminaire
from clerestory.radiance.cal.program import FUNCTION_FILES, Program
from clerestory.radiance.cal.syntax import (
    Name,
    Node,
    parse_definitions,
    parse_expression,
)
from clerestory.radiance.data_array import DataArray, read_data_array
from clerestory.radiance.function_pattern import (
    KNOWN,
    FunctionPattern,
    constant_value,
    constant_vector,
)
from clerestory.radiance.generators.luminaire import intensity_table
from clerestory.radiance.modifiers import Modifiers
from clerestory.radiance.search_path import library_file
from clerestory.radiance.spectrum_reader import SPECTRAL_KINDS, read_spectral
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Arguments
from clerestory.scene.transform import Transform


def read_modifiers(given: Arguments, *, placed: Transform) -> Modifiers:
    """Return the pattern or texture defined by a primitive of `PATTERN_KINDS`.

    `placed` is the transform of the scene file that contains the primitive.
    """
    if given.item.kind in SPECTRAL_KINDS:
        return Modifiers(spectra=(read_spectral(given, _definitions),))
    made = _read(given, placed)
    textured = given.item.kind in _TEXTURES
    return Modifiers((), (made,)) if textured else Modifiers((made,))


def read_share(given: Arguments, placed: Transform) -> float | Pattern:
    """Return the foreground fraction of a mixture, as a constant or a pattern.

    The first channel of the pattern is the foreground fraction. The third string
    argument, after the two materials, is the function.
    """
    share = _read(given, placed)
    constant = constant_value(share)
    return share if constant is None else float(np.clip(constant[0], 0, 1))


def read_vector(given: Arguments, placed: Transform, first: int) -> Vector | Pattern:
    """Return a vector given by three expressions; a pattern if the vector varies.

    `first` is the index of the string argument with the first expression. The
    expressions give the vector in function coordinates.
    """
    with given.located():
        vector = _pattern(given, placed, 3, first)
    constant = constant_vector(vector)
    return vector if constant is None else constant


def read_coefficients(given: Arguments, placed: Transform) -> tuple[Pattern, Pattern]:
    """Return the specular reflection and transmission of a BRTDfunc.

    The BRTD functions, by which Radiance scatters light of its sources only, must be 0.
    """
    with given.located():
        whole = _pattern(given, placed, 9, 0)
        perturbed = sorted(whole.names & {"RdotP", "NxP", "NyP", "NzP"})
        require(not perturbed, f'"{"".join(perturbed[:1])}" is used; Rdot expected')
    parts = (whole.expressions[i : i + 3] for i in (0, 3, 6))
    reflection, transmission, brtd = (replace(whole, expressions=e) for e in parts)
    scattered = constant_vector(brtd)
    if scattered is None or np.any(scattered):
        raise given.error(
            "the BRTD functions are not zero; 0 0 0, or a BSDF file (type BSDF) instead"
            " of BRTDfunc expected"
        )
    return reflection, transmission


def _read(given: Arguments, placed: Transform) -> FunctionPattern:
    count, first, files = _FORMS[given.item.kind]
    with given.located():
        return _pattern(given, placed, count, first, files)


def _pattern(
    given: Arguments, placed: Transform, count: int, first: int, files: int = 0
) -> FunctionPattern:
    # Order of string arguments, from index `first` on: `count` functions, data files,
    # function file, one coordinate per axis of the data, transform
    middle = first + count
    at = middle + files
    strings = given.strings(at + 1, f"{at + 1} or more")
    tables = tuple(_table(given, name) for name in strings[middle:at])
    axes = {len(table.axes) for table in tables} or {0}
    message = "the data files have different numbers of axes; equal numbers expected"
    require(len(axes) == 1, message)
    end = at + 1 + axes.pop()
    require(
        len(strings) >= end,
        f"{len(strings) - at - 1} coordinate(s) given, but the data file has"
        f" {end - at - 1} axes; one coordinate per axis expected",
    )
    program = _definitions(given, at)
    places = tuple(_expression(given, text) for text in strings[at + 1 : end])
    functions: tuple[Node, ...] = tuple(
        Name(text) if files else _expression(given, text)
        for text in strings[first:middle]
    )
    transform = _transform(given, end, placed)
    _check(given, program, (*places, *functions))
    own = given.item.reals, transform, given.source
    return FunctionPattern(program, functions, *own, tables, places)


# Number of functions, string index of the first function, number of data files
_FORMS: Mapping[str, tuple[int, int, int]] = {
    "brightfunc": (1, 0, 0),
    "colorfunc": (3, 0, 0),
    "brightdata": (1, 0, 1),
    "colordata": (3, 0, 3),
    "texfunc": (3, 0, 0),
    "texdata": (3, 0, 3),
    "mixfunc": (1, 2, 0),
    "mixdata": (1, 2, 1),
}
_TEXTURES = ("texfunc", "texdata")
PATTERN_KINDS = (frozenset(_FORMS) - {"mixfunc", "mixdata"}) | SPECTRAL_KINDS


def _table(given: Arguments, name: str) -> DataArray:
    # Photometric files give tables of radiant intensity
    path = library_file(name, beside=given.file, line=given.item.line)
    if path.suffix.lower() in LUMINAIRE_SUFFIXES:
        return intensity_table(read_luminaire(path))
    return read_data_array(path)


def _transform(given: Arguments, at: int, placed: Transform) -> Transform:
    # As in Radiance, the transform begins at the first word with a leading dash
    strings = given.item.strings
    while at < len(strings) and not strings[at].startswith("-"):
        at += 1
    return given.transform(at).then(placed)


def _expression(given: Arguments, text: str) -> Node:
    where = f'{given.subject}: in "{text}"'
    with located(file=given.file, line=given.item.line, subject=where):
        return parse_expression(text)


def _definitions(given: Arguments, at: int) -> Program:
    # Definitions in the function file, string argument `at`; "." is no file
    name = given.item.strings[at]
    if name == ".":
        return Program()
    beside = (Path(given.file).parent / name, Path(name))
    if Path(name).name in FUNCTION_FILES and not any(is_file(p) for p in beside):
        return Program(FUNCTION_FILES[Path(name).name])
    path = library_file(name, beside=given.file, line=given.item.line)
    return Program(parse_definitions(read_text(path), file=str(path)))


def _check(given: Arguments, program: Program, nodes: tuple[Node, ...]) -> None:
    # Undefined names are reported before rendering
    unknown = sorted(program.uses(*nodes) - KNOWN)
    if unknown:
        raise given.error(
            f'"{unknown[0]}" is not defined, or not available at an emitter;'
            " a name of its function file, an argument or D, N, P expected"
        )
    # Evaluation for one ray detects missing real arguments
    computed = {"S": np.ones(1), **{name: np.full(1, 0.5) for name in KNOWN}}
    computed |= {"Dx": np.zeros(1), "Dy": np.full(1, 0.6), "Dz": np.full(1, 0.8)}
    values = tuple(node for node in nodes if program.is_value(node))
    if values:
        program.values(values, computed, given.item.reals)
