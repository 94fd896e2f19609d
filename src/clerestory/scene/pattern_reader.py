"""Patterns as scene files write them, and the emitters they modify.

A function file named skybright.cal, perezlum.cal or source.cal stands for functions
of our own, unless a file of that name lies beside the scene or in the current
directory. Other files are looked for like every file that a scene names.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.scene.arguments import Arguments
from clerestory.scene.cal.files import NATIVE_FILES
from clerestory.scene.cal.program import Program
from clerestory.scene.cal.syntax import (
    Definition,
    Name,
    Node,
    parse_definitions,
    parse_expression,
)
from clerestory.scene.composite import Illum, Material
from clerestory.scene.data_array import DataArray, read_data_array
from clerestory.scene.emitter import Glow, Light, Spotlight
from clerestory.scene.library import library_file
from clerestory.scene.material import Metal, Plastic, Trans
from clerestory.scene.pattern import Pattern, Product
from clerestory.scene.pattern_function import (
    KNOWN,
    DataPattern,
    FunctionPattern,
    constant_value,
)
from clerestory.scene.photometry.read import LUMINAIRE_SUFFIXES, read_luminaire
from clerestory.scene.photometry.table import intensity_table
from clerestory.scene.statements import Primitive
from clerestory.scene.xform import Transform


def read_pattern(item: Primitive, *, file: str, placed: Transform) -> Pattern:
    """Return the pattern that a primitive describes.

    Parameters
    ----------
    item : a brightfunc, colorfunc, brightdata or colordata
    file : where it stands
    placed : transform of the file that holds it

    Raises
    ------
    InputError : with file and line, where a function or table is missing, malformed,
        or asks for what a pattern of an emitter cannot know
    """
    given = Arguments(item, file)
    try:
        return PATTERNS[item.kind](given, placed)
    except InputError as error:
        if error.file is not None:
            raise
        raise given.error(error.message) from error


def with_pattern(
    material: Material, pattern: Pattern, *, item: Primitive, file: str
) -> Material:
    """Return a material whose light is multiplied by a pattern.

    Materials that reflect take patterns that are the same everywhere.

    Parameters
    ----------
    item, file : where the material stands

    Raises
    ------
    InputError : with file and line, where the pattern varies and the material does
        not shine by itself
    """
    match material:
        case Light() | Glow() | Spotlight() | Illum():
            inner = material.pattern
            both = pattern if inner is None else Product((pattern, inner))
            return replace(material, pattern=both)
        case Plastic() | Metal() | Trans():
            factor = constant_value(pattern)
            if factor is not None:
                return replace(material, reflectance=material.reflectance * factor)
    raise Arguments(item, file).error(
        f'it is modified by the pattern "{item.modifier}", which varies; only light,'
        " glow, illum and spotlight take such a pattern, void expected"
    )


def modified(pattern: Pattern, outer: Pattern | None) -> Pattern:
    """Return a pattern that is itself modified by another, or by none."""
    return pattern if outer is None else Product((outer, pattern))


def _function(given: Arguments, placed: Transform) -> Pattern:
    # brightfunc: expression, file, transform; colorfunc: three expressions
    count = 1 if given.item.kind == "brightfunc" else 3
    _strings(given, count + 1)
    program = _program(given, count)
    expressions = tuple(_expression(given, text) for text in given.item.strings[:count])
    pattern = FunctionPattern(
        program,
        expressions,
        given.item.reals,
        _transform(given, count + 1, placed),
        given.source,
    )
    _check(given, program, expressions)
    return pattern


def _data(given: Arguments, placed: Transform) -> Pattern:
    # brightdata: function, table, file, coordinates, transform; colordata: three each
    count = 1 if given.item.kind == "brightdata" else 3
    _strings(given, 2 * count + 2)
    strings, at = given.item.strings, 2 * count + 1
    tables = tuple(_table(given, name) for name in strings[count : 2 * count])
    axes = len(tables[0].axes)
    if any(len(table.axes) != axes for table in tables):
        raise given.error("its tables have different numbers of axes; one expected")
    if len(strings) < at + axes:
        raise given.error(f"{len(strings) - at} coordinates for a table of {axes} axes")
    program = _program(given, 2 * count)
    places = tuple(_expression(given, text) for text in strings[at : at + axes])
    functions = strings[:count]
    pattern = DataPattern(
        program,
        functions,
        tables,
        places,
        given.item.reals,
        _transform(given, at + axes, placed),
        given.source,
    )
    _check(given, program, (*places, *(Name(name) for name in functions)))
    return pattern


PATTERNS: Mapping[str, Callable[[Arguments, Transform], Pattern]] = {
    "brightfunc": _function,
    "colorfunc": _function,
    "brightdata": _data,
    "colordata": _data,
}


def _table(given: Arguments, name: str) -> DataArray:
    # A luminaire's file stands for its intensities, too
    path = library_file(name, beside=given.file, line=given.item.line)
    if path.suffix.lower() in LUMINAIRE_SUFFIXES:
        return intensity_table(read_luminaire(path))
    return read_data_array(path)


def _strings(given: Arguments, least: int) -> None:
    if len(given.item.strings) < least:
        raise given.error(
            f"{len(given.item.strings)} string arguments; {least} or more expected"
        )


def _transform(given: Arguments, at: int, placed: Transform) -> Transform:
    # Radiance looks for the transform from the first word with a dash on
    strings = given.item.strings
    while at < len(strings) and not strings[at].startswith("-"):
        at += 1
    return given.transform(at).then(placed)


def _expression(given: Arguments, text: str) -> Node:
    try:
        return parse_expression(text)
    except InputError as error:
        raise given.error(f'in "{text}": {error.message}') from error


def _program(given: Arguments, at: int) -> Program:
    # The functions of the file named by string `at`; a dot names none
    name = given.item.strings[at]
    if name == ".":
        return Program()
    native = Path(name).name
    beside = (Path(given.file).parent / name, Path(name))
    if native in NATIVE_FILES and not any(path.is_file() for path in beside):
        return Program(native_file=native)
    path = library_file(name, beside=given.file, line=given.item.line)
    definitions: dict[str, Definition] = parse_definitions(
        read_text(path), file=str(path)
    )
    return Program(definitions)


def _check(given: Arguments, program: Program, nodes: tuple[Node, ...]) -> None:
    # Every name must mean something before a ray is traced
    unknown = sorted(program.uses(*nodes) - KNOWN)
    if unknown:
        raise given.error(
            f'"{unknown[0]}" is not defined, or not known where light leaves a source;'
            " a name of its function file, an argument or D, N, P expected"
        )
    # Try one ray of each kind, so that too few arguments are found here
    shape = (1, 3)
    up = np.broadcast_to(np.array([0.0, 0.6, 0.8]), shape)
    computed = {
        "S": np.ones(1),
        **{name: np.full(1, 0.5) for name in KNOWN},
        **{f"D{a}": up[:, i] for i, a in enumerate("xyz")},
    }
    values = tuple(node for node in nodes if program.is_value(node))
    if values:
        program.values(values, computed, given.item.reals)
