"""Quadratic expansion of hourly illuminance in unknown quantities.

The illuminance is a sum of parts, such as the light through one window group. Each part
is a product of factors to which it is proportional (glass, dirt, luminance of the sky)
and a polynomial of second order in other quantities (reflectances):

    E(θ) = Σ_p F_p(θ) (E_p + Σ_m g_pm δ_m + ½ Σ_mk h_pmk δ_m δ_k),    δ = θ − θ₀
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import has_shape, require

Pair = tuple[str, str]


@dataclass(frozen=True, eq=False)
class Part:
    """Part of the illuminance: factors times a polynomial of second order.

    Attributes
    ----------
    value : illuminance at the reference [lux]
    factors : names of the quantities to which the part is proportional
    first : first derivatives by name [lux per unit]
    second : second derivatives by pair of names, each pair once [lux per unit²]
    """

    value: Float[np.ndarray, "sensor time"]
    factors: tuple[str, ...] = ()
    first: Mapping[str, Float[np.ndarray, "sensor time"]] | None = None
    second: Mapping[Pair, Float[np.ndarray, "sensor time"]] | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        shape = self.value.shape
        for found in ((self.first or {}), (self.second or {})):
            for name, values in found.items():
                has_shape(values, shape, f"array of derivatives by {name}")
        for pair in self.second or {}:
            known = set(pair) <= set(self.first or {})
            require(known, f"no first derivatives for {pair}; those of both expected")

    def terms(self) -> list[Float[np.ndarray, "sensor time"]]:
        """Return the value and all derivatives, in the order of `weights`."""
        first, second = self.first or {}, self.second or {}
        return [self.value, *first.values(), *second.values()]

    def weights(
        self, draws: Mapping[str, np.ndarray], reference: Mapping[str, float]
    ) -> Float[np.ndarray, "draw term"]:
        """Return the weight of each term for each draw."""
        count = len(next(iter(draws.values())))
        scale = np.ones(count)
        for name in self.factors:
            scale = scale * draws[name] / reference[name]
        step = {name: draws[name] - reference[name] for name in self.first or {}}
        columns = [np.ones(count), *step.values()]
        for one, other in self.second or {}:
            half = 0.5 if one == other else 1.0
            columns.append(half * step[one] * step[other])
        return scale[:, None] * np.stack(columns, axis=1)

    def select(self, rows: slice, times: slice | np.ndarray) -> "Part":
        """Return the part of some sensors and time steps."""
        return Part(
            self.value[rows][:, times],
            self.factors,
            {k: v[rows][:, times] for k, v in (self.first or {}).items()},
            {k: v[rows][:, times] for k, v in (self.second or {}).items()},
        )


@dataclass(frozen=True, eq=False)
class Expansion:
    """Hourly illuminance as a function of unknown quantities.

    `reference` has the values of the model, by name. With several `scenarios`, such as
    years of weather, the quantity `chosen` is the number of the scenario.

    Examples
    --------
    The light of a window is proportional to its transmittance:

    >>> lux = np.array([[100.0, 200.0]])
    >>> window = Expansion({"glass": 0.8}, ((Part(lux, ("glass",)),),))
    >>> window.illuminance({"glass": np.array([0.4])}).tolist()
    [[[50.0, 100.0]]]
    """

    reference: Mapping[str, float]
    scenarios: tuple[tuple[Part, ...], ...]
    chosen: str = ""

    __repr__ = brief

    def __post_init__(self) -> None:
        require(self.scenarios, "no part of the illuminance; one or more expected")
        single = len(self.scenarios) == 1
        require(single or self.chosen, "no name of the scenarios; one expected")

    @property
    def sensors(self) -> int:
        """Number of sensors."""
        return len(self.scenarios[0][0].value)

    def select(self, rows: slice, times: slice | np.ndarray = np.s_[:]) -> "Expansion":
        """Return the expansion of some sensors and time steps."""
        parts = tuple(
            tuple(part.select(rows, times) for part in own) for own in self.scenarios
        )
        return Expansion(self.reference, parts, self.chosen)

    def illuminance(
        self, draws: Mapping[str, np.ndarray]
    ) -> Float[np.ndarray, "draw sensor time"]:
        """Return the illuminance of draws of the quantities [lux], as float32."""
        count = len(next(iter(draws.values())))
        if len(self.scenarios) == 1:
            return _of_parts(self.scenarios[0], draws, self.reference)
        shape = (count, *self.scenarios[0][0].value.shape)
        found = np.zeros(shape, np.float32)
        for number, parts in enumerate(self.scenarios):
            own = np.flatnonzero(draws[self.chosen].astype(int) == number)
            if own.size:
                some = {name: values[own] for name, values in draws.items()}
                found[own] = _of_parts(parts, some, self.reference)
        return found

    def order(self, order: int) -> "Expansion":
        """Return the expansion without derivatives above the given order."""

        def lowered(part: Part) -> Part:
            first = part.first if order > 0 else None
            return Part(
                part.value, part.factors, first, part.second if order > 1 else None
            )

        parts = tuple(tuple(map(lowered, own)) for own in self.scenarios)
        return Expansion(self.reference, parts, self.chosen)


def _of_parts(
    parts: Sequence[Part],
    draws: Mapping[str, np.ndarray],
    reference: Mapping[str, float],
) -> np.ndarray:
    # One matrix product for all parts
    weights = np.concatenate([part.weights(draws, reference) for part in parts], axis=1)
    terms = np.stack([term for part in parts for term in part.terms()])
    flat = terms.reshape(len(terms), -1).astype(np.float32, copy=False)
    found = weights.astype(np.float32) @ flat
    return np.asarray(found.reshape(len(weights), *terms.shape[1:]))


def by_differences(
    evaluate: Callable[[Mapping[str, float]], Float[np.ndarray, "*shape"]],
    reference: Mapping[str, float],
    steps: Mapping[str, float],
    *,
    mixed: bool = True,
) -> tuple[np.ndarray, dict[str, np.ndarray], dict[Pair, np.ndarray]]:
    """Return a function at the reference, and its derivatives by central differences.

    `evaluate` is called with the same random numbers for all values. With `mixed`, the
    second derivatives include those in two quantities.

    >>> square = lambda at: np.array([at["a"] ** 2 * at["b"]])
    >>> value, first, second = by_differences(
    ...     square, {"a": 2.0, "b": 3.0}, {"a": 0.1, "b": 0.1}
    ... )
    >>> first["a"].round(6).tolist(), second["a", "b"].round(6).tolist()
    ([12.0], [4.0])
    """
    at = dict(reference)
    value = evaluate(at)
    up = {n: evaluate(at | {n: at[n] + step}) for n, step in steps.items()}
    down = {n: evaluate(at | {n: at[n] - step}) for n, step in steps.items()}
    first = {n: (up[n] - down[n]) / (2 * step) for n, step in steps.items()}
    second: dict[Pair, np.ndarray] = {
        (n, n): (up[n] - 2 * value + down[n]) / step**2 for n, step in steps.items()
    }
    names = list(steps) if mixed else []
    for number, one in enumerate(names):
        for other in names[number + 1 :]:
            corners = [
                evaluate(at | {n: at[n] + sign * steps[n] for n in (one, other)})
                for sign in (1, -1)
            ]
            axes = up[one] + down[one] + up[other] + down[other]
            both = sum(corners) + 2 * value - axes
            second[one, other] = both / (2 * steps[one] * steps[other])
    return value, first, second
