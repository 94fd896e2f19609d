"""Functions of Radiance's calculator for Dr.Jit arrays, used by `function_code`.

Arguments and results have a mask of faulty values. Python numbers are not converted.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

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
    def compute(x: Value) -> Value:
        bad = wrong(x.value)
        if isinstance(bad, bool):
            value = 0.0 if bad else function(x.value)
            return Value(value, either_bad(x.bad, bad))
        value = dr.select(bad, 0, function(dr.select(bad, safe, x.value)))
        return Value(value, either_bad(x.bad, bad))

    return compute


def _plain(function: Callable[..., Any], arity: int = 1):
    def compute(*given: Value) -> Value:
        used = given[:arity]
        bad = False
        for each in used:
            bad = either_bad(bad, each.bad)
        return Value(function(*(each.value for each in used)), bad)

    return compute


def _folded(function: Callable[[Any, Any], Any]):
    # Function of any number of arguments
    def compute(*given: Value) -> Value:
        total = given[0]
        for each in given[1:]:
            total = Value(
                function(total.value, each.value), either_bad(total.bad, each.bad)
            )
        return total

    return compute


def _random(x: Any) -> Any:
    # Radiance's rand(x): a hash of a number
    mixed = x * (1 / (1 + x * x) + 2.71828182845904)
    share = 1e5 / (mixed + 0.785398163397447 - dr.floor(mixed))
    return share - dr.floor(share)


def _noise(x: Any, y: Any, z: Any) -> Any:
    tables = [mi.Float64(table) for table in TABLES]
    dr.make_opaque(tables)

    def take(table: int, place: Any) -> Any:
        index = mi.UInt32(mi.Int32(place) & 255)
        return dr.gather(mi.Float64, tables[table], index)

    point = [mi.Float64(c) for c in (x, y, z)]
    return noise(*point, floor=dr.floor, take=take)


FUNCTIONS: Mapping[str, tuple[int, Callable[..., Value]]] = {
    "sqrt": (1, _guarded(dr.sqrt, lambda x: x < 0, 0)),
    "log": (1, _guarded(dr.log, lambda x: x <= 0, 1)),
    "log10": (1, _guarded(lambda x: dr.log(x) / np.log(10), lambda x: x <= 0, 1)),
    "asin": (1, _guarded(dr.asin, lambda x: abs(x) > 1, 0)),
    "acos": (1, _guarded(dr.acos, lambda x: abs(x) > 1, 0)),
    "exp": (1, _guarded(dr.exp, lambda x: x > 700, 0)),
    "sin": (1, _plain(dr.sin)),
    "cos": (1, _plain(dr.cos)),
    "tan": (1, _plain(dr.tan)),
    "atan": (1, _plain(dr.atan)),
    "atan2": (2, _plain(dr.atan2, 2)),
    "floor": (1, _plain(dr.floor)),
    "ceil": (1, _plain(dr.ceil)),
    "erf": (1, _plain(dr.erf)),
    "erfc": (1, _plain(lambda x: 1 - dr.erf(x))),
    "min": (1, _folded(dr.minimum)),
    "max": (1, _folded(dr.maximum)),
    "rand": (1, _plain(_random)),
    "noise3": (3, _plain(_noise, 3)),
    **{
        f"noise3{name}": (3, _plain(slope_of(_noise, axis), 3))
        for names in ("xyz", "abc")
        for axis, name in enumerate(names)
    },
}
