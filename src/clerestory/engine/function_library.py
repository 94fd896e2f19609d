"""Functions of Radiance's calculator for Dr.Jit arrays, used by `function_code`.

Arguments and results carry a mask of undefined (faulty) values. Python numbers are not
converted to arrays.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.upload import on_device
from clerestory.radiance.cal.library import Native
from clerestory.radiance.cal.noise import TABLES, noise, slope_of


@dataclass(frozen=True)
class Value:
    """A number or an array, with a mask of faulty values."""

    value: Any
    bad: Any = False


def either_bad(one: Any, other: Any) -> Any:
    """Return the union of two masks of faulty values."""
    if one is False:
        return other
    return one if other is False else one | other


def where(condition: Any, yes: Any, no: Any) -> Any:
    """Select one of two values by a condition, in double precision."""
    return dr.select(condition, mi.Float64(yes), mi.Float64(no))


def _guarded(function: Callable[..., Any], wrong: Callable[..., Any], safe: float):
    # Function of one number; the result is 0 and faulty where `wrong` is true
    def compute(_: object, x: Value, *_more: Value) -> Value:
        bad = wrong(x.value)
        if isinstance(bad, bool):
            value = 0.0 if bad else function(x.value)
            return Value(value, either_bad(x.bad, bad))
        value = dr.select(bad, 0, function(dr.select(bad, safe, x.value)))
        return Value(value, either_bad(x.bad, bad))

    return Native(compute, 1)


def _plain(function: Callable[..., Any], arity: int = 1):
    def compute(_: object, *given: Value) -> Value:
        bad = reduce(either_bad, (each.bad for each in given[:arity]))
        return Value(function(*(each.value for each in given[:arity])), bad)

    return Native(compute, arity)


def _folded(function: Callable[[Any, Any], Any]):
    # Function of any number of arguments
    def compute(_: object, *given: Value) -> Value:
        value = reduce(function, (each.value for each in given))
        return Value(value, reduce(either_bad, (each.bad for each in given)))

    return Native(compute, 1)


def _random(x: Any) -> Any:
    # Radiance's rand(x): a hash of a number
    mixed = x * (1 / (1 + x * x) + 2.71828182845904)
    share = 1e5 / (mixed + 0.785398163397447 - dr.floor(mixed))
    return share - dr.floor(share)


def _noise(x: Any, y: Any, z: Any) -> Any:
    tables = [on_device(mi.Float64, table) for table in TABLES]

    def take(table: int, place: Any) -> Any:
        index = mi.UInt32(mi.Int32(place) & 255)
        return dr.gather(mi.Float64, tables[table], index)

    point = [mi.Float64(c) for c in (x, y, z)]
    return noise(*point, floor=dr.floor, take=take)


FUNCTIONS: Mapping[str, Native] = {
    "sqrt": _guarded(dr.sqrt, lambda x: x < 0, 0),
    "log": _guarded(dr.log, lambda x: x <= 0, 1),
    "log10": _guarded(lambda x: dr.log(x) / np.log(10), lambda x: x <= 0, 1),
    "asin": _guarded(dr.asin, lambda x: abs(x) > 1, 0),
    "acos": _guarded(dr.acos, lambda x: abs(x) > 1, 0),
    "exp": _guarded(dr.exp, lambda x: x > 700, 0),
    "sin": _plain(dr.sin),
    "cos": _plain(dr.cos),
    "tan": _plain(dr.tan),
    "atan": _plain(dr.atan),
    "atan2": _plain(dr.atan2, 2),
    "floor": _plain(dr.floor),
    "ceil": _plain(dr.ceil),
    "erf": _plain(dr.erf),
    "erfc": _plain(lambda x: 1 - dr.erf(x)),
    "min": _folded(dr.minimum),
    "max": _folded(dr.maximum),
    "rand": _plain(_random),
    "arg": Native(lambda code, which, *_: code.argument(which), 1),
    "noise3": _plain(_noise, 3),
    **{
        f"noise3{name}": _plain(slope_of(_noise, axis), 3)
        for names in ("xyz", "abc")
        for axis, name in enumerate(names)
    },
}
