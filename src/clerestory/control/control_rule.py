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
    """Return the states chosen by a rule, after validation.

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
            f"{name} returns states of shape {states.shape}; ({len(situation.times)},)"
            " expected"
        )
    if not np.issubdtype(states.dtype, np.integer):
        raise InputError(
            f"{name} returns {states.dtype} values; whole numbers expected"
        )
    if len(states) and not 0 <= states.min() <= states.max() < situation.states:
        raise InputError(
            f"{name} returns states from {states.min()} to {states.max()}; 0 to"
            f" {situation.states - 1} expected"
        )
    return states


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
        raise InputError("is not a Python file; one expected", file=path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # user code may raise any exception
        raise InputError(
            f"{_message(error)}; a file that runs expected", file=path
        ) from (error)
    found = getattr(module, name, None)
    if not callable(found):
        raise InputError(f'has no function "{name}"; one expected', file=path)
    return found  # type: ignore[no-any-return]


def _message(error: BaseException) -> str:
    text = " ".join(str(error).split())[:200]
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
