"""Predefined functions and variables of function files, evaluated for arrays of rays.

The functions are those of Radiance's calcomp and rayinit.cal, without fractal noise.
As in Radiance, a division by zero or a root of a negative number gives the value 0 and
marks the ray as invalid; the other rays are not affected.

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
from clerestory.radiance.cal.syntax import parse_definitions

Values = Float[np.ndarray, " rays"]


class Surroundings(Protocol):
    """Ray variables and real arguments for predefined functions."""

    @property
    def arguments(self) -> tuple[float, ...]:
        """The real arguments of the primitive."""

    def value(self, name: str) -> Values:
        """Return the value of a variable for the current rays."""

    def fault(self, where: Bool[np.ndarray, " rays"]) -> None:
        """Mark rays as invalid."""


@dataclass(frozen=True)
class Native:
    """A predefined function, or a variable (arity None), computed in Python.

    `arity` is the minimum number of arguments, `uses` the variables read by `compute`.
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
            f"real argument {place.max()} is used, but the primitive has"
            f" {len(env.arguments)} real arguments"
        )
    value: Values = np.array(given)[np.maximum(place, 0)]
    return value


def _numbered(number: int) -> Native:
    # Variable A1, A2, …: real argument of that number
    def compute(env: Surroundings) -> Values:
        return _argument(env, np.full(env.value("S").shape, float(number)))

    return Native(compute, uses=("S",))


def _count(env: Surroundings) -> Values:
    return np.full(env.value("S").shape, float(len(env.arguments)))


def _random(_: Surroundings, x: Values) -> Values:
    # Radiance's rand(x): a deterministic hash of x, uniform in 0…1
    mixed = x * (1 / (1 + x * x) + 2.71828182845904)
    share = 1e5 / (mixed + 0.785398163397447 - np.floor(mixed))
    fraction: Values = share - np.floor(share)
    return fraction


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

_ARGUMENTS = {"AC": Native(_count, uses=("S",))} | {
    f"A{i}": _numbered(i) for i in range(1, 11)
}

_NOISE = {"noise3": _of_numpy(noise_of_arrays, 3)} | {
    f"noise3{name}": _of_numpy(slope_of(noise_of_arrays, axis), 3)
    for names in ("xyz", "abc")
    for axis, name in enumerate(names)
}

LIBRARY: Mapping[str, Native] = _CALCULATOR | _ARGUMENTS | _NOISE

# Functions and variables of rayinit.cal, in the function language
START_FILE = parse_definitions(
    """
    PI : 3.14159265358979323846; DEGREE : PI/180; FTINY : 1e-7;
    D(i) : select(i, Dx, Dy, Dz); N(i) : select(i, Nx, Ny, Nz);
    P(i) : select(i, Px, Py, Pz);
    dot(v1, v2) : v1(1)*v2(1) + v1(2)*v2(2) + v1(3)*v2(3);
    cross(i, v1, v2) : select(i, v1(2)*v2(3) - v1(3)*v2(2),
        v1(3)*v2(1) - v1(1)*v2(3), v1(1)*v2(2) - v1(2)*v2(1));
    U : if(Nx*Nx + Ny*Ny - 1e-7, (Py*Nx - Px*Ny)/(Nx*Nx + Ny*Ny), Px);
    V : if(Nx*Nx + Ny*Ny - 1e-7,
        Pz - Nz*(Px*Nx + Py*Ny)/(Nx*Nx + Ny*Ny), Py);
    bound(a, x, b) : max(a, min(x, b));
    Acos(x) : acos(max(-1, min(x, 1))); Asin(x) : asin(max(-1, min(x, 1)));
    Atan2(y, x) : atan2(y, x); Exp(x) : if(-x - 100, 0, exp(x));
    Sqrt(x) : sqrt(max(x, 0));
    and(a, b) : if(a, b, a); or(a, b) : if(a, a, b); not(a) : if(a, -1, 1);
    xor(a, b) : if(a, if(b, -1, 1), b);
    abs(x) : max(x, -x); sgn(x) : if(x, 1, if(-x, -1, 0)); sq(x) : x*x;
    inside(a, x, b) : if(x - a, b - x, x - a);
    frac(x) : x - floor(x); mod(n, d) : n - floor(n/d)*d;
    tri(n, d) : abs(d - mod(n - d, 2*d));
    linterp(t, p, q) : (1 - t)*p + t*q;
    hermite(p, q, r, s, t) : p*(1 + 2*t)*(1 - t)^2 + q*t^2*(3 - 2*t)
        + r*t*(1 - t)^2 - s*t^2*(1 - t);
    bezier(a, b, c, d, t) : a*(1 - t)^3 + 3*t*(1 - t)*(b*(1 - t) + c*t) + d*t^3;
    bspline(p, a, b, n, t) : (p*(1 - t)^3 + n*t^3 + a*(4 + t*t*(3*t - 6))
        + b*(1 + 3*t*(1 + t*(1 - t))))/6;
    noop(v) : v; clip(v) : max(0, min(v, 1)); noneg(v) : max(v, 0);
    red(r, g, b) : max(r, 0); green(r, g, b) : max(g, 0); blue(r, g, b) : max(b, 0);
    grey(r, g, b) : max(.265074126*r + .670114631*g + .064811243*b, 0);
    clip_r(r, g, b) : max(0, min(r, 1)); clip_g(r, g, b) : max(0, min(g, 1));
    clip_b(r, g, b) : max(0, min(b, 1));
    clipgrey(r, g, b) : max(0, min(.265074126*r + .670114631*g + .064811243*b, 1));
    """
)
