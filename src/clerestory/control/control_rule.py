"""Rules of one's own: a function from what is known to a state per step."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import final

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.errors import InputError


@final
@dataclass(frozen=True, eq=False)
class Situation:
    """What a rule may look at, one value per step or per state and step.

    Attributes
    ----------
    times : middles of the steps, local standard time
    states : number of states of the window group
    occupied : whether somebody is there
    signals : over time: "irradiance" [W/m²], "profile" [rad], whatever was measured
    by_state : over (state, time): "illuminance" [lux], "dgp", whatever was computed

    Raises
    ------
    InputError : arrays that do not fit the steps and states
    """

    times: np.ndarray
    states: int
    occupied: Bool[np.ndarray, " time"]
    signals: Mapping[str, Float[np.ndarray, " time"]] = field(default_factory=dict)
    by_state: Mapping[str, Float[np.ndarray, "state time"]] = field(
        default_factory=dict
    )

    def __post_init__(self) -> None:
        steps = len(self.times)
        shapes: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
            "occupied": (self.occupied.shape, (steps,))
        }
        shapes |= {n: (a.shape, (steps,)) for n, a in self.signals.items()}
        shapes |= {n: (a.shape, (self.states, steps)) for n, a in self.by_state.items()}
        for name, (found, expected) in shapes.items():
            if found != expected:
                raise InputError(f"{name} has shape {found}; {expected} expected")


Rule = Callable[[Situation], Int[np.ndarray, " time"]]


def apply_rule(rule: Rule, situation: Situation) -> Int[np.ndarray, " time"]:
    """Return the states that a rule gives, checked.

    Raises
    ------
    InputError : the rule gives another number of steps, or states that do not exist

    Examples
    --------
    >>> hours = np.array(["2001-06-21T09:30", "2001-06-21T12:30"], "datetime64[s]")
    >>> here = Situation(hours, 2, np.array([True, True]),
    ...                  {"irradiance": np.array([90.0, 400.0])})
    >>> apply_rule(lambda s: (s.signals["irradiance"] > 200).astype(int), here).tolist()
    [0, 1]
    """
    states = np.asarray(rule(situation))
    name = getattr(rule, "__name__", "rule")
    if states.shape != (len(situation.times),):
        raise InputError(
            f"{name} gives states of shape {states.shape}; ({len(situation.times)},)"
            " expected"
        )
    if not np.issubdtype(states.dtype, np.integer):
        raise InputError(f"{name} gives {states.dtype} values; whole numbers expected")
    if len(states) and not 0 <= states.min() <= states.max() < situation.states:
        raise InputError(
            f"{name} gives states from {states.min()} to {states.max()}; 0 to"
            f" {situation.states - 1} expected"
        )
    return states
