"""User-defined control rules: functions that return the state at each time step.

A study may refer to a function in a Python file. The file is imported, so its code runs
with the permissions of the user.
"""

import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.checks import require, within
from clerestory.errors import InputError


@final
@dataclass(frozen=True, eq=False)
class Situation:
    """Inputs of a control rule.

    Attributes
    ----------
    times : centres of the steps, local standard time
    states : number of states of the window group
    occupied : whether the room is occupied at each step
    signals : time series by name, such as "irradiance" [W/m²] and "profile" [rad]
    by_state : results over (state, time) by name, such as "illuminance" [lux] and "dgp"
    """

    times: np.ndarray
    states: int
    occupied: Bool[np.ndarray, " time"]
    signals: Mapping[str, Float[np.ndarray, " time"]] = field(default_factory=dict)
    by_state: Mapping[str, Float[np.ndarray, "state time"]] = field(
        default_factory=dict
    )

    def __post_init__(self) -> None:
        over_time = {"occupied": self.occupied, **self.signals}
        shape: tuple[int, ...] = (len(self.times),)
        for values in (over_time, self.by_state):
            for name, array in values.items():
                _require_shape(array, shape, name)
            shape = self.states, *shape


Rule = Callable[[Situation], Int[np.ndarray, " time"]]


def apply_rule(rule: Rule, situation: Situation) -> Int[np.ndarray, " time"]:
    """Return the states chosen by a rule, after validation.

    >>> hours = np.array(["2001-06-21T09:30", "2001-06-21T12:30"], "datetime64[s]")
    >>> here = Situation(hours, 2, np.array([True, True]),
    ...                  {"irradiance": np.array([90.0, 400.0])})
    >>> apply_rule(lambda s: (s.signals["irradiance"] > 200).astype(int), here).tolist()
    [0, 1]
    """
    states = np.asarray(rule(situation))
    what = f"the result of {getattr(rule, '__name__', 'the rule')}"
    _require_shape(states, (len(situation.times),), what)
    require(
        np.issubdtype(states.dtype, np.integer),
        f"{what} has {states.dtype} values; whole numbers expected",
    )
    within(states, f"a state in {what}", least=0, most=situation.states - 1)
    return states


def _require_shape(array: np.ndarray, shape: tuple[int, ...], what: str) -> None:
    require(array.shape == shape, f"{what} has shape {array.shape}; {shape} expected")


def load_rule(path: str | Path, name: str) -> Rule:
    r"""Return the function of the given name in a Python file.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "rules.py")
    ...     _ = file.write_text("def closed(situation):\n    return 1")
    ...     rule = load_rule(file, "closed")
    >>> rule(None)
    1
    """
    path = Path(path)
    spec = importlib.util.spec_from_file_location(f"rules_of_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise InputError(
            "not a Python file; a name that ends in .py expected", file=path
        )
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # user code may raise any exception
        text = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        message = f"{text}; a file without errors expected"
        raise InputError(message, file=path) from error
    found: Rule | None = getattr(module, name, None)
    if not callable(found):
        raise InputError(f'no function "{name}" in the file', file=path)
    return found
