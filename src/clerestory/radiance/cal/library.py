"""Predefined functions and variables of function files, evaluated for arrays of rays.

The functions are those of Radiance's calcomp and rayinit.cal, without fractal noise.
As in Radiance, a division by zero or a root of a negative number affects one ray only:
the value is 0, and the ray is marked as invalid.

Reference: G. Ward, Radiance, icalc and rayinit.cal (names and meanings).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from jaxtyping import Bool, Float
from scipy import special

from clerestory.errors import InputError
from clerestory.radiance.cal.noise import noise_of_arrays, slope_of

Values = Float[np.ndarray, " rays"]


class Surroundings(Protocol):
    """The evaluation context of a native function."""

    @property
    def arguments(self) -> tuple[float, ...]:
        """The real arguments of the primitive."""

    def value(self, name: str) -> Values:
        """Return the value of a variable for the current rays."""

    def fault(self, where: Bool[np.ndarray, " rays"]) -> None:
        """Mark rays as invalid."""


@dataclass(frozen=True)
class Native:
    """A function or variable written in Python.

    Attributes
    ----------
    compute : function of the evaluation context and the arguments
    arity : minimum number of arguments; None for a variable
    uses : names of the variables read by `compute`
    """

    compute: Callable[..., Any]
    arity: int | None = None
    uses: tuple[str, ...] = ()


def divide(env: Surroundings, dividend: Values, divisor: Values) -> Values:
    """Return the quotient; if the divisor is 0, return 0 and mark the ray invalid."""
    zero = divisor == 0
    env.fault(zero)
    return np.where(zero, 0.0, dividend / np.where(zero, 1.0, divisor))


def power(env: Surroundings, base: Values, exponent: Values) -> Values:
    """Return the power; if it is not finite, return 0 and mark the ray invalid."""
    return _finite(env, np.power(base, exponent))


def _finite(env: Surroundings, value: Values) -> Values:
    bad = ~np.isfinite(value)
    env.fault(bad)
    return np.where(bad, 0.0, value)


def _of_numpy(function: Callable[..., Any], arity: int = 1) -> Native:
    return Native(lambda env, *v: _finite(env, function(*v[:arity])), arity)


def _of_all(function: np.ufunc) -> Native:
    return Native(lambda _, *v: function.reduce(v), 1)


def _argument(env: Surroundings, number: Values) -> Values:
    # arg(n) is the n-th real argument; arg(0) is the number of real arguments
    place = np.floor(number + 0.5).astype(int)
    given = (float(len(env.arguments)), *env.arguments)
    if place.size and place.max() >= len(given):
        raise InputError(
            f"real argument {place.max()} is asked for; {len(env.arguments)} given"
        )
    value: Values = np.array(given)[np.maximum(place, 0)]
    return value


def _numbered(number: int) -> Native:
    # Variables A1…A10: real arguments
    def compute(env: Surroundings) -> Values:
        if number > len(env.arguments):
            raise InputError(
                f"real argument {number} is asked for; {len(env.arguments)} given"
            )
        return np.full(env.value("S").shape, float(env.arguments[number - 1]))

    return Native(compute, uses=("S",))


def _count(env: Surroundings) -> Values:
    return np.full(env.value("S").shape, float(len(env.arguments)))


def _random(_: Surroundings, x: Values) -> Values:
    # Radiance's rand(x): a deterministic hash of x, uniform in 0…1
    mixed = x * (1 / (1 + x * x) + 2.71828182845904)
    share = 1e5 / (mixed + 0.785398163397447 - np.floor(mixed))
    fraction: Values = share - np.floor(share)
    return fraction


def _bound(_: Surroundings, low: Values, x: Values, high: Values) -> Values:
    return np.where(low > x, low, np.where(x > high, high, x))


def _grey(_: Surroundings, red: Values, green: Values, blue: Values) -> Values:
    # Luminance weights of rayinit.cal
    total = 0.265074126 * red + 0.670114631 * green + 0.064811243 * blue
    return np.maximum(total, 0)


def _component(letter: str) -> Native:
    # D(i), N(i) and P(i): component i of the vector, i = 1…3
    def compute(env: Surroundings, which: Values) -> Values:
        place = np.floor(which + 0.5).astype(int)
        env.fault((place < 1) | (place > 3))
        axes = np.stack([env.value(letter + a) for a in "xyz"])
        rows = np.arange(axes.shape[1])
        value: Values = axes[np.clip(place - 1, 0, 2), rows]
        return value

    return Native(compute, 1, tuple(letter + a for a in "xyz"))


def _local(letter: str) -> Native:
    # Local coordinates U and V of a planar surface: U is horizontal, and N = U × V
    def compute(env: Surroundings) -> Values:
        n = [env.value("N" + a) for a in "xyz"]
        p = [env.value("P" + a) for a in "xyz"]
        flat = n[0] ** 2 + n[1] ** 2
        tilted = flat > 1e-7
        safe = np.where(tilted, flat, 1.0)
        if letter == "U":
            return np.where(tilted, (p[1] * n[0] - p[0] * n[1]) / safe, p[0])
        slope = n[2] * (p[0] * n[0] + p[1] * n[1]) / safe
        return np.where(tilted, p[2] - slope, p[1])

    return Native(compute, uses=tuple(k + a for k in "NP" for a in "xyz"))


def _constant(value: float) -> Native:
    return Native(lambda env: np.full(env.value("S").shape, value), uses=("S",))


def _plain(function: Callable[..., Any], arity: int) -> Native:
    # Function defined for all arguments
    return Native(lambda _, *v: function(*v[:arity]), arity)


def _quotient(remainder: Callable[..., Any], arity: int) -> Native:
    # Function that divides by its last argument
    def compute(env: Surroundings, *v: Values) -> Values:
        divisor = v[arity - 1]
        env.fault(divisor == 0)
        safe = np.where(divisor == 0, 1.0, divisor)
        found: Values = np.where(divisor == 0, 0.0, remainder(*v[: arity - 1], safe))
        return found

    return Native(compute, arity)


def _zigzag(n: Values, d: Values) -> Values:
    # Triangle wave: 0 at even multiples of d, |d| at odd multiples
    height: Values = np.abs(d - np.mod(n - d, 2 * d))
    return height


def _hermite(p0: Values, p1: Values, r0: Values, r1: Values, t: Values) -> Values:
    # Hermite curve through p0 and p1 with slopes r0 and r1
    value: Values = (
        p0 * (1 + 2 * t) * (1 - t) ** 2
        + p1 * t**2 * (3 - 2 * t)
        + r0 * t * (1 - t) ** 2
        - r1 * t**2 * (1 - t)
    )
    return value


def _bezier(p1: Values, p2: Values, p3: Values, p4: Values, t: Values) -> Values:
    u = 1 - t
    value: Values = p1 * u**3 + 3 * t * u * (p2 * u + p3 * t) + p4 * t**3
    return value


def _bspline(pp: Values, p0: Values, p1: Values, pn: Values, t: Values) -> Values:
    # Uniform cubic B-spline
    ends = pp * (1 - t) ** 3 + pn * t**3
    middle = p0 * (4 + t**2 * (3 * t - 6)) + p1 * (1 + 3 * t * (1 + t * (1 - t)))
    value: Values = (ends + middle) / 6
    return value


_CALCULATOR = {
    "sqrt": _of_numpy(np.sqrt),
    "sin": _of_numpy(np.sin),
    "cos": _of_numpy(np.cos),
    "tan": _of_numpy(np.tan),
    "asin": _of_numpy(np.arcsin),
    "acos": _of_numpy(np.arccos),
    "atan": _of_numpy(np.arctan),
    "atan2": _of_numpy(np.arctan2, 2),
    "exp": _of_numpy(np.exp),
    "log": _of_numpy(np.log),
    "log10": _of_numpy(np.log10),
    "floor": _of_numpy(np.floor),
    "ceil": _of_numpy(np.ceil),
    "erf": _of_numpy(special.erf),
    "erfc": _of_numpy(special.erfc),
    "min": _of_all(np.minimum),
    "max": _of_all(np.maximum),
    "rand": Native(_random, 1),
    "arg": Native(_argument, 1),
}

_START_FILE = {
    "PI": _constant(np.pi),
    "DEGREE": _constant(np.pi / 180),
    "FTINY": _constant(1e-7),
    "AC": Native(_count, uses=("S",)),
    "D": _component("D"),
    "N": _component("N"),
    "P": _component("P"),
    "U": _local("U"),
    "V": _local("V"),
    "bound": Native(_bound, 3),
    "Acos": _plain(lambda x: np.arccos(np.clip(x, -1, 1)), 1),
    "Asin": _plain(lambda x: np.arcsin(np.clip(x, -1, 1)), 1),
    "Atan2": _plain(np.arctan2, 2),
    "Exp": Native(lambda env, x: _finite(env, np.where(x < -100, 0.0, np.exp(x))), 1),
    "Sqrt": _plain(lambda x: np.sqrt(np.maximum(x, 0)), 1),
    "and": _plain(lambda a, b: np.where(a > 0, b, a), 2),
    "or": _plain(lambda a, b: np.where(a > 0, a, b), 2),
    "not": _plain(lambda a: np.where(a > 0, -1.0, 1.0), 1),
    "xor": _plain(lambda a, b: np.where(a > 0, np.where(b > 0, -1.0, 1.0), b), 2),
    "abs": _plain(np.abs, 1),
    "sgn": _plain(np.sign, 1),
    "sq": _plain(np.square, 1),
    "inside": _plain(lambda a, x, b: np.where(x > a, b - x, x - a), 3),
    "frac": _plain(lambda x: x - np.floor(x), 1),
    "mod": _quotient(np.mod, 2),
    "tri": _quotient(_zigzag, 2),
    "linterp": _plain(lambda t, p0, p1: (1 - t) * p0 + t * p1, 3),
    "hermite": _plain(_hermite, 5),
    "bezier": _plain(_bezier, 5),
    "bspline": _plain(_bspline, 5),
    "noop": _plain(lambda v: v, 1),
    "clip": _plain(lambda v: np.clip(v, 0, 1), 1),
    "noneg": _plain(lambda v: np.maximum(v, 0), 1),
    "red": _plain(lambda r, g, b: np.maximum(r, 0), 3),
    "green": _plain(lambda r, g, b: np.maximum(g, 0), 3),
    "blue": _plain(lambda r, g, b: np.maximum(b, 0), 3),
    "grey": Native(_grey, 3),
    "clip_r": _plain(lambda r, g, b: np.clip(r, 0, 1), 3),
    "clip_g": _plain(lambda r, g, b: np.clip(g, 0, 1), 3),
    "clip_b": _plain(lambda r, g, b: np.clip(b, 0, 1), 3),
    "clipgrey": Native(lambda env, *v: np.minimum(_grey(env, *v[:3]), 1), 3),
} | {f"A{i}": _numbered(i) for i in range(1, 11)}

_NOISE = {"noise3": _plain(noise_of_arrays, 3)} | {
    f"noise3{name}": _plain(slope_of(noise_of_arrays, axis), 3)
    for names in ("xyz", "abc")
    for axis, name in enumerate(names)
}

LIBRARY: Mapping[str, Native] = _CALCULATOR | _START_FILE | _NOISE

# Functions with functions as arguments, defined in the function language
PRELUDE = """
dot(v1, v2) : v1(1)*v2(1) + v1(2)*v2(2) + v1(3)*v2(3);
cross(i, v1, v2) : select(i, v1(2)*v2(3) - v1(3)*v2(2),
                             v1(3)*v2(1) - v1(1)*v2(3),
                             v1(1)*v2(2) - v1(2)*v2(1));
"""
