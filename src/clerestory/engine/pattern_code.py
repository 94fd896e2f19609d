"""Evaluation of surface patterns (functions and tables) at intersections.

As in Radiance, the inputs are the point, the unperturbed normal and the ray direction,
in the local coordinates of the function.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.function_code import FunctionCode
from clerestory.engine.function_library import Value
from clerestory.engine.origin import Origin
from clerestory.engine.upload import on_device, search
from clerestory.errors import InputError
from clerestory.radiance.data_array import DataArray
from clerestory.radiance.function_pattern import NUMBERED, READINGS, FunctionPattern
from clerestory.scene.material import Source
from clerestory.scene.pattern import Pattern, Product
from clerestory.scene.transform import Transform

# Function of an interaction that returns one or three values of a pattern, and a mask
# of undefined (faulty) values
Code = Callable[[Any], tuple[list[Any], Any]]


def pattern_code(pattern: Pattern, origin: Origin) -> Code:
    """Convert a pattern to a function of a surface interaction."""
    match pattern:
        case FunctionPattern():
            code = _function(pattern, origin)
        case Product(factors):
            return _product([pattern_code(factor, origin) for factor in factors])
        case _:
            raise InputError(
                f"a surface pattern cannot be of type {type(pattern).__name__}"
            )
    _try(code, pattern.source)
    return code


def multiplier(pattern: Pattern, origin: Origin) -> Callable[[Any], Any]:
    """Convert a pattern to a multiplier of colours, 1 where it is undefined."""
    code = pattern_code(pattern, origin)
    return lambda si: mi.Color3f(*_single(_factors(*code(si))))


def coefficient(pattern: Pattern, origin: Origin) -> Callable[[Any], Any]:
    """Convert a pattern to a coefficient per channel, 0 where it is undefined."""
    code = pattern_code(pattern, origin)

    def amount(si: Any) -> Any:
        values, bad = code(si)
        kept = [dr.select(bad, 0.0, dr.maximum(value, 0)) for value in values]
        return mi.Color3f(*_single(kept))

    return amount


def share(pattern: Pattern, origin: Origin) -> Callable[[Any], Any]:
    """Convert a pattern to the foreground fraction of a mixture, 0 where undefined."""
    code = pattern_code(pattern, origin)

    def amount(si: Any) -> mi.Float:
        values, bad = code(si)
        [fraction] = _single([dr.select(bad, 0.0, dr.clip(values[0], 0, 1))])
        return fraction

    return amount


def perturbation(pattern: Pattern, origin: Origin) -> Callable[[Any], Any]:
    """Convert a pattern to a vector in scene coordinates that perturbs normals."""
    if not isinstance(pattern, FunctionPattern):
        what = f"a texture cannot be of type {type(pattern).__name__}"
        raise InputError(f"{what}; texfunc or texdata expected")
    code = pattern_code(pattern, origin)
    turn = pattern.transform.matrix[:3, :3] / pattern.transform.scale

    def added(si: Any) -> mi.Vector3f:
        values, bad = code(si)
        scene = _turned(values, turn)
        return mi.Vector3f(*_single([dr.select(bad, 0.0, c) for c in scene]))

    return added


def _single(values: list[Any]) -> list[Any]:
    return [mi.Float(mi.Float64(value)) for value in values]


def _factors(values: list[Any], bad: Any) -> list[Any]:
    # Multipliers of three channels; 1 if undefined
    factors = [dr.maximum(dr.select(bad, 1.0, value), 0) for value in values]
    return factors * 3 if len(factors) == 1 else factors


def _function(pattern: FunctionPattern, origin: Origin) -> Code:
    tables = [_table(table) for table in pattern.tables]

    def code(si: Any) -> tuple[list[Any], Any]:
        inputs = _inputs(pattern.transform, si, origin)
        made = FunctionCode(pattern.program, inputs, pattern.arguments)
        if not tables:
            return _split([made.value(node) for node in pattern.expressions])
        position, bad = _split([made.value(node) for node in pattern.coordinates])
        read = {n: t(position) for n, t in zip(READINGS, tables, strict=False)}
        made = FunctionCode(pattern.program, inputs | read, pattern.arguments)
        found, faulty = _split([made.value(node) for node in pattern.calls()])
        return found, faulty | bad

    return code


def _product(codes: list[Code]) -> Code:
    def code(si: Any) -> tuple[list[Any], Any]:
        # Multiply the patterns; undefined values count as 1
        total: list[Any] = [mi.Float64(1)] * 3
        for one in codes:
            total = [t * f for t, f in zip(total, _factors(*one(si)), strict=True)]
        return total, mi.Bool(False)

    return code


def _split(values: list[Value]) -> tuple[list[Any], Any]:
    bad = mi.Bool(False)
    for each in values:
        if each.bad is not False:
            bad = bad | each.bad
    return [mi.Float64(each.value) for each in values], bad


def _inputs(transform: Transform, si: Any, origin: Origin) -> dict[str, Any]:
    # Radiance's ray variables in the function's local coordinates
    back = np.linalg.inv(transform.matrix)
    scale = 1 / transform.scale
    sight = -si.sh_frame.to_world(si.wi)
    vectors = {
        "D": _turned(sight, back / scale),
        "N": _turned(si.n, back / scale),
        "P": _turned(si.p, back, shift=origin @ back[:3, :3] + back[3, :3]),
        "T": [float(c) for c in back[3, :3]],
        **{k: [float(c) for c in back[i, :3] / scale] for i, k in enumerate("IJK")},
    }
    given = {k + a: v[i] for k, v in vectors.items() for i, a in enumerate("xyz")}
    given |= {f"N{a}P": given[f"N{a}"] for a in "xyz"}
    rdot = mi.Float64(dr.clip(dr.dot(-sight, si.n), -1, 1))
    given |= {"Rdot": rdot, "RdotP": rdot, "S": scale}
    return given | {number: given[name] for number, name in NUMBERED.items()}


def _turned(vector: Any, matrix: np.ndarray, shift: Any = (0, 0, 0)) -> list[Any]:
    # Product of a vector and the columns of a matrix, plus a shift, in double precision
    given = [mi.Float64(component) for component in vector]
    return [
        sum(float(matrix[i, axis]) * given[i] for i in range(3)) + float(shift[axis])
        for axis in range(3)
    ]


def _try(code: Code, source: Source | None) -> None:
    # Raise errors of an expression before a kernel is compiled
    try:
        code(dr.zeros(mi.SurfaceInteraction3f, 1))
    except InputError as error:
        if error.file is not None or source is None:
            raise
        raise InputError(error.message, file=source.file, line=source.line) from error


def _table(data: DataArray) -> Callable[[list[Any]], Any]:
    """Return a function that interpolates in a table."""
    # Reverse decreasing axes with their positions, as in `scene.data_array`
    signs = [1.0 if axis[0] < axis[-1] else -1.0 for axis in data.axes]
    scaled = [s * axis for s, axis in zip(signs, data.axes, strict=True)]
    axes = [on_device(mi.Float64, axis) for axis in scaled]
    flat = on_device(mi.Float64, data.values)
    counts = data.values.shape
    strides = [int(np.prod(counts[i + 1 :])) for i in range(len(counts))]

    def look_up(position: list[Any]) -> Any:
        cells, shares = [], []
        for given, sign, axis, count in zip(position, signs, axes, counts, strict=True):
            x = sign * given
            cell = mi.Int32(search(axis, count, x)) - 1
            cell = mi.UInt32(dr.clip(cell, 0, count - 2))
            low = dr.gather(mi.Float64, axis, cell)
            cells.append(cell)
            shares.append((x - low) / (dr.gather(mi.Float64, axis, cell + 1) - low))
        return _interpolated(flat, cells, shares, strides, mi.UInt32(0))

    return look_up


def _interpolated(flat, cells, shares, strides, index) -> Any:
    # Multilinear interpolation, as in `scene.data_array`
    if not cells:
        return dr.gather(mi.Float64, flat, index)
    rest = cells[1:], shares[1:], strides[1:]
    at = [index + (cells[0] + i) * strides[0] for i in (0, 1)]
    low, high = (_interpolated(flat, *rest, number) for number in at)
    t = shares[0]
    straight = low * (1 - t) + high * t
    above = (2 * high - low) / dr.select(t > 2, t + 1, 1)
    below = (2 * low - high) / dr.select(t < -1, -t, 1)
    return dr.select(t > 2, above, dr.select(t < -1, below, straight))
