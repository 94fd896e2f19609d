"""State schedules: shading state of each window group over time.

The states of a window group are numbered from the most open, 0, to the most closed.
Results are computed once for every state; a schedule selects one per time step.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np
from jaxtyping import Float, Int

from clerestory.argument_types import checked_fields
from clerestory.brief_repr import brief
from clerestory.checks import distinct, not_negative, require, same_length, within
from clerestory.errors import InputError, located
from clerestory.escaping import csv_line, plain_cell
from clerestory.files import csv_rows, read_text, write_text

# Largest state number in a file
_MOST_STATES = 10_000

# NumPy would read "now" and years of five digits, and subtract an offset from UTC
_TIME = re.compile(r"\d{4}-\d\d-\d\d([T ]\d\d(:\d\d(:\d\d(\.\d+)?)?)?)?", re.ASCII)
_OFFSET = re.compile(r"[T ].*[Zz+-]")


@final
@checked_fields
@dataclass(frozen=True, eq=False)
class StateSchedule:
    """States of window groups over time.

    Attributes
    ----------
    times : centres of the time steps, local standard time
    states : state number of each window group over time

    Raises
    ------
    InputError : numbers of states and times differ, or a state is negative

    Examples
    --------
    >>> day = np.datetime64("2001-06-21T00:30") + np.arange(3) * np.timedelta64(1, "h")
    >>> schedule = StateSchedule(day, {"south": np.array([0, 1, 1])})
    >>> schedule.hours_in_state("south", count=2).tolist()
    [1, 2]
    """

    times: np.ndarray
    states: Mapping[str, Int[np.ndarray, " time"]]

    __repr__ = brief

    def __post_init__(self) -> None:
        for group, state in self.states.items():
            same_length(state, self.times, f"states of group {group!r}", "time steps")
            not_negative(state, f"state of group {group!r}")

    def hours_in_state(self, group: str, *, count: int) -> Int[np.ndarray, " state"]:
        """Number of time steps of a window group in each state."""
        return np.bincount(self.states[group], minlength=count)

    def total(
        self,
        by_state: Mapping[str, Float[np.ndarray, "_ sensor time"]],
        *,
        static: Float[np.ndarray, "sensor time"] | None = None,
    ) -> Float[np.ndarray, "sensor time"]:
        """Sum the results of all window groups, each in the scheduled states.

        Parameters
        ----------
        by_state : results of each window group over (state, sensor, time)
        static : results of windows without shades
        """
        parts = [] if static is None else [static]
        for group, state in self.states.items():
            require(
                group in by_state,
                f"no results of window group {group!r}; results in each state expected",
            )
            parts.append(select_states(by_state[group], state))
        require(parts, "a schedule without window groups; at least one expected")
        return np.asarray(np.sum(parts, axis=0))


def select_states(
    by_state: Float[np.ndarray, "state *rest time"], state: Int[np.ndarray, " time"]
) -> Float[np.ndarray, "*rest time"]:
    """Select, for each time step, the values of the scheduled state.

    >>> values = np.array([[10.0, 20.0], [1.0, 2.0]])
    >>> select_states(values, np.array([0, 1])).tolist()
    [10.0, 2.0]
    """
    by_time = np.moveaxis(by_state, -1, 0)
    same_length(state, by_time, "states", "time steps")
    within(state, "state", least=0, most=len(by_state) - 1)
    return np.asarray(np.moveaxis(by_time[np.arange(len(state)), state], 0, -1))


def states_at(
    schedule: StateSchedule, times: np.ndarray
) -> dict[str, Int[np.ndarray, " time"]]:
    """States at given times; each state lasts until the next time of the schedule.

    Years are ignored: before the first time of the schedule, the states are those of
    the last time.

    >>> lines = np.array(["2001-01-01T08:00", "2001-01-01T18:00"], "datetime64[s]")
    >>> schedule = StateSchedule(lines, {"south": np.array([1, 0])})
    >>> day = np.array(["2023-01-01T07:30", "2023-01-01T09:30"], "datetime64[s]")
    >>> states_at(schedule, day)["south"].tolist()
    [0, 1]
    """
    require(len(schedule.times), "a schedule without lines; at least one expected")
    lines, steps = _of_the_year(schedule.times), _of_the_year(times)
    order = np.argsort(lines, kind="stable")
    at = order[np.searchsorted(lines[order], steps, side="right") - 1]
    return {group: np.asarray(states)[at] for group, states in schedule.states.items()}


def read_schedule(path: str | Path) -> StateSchedule:
    """Read times and shade states from a CSV file with the header `time,GROUP…`."""
    lines = read_text(path).splitlines()
    head = [*csv_rows(lines[:1], file=path), []][0]
    groups = [plain_cell(word.strip()) for word in head[1:]]
    message = "no header time,GROUP… in the first line"
    require(groups, message, file=path, line=1)
    with located(file=path, line=1):
        distinct(groups, "columns")
    times, rows = [], []
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        words = [word.strip() for word in line.split(",")]
        message = f"{line.strip()[:60]!r}; a time, and a state from 0 to {_MOST_STATES}"
        message += f" for each of {', '.join(groups)}, expected"
        offset = _OFFSET.search(words[0])
        local = f"{words[0][:40]!r} has an offset from UTC; local standard time"
        require(not offset, f"{local} expected", file=path, line=number)
        try:
            moment = np.datetime64(words[0], "s")
            row = [int(word) for word in words[1:]]
        except ValueError as error:
            raise InputError(message, file=path, line=number) from error
        valid = _TIME.fullmatch(words[0]) is not None
        valid = (
            valid
            and len(row) == len(groups)
            and 0 <= min(row) <= max(row) <= _MOST_STATES
        )
        require(valid and not np.isnat(moment), message, file=path, line=number)
        times.append(moment)
        rows.append(row)
    message = "no lines after the header; a time and states expected"
    require(rows, message, file=path)
    table = np.array(rows, dtype=int).reshape(-1, len(groups))
    return StateSchedule(
        np.array(times, dtype="datetime64[s]"),
        {group: table[:, column] for column, group in enumerate(groups)},
    )


def write_schedule(path: str | Path, schedule: StateSchedule) -> None:
    """Write a schedule to a CSV file in the format of `read_schedule`."""
    rows = [csv_line(["time", *schedule.states])]
    for step, moment in enumerate(schedule.times.astype("datetime64[s]")):
        states = (str(int(state[step])) for state in schedule.states.values())
        rows.append(",".join([str(moment), *states]))
    write_text(path, "\n".join(rows) + "\n")


def _of_the_year(times: np.ndarray) -> np.ndarray:
    # Minutes since 1970, after the year is replaced by the leap year 2024
    moments = times.astype("datetime64[m]")
    months = moments.astype("datetime64[M]")
    month = months.astype(int) % 12
    leap = (np.datetime64("2024-01", "M") + month).astype("datetime64[m]")
    return np.asarray((leap + (moments - months)).astype(int))
