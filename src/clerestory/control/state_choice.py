"""Choice of shading states by limits of glare or illuminance."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.checks import has_shape, require


@final
@dataclass(frozen=True, eq=False)
class Limit:
    """Values of a quantity, such as DGP, in every shade state, and the limit.

    Permitted values are equal to `bound` or on the given side of `bound`.
    """

    values: Float[np.ndarray, "state time"]
    bound: float
    side: Literal["below", "above"] = "below"

    def __post_init__(self) -> None:
        shape = self.values.shape
        require(len(shape) == 2, f"values of shape {shape}; (state, time) expected")


def least_closed(
    limits: Sequence[Limit], *, at_least: Int[np.ndarray, " time"] | None = None
) -> Int[np.ndarray, " time"]:
    """Most open state within all limits, or the state of smallest relative excess.

    With a limit of DGP, shades are closed no more than glare protection requires.
    States that are more open than `at_least` are not taken.

    >>> dgp = np.array([[0.5, 0.3, 0.6], [0.38, 0.2, 0.5], [0.2, 0.2, 0.45]])
    >>> least_closed([Limit(dgp, 0.40)]).tolist()
    [1, 0, 2]
    """
    excess = _worst(limits)
    if at_least is not None:
        number = np.arange(len(excess))[:, None]
        excess = np.where(number < at_least, np.inf, excess)
    good = excess <= 0
    first, least = good.argmax(axis=0), excess.argmin(axis=0)
    return np.asarray(np.where(good.any(axis=0), first, least))


def best_states(
    score: Float[np.ndarray, "state time"], limits: Sequence[Limit] = ()
) -> Int[np.ndarray, " time"]:
    """Shade state with the highest score within all limits.

    Among states of equal score, the most open state is returned. If no state is within
    all limits, the state of smallest relative excess is returned.

    >>> lux = np.array([[900.0, 800.0], [500.0, 300.0]])
    >>> dgp = np.array([[0.5, 0.3], [0.3, 0.2]])
    >>> best_states(lux, [Limit(dgp, 0.4)]).tolist()
    [1, 0]
    """
    if not limits:
        return np.asarray(score.argmax(axis=0))
    excess = _worst(limits)
    has_shape(score, excess.shape, "score")
    good = excess <= 0
    best = np.where(good, score, -np.inf).argmax(axis=0)
    return np.asarray(np.where(good.any(axis=0), best, excess.argmin(axis=0)))


def within_limits(
    limits: Sequence[Limit], shape: tuple[int, ...]
) -> Bool[np.ndarray, "state time"]:
    """Whether each state is within all limits; true without limits.

    >>> within_limits([Limit(np.array([[0.5], [0.3]]), 0.4)], (2, 1)).tolist()
    [[False], [True]]
    """
    return _worst(limits) <= 0 if limits else np.ones(shape, dtype=bool)


def when_occupied(
    state: Int[np.ndarray, " time"],
    occupied: Bool[np.ndarray, " time"],
    *,
    otherwise: int,
) -> Int[np.ndarray, " time"]:
    """Keep the states of occupied time steps; use `otherwise` in all other time steps.

    >>> when_occupied(np.array([1, 1]), np.array([True, False]), otherwise=0).tolist()
    [1, 0]
    """
    return np.where(occupied, state, otherwise)


def _worst(limits: Sequence[Limit]) -> Float[np.ndarray, "state time"]:
    # Largest excess over any limit, relative to the limit
    require(limits, "no limits; at least one expected")
    worst = np.zeros(limits[0].values.shape)
    for limit in limits:
        has_shape(limit.values, worst.shape, "limit")
        over = (limit.values - limit.bound) * (1 if limit.side == "below" else -1)
        worst = np.maximum(worst, over / max(abs(limit.bound), 1e-12))
    return worst
