"""User-defined control rules: functions that return the state at each time step.

A study may refer to a function in a Python file. The file is imported, so its code runs
with the permissions of the user.
"""

import runpy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.brief_repr import brief
from clerestory.checks import has_shape, require, within
from clerestory.errors import InputError


@final
@dataclass(frozen=True, eq=False)
class Situation:
    """Inputs of a control rule.

    Attributes
    ----------
    times : centres of the time steps, local standard time
    states : number of states of the window group
    occupied : whether the room is occupied at each time step
    signals : time series by name: "irradiance" [W/m²], "profile" angle [rad] and others
    by_state : results over (state, time) by name, such as "illuminance" [lux] and "dgp"
    """

    times: np.ndarray
    states: int
    occupied: Bool[np.ndarray, " time"]
    signals: Mapping[str, Float[np.ndarray, " time"]] = field(default_factory=dict)
    by_state: Mapping[str, Float[np.ndarray, "state time"]] = field(
        default_factory=dict
    )

    __repr__ = brief

    def __post_init__(self) -> None:
        over_time = {"occupied": self.occupied, **self.signals}
        shape: tuple[int, ...] = (len(self.times),)
        for values in (over_time, self.by_state):
            for name, array in values.items():
                has_shape(array, shape, name)
            shape = self.states, *shape


Rule = Callable[[Situation], Int[np.ndarray, " time"]]


def apply_rule(rule: Rule, situation: Situation) -> Int[np.ndarray, " time"]:
    """Return the shade states chosen by a rule, after checks of shape and range.

    >>> hours = np.array(["2001-06-21T09:30", "2001-06-21T12:30"], "datetime64[s]")
    >>> here = Situation(hours, 2, np.array([True, True]),
    ...                  {"irradiance": np.array([90.0, 400.0])})
    >>> apply_rule(lambda s: (s.signals["irradiance"] > 200).astype(int), here).tolist()
    [0, 1]
    """
    states = np.asarray(rule(situation))
    what = f"the result of {getattr(rule, '__name__', 'the rule')}"
    has_shape(states, situation.times.shape, what)
    whole = np.issubdtype(states.dtype, np.integer)
    require(whole, f"{what} has {states.dtype} values; whole numbers expected")
    within(states, f"a state in {what}", least=0, most=situation.states - 1)
    return states


def load_rule(path: str | Path, name: str) -> Rule:
    """Return the function of the given name in a Python file."""
    try:
        found: Rule | None = runpy.run_path(str(path)).get(name)
    except Exception as error:  # user code may raise any exception
        text = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        message = f"running it raised {text}; Python code without errors expected"
        raise InputError(message, file=path) from error
    if not callable(found):
        raise InputError(f'no function "{name}" in the file', file=path)
    return found
