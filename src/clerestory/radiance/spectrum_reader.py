"""Reader of Radiance's spectral modifiers: spectrum, specfile, specfunc and specdata.

Values at equally spaced wavelengths are constant around each wavelength and zero
farther out, as in Radiance (`scene.tint.stepped`). Spectra that vary over a surface
are not supported.

Reference: "The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.4.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from clerestory.checks import finite, not_negative, positive, require
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import Call, Name, Node, parse_expression
from clerestory.radiance.data_array import DataArray, read_data_array
from clerestory.radiance.search_path import library_file
from clerestory.scene.primitive import Arguments
from clerestory.scene.tint import stepped
from clerestory.spectra import Spectrum

SPECTRAL_KINDS = frozenset(("spectrum", "specfile", "specfunc", "specdata"))

# Names of the arguments of a function of wavelength
_VALUE, _WAVELENGTH = "$101", "$102"

# Least number of values of a spectrum, and distance of those of a function [nm]
_LEAST, _STEP_NM = 3, 1.0

# Reads the function file named by the string argument of an index
ReadProgram = Callable[[Arguments, int], Program]


def read_spectral(given: Arguments, read_program: ReadProgram) -> Spectrum:
    """Return the spectrum of a primitive of `SPECTRAL_KINDS`.

    Raises
    ------
    InputError : wrong arguments, or a spectrum that varies over the surface
    """
    with given.located():
        match given.item.kind:
            case "spectrum":
                first, last, values = _own_values(given)
            case "specfile":
                given.strings(1, "1")
                table = _table(given, 0)
                require(
                    len(table.axes) == 1,
                    f"the data file has {len(table.axes)} axes; 1, the wavelength,"
                    " expected",
                )
                first, last = _limits(table.axes[0])
                values = table.values
            case "specfunc":
                first, last, values = _function(given, read_program)
            case _:
                first, last, values = _data(given, read_program)
        require(
            len(values) >= _LEAST,
            f"{len(values)} values; {_LEAST} or more expected",
        )
        positive((first, last), "a wavelength", unit="nm")
        require(first != last, f"both wavelengths are {first:g} nm; two expected")
        finite(values, "a value of the spectrum")
        not_negative(values, "a value of the spectrum")
        return stepped(first, last, values)


def _own_values(given: Arguments) -> tuple[float, float, Float[np.ndarray, " value"]]:
    count = len(given.item.reals)
    require(
        count >= 2 + _LEAST,
        f"{count} numbers; two wavelengths [nm] and {_LEAST} or more values expected",
    )
    first, last, *values = given.reals(count)
    return float(first), float(last), np.array(values)


def _function(
    given: Arguments, read_program: ReadProgram
) -> tuple[float, float, Float[np.ndarray, " value"]]:
    # Function of the wavelength, evaluated every nanometre
    given.strings(2, "2 or more")
    count = len(given.item.reals)
    require(count >= 2, f"{count} numbers; two wavelengths [nm] expected")
    first, last = (float(x) for x in given.item.reals[:2])
    positive((first, last), "a wavelength", unit="nm")
    steps = min(10_000, max(_LEAST, round(abs(last - first) / _STEP_NM) + 1))
    nm = np.linspace(first, last, steps)
    call = Call(given.item.strings[0], (Name(_WAVELENGTH),))
    inputs = {_WAVELENGTH: nm}
    return first, last, _values(given, read_program(given, 1), call, inputs)


def _data(
    given: Arguments, read_program: ReadProgram
) -> tuple[float, float, Float[np.ndarray, " value"]]:
    # Function of the values in a data file at constant coordinates, and of wavelength
    words = given.strings(3, "3 or more")
    table, program = _table(given, 1), read_program(given, 2)
    others = len(table.axes) - 1
    places = words[3 : 3 + others]
    require(
        len(places) == others,
        f"{len(places)} coordinate(s) given, but the data file has {others} axes"
        " beside the wavelength; one coordinate per axis expected",
    )
    nm = table.axes[-1]
    first, last = _limits(nm)
    at = [
        _values(given, program, parse_expression(text), {_WAVELENGTH: nm[:1]})[0]
        for text in places
    ]
    position = np.column_stack([*(np.full(len(nm), x) for x in at), nm])
    inputs = {_VALUE: table.value(position), _WAVELENGTH: nm}
    several = program.arity(words[0]) >= 2
    names = (_VALUE, _WAVELENGTH) if several else (_VALUE,)
    call = Call(words[0], tuple(Name(name) for name in names))
    return first, last, _values(given, program, call, inputs)


def _values(
    given: Arguments, program: Program, node: Node, inputs: dict[str, np.ndarray]
) -> Float[np.ndarray, " value"]:
    unknown = sorted(program.uses(node) - {"S", *inputs})
    require(
        not unknown,
        f'"{"".join(unknown[:1])}" is not defined, or varies over the surface; constant'
        " values and functions of its function file expected",
    )
    count = len(inputs[_WAVELENGTH])
    whole = {"S": np.ones(count), **inputs}
    found = program.values((node,), whole, given.item.reals)
    require(
        bool(found.valid.all()),
        f"the function has no value at {np.count_nonzero(~found.valid)} of"
        f" {count} wavelengths; numbers expected",
    )
    return np.asarray(found.value[:, 0])


def _table(given: Arguments, at: int) -> DataArray:
    path = library_file(given.item.strings[at], beside=given.file, line=given.item.line)
    return read_data_array(path)


def _limits(nm: Float[np.ndarray, " value"]) -> tuple[float, float]:
    step = np.diff(nm)
    require(
        bool(np.allclose(step, step[0], rtol=1e-3)),
        "the wavelengths of the data file have different distances; equal ones"
        " expected",
    )
    return float(nm[0]), float(nm[-1])
