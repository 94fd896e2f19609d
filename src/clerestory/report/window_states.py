"""Annual window states, as selected by the control."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Bool, Int, UInt8
from matplotlib import colormaps

from clerestory.report.class_map import DayMap, day_map, keys
from clerestory.report.markup import Markup, render
from clerestory.report.period import hours_in
from clerestory.report.uncertain_value import number
from clerestory.study.window_tables import ControlTable


@dataclass(frozen=True, eq=False)
class WindowStates:
    """States of a window group over the year.

    Attributes
    ----------
    window : name of the window group
    names : names of the states, most open first
    rule : description of the control rule; may be empty
    state : index of the state in each time step
    """

    window: str
    names: tuple[str, ...]
    rule: str
    state: Int[np.ndarray, " time"]

    def colours(self) -> UInt8[np.ndarray, "kind 3"]:
        """Colour of each state, from light for open to dark for closed."""
        place = np.linspace(0.08, 0.92, max(len(self.names), 2))[: len(self.names)]
        shades = colormaps["YlGnBu"](place)
        return np.round(255 * shades[:, :3]).astype(np.uint8)


def window_states(data: xr.Dataset) -> tuple[WindowStates, ...]:
    """Return the states in the results, for windows with several states."""
    if "state" not in data:
        return ()
    study = json.loads(data.attrs.get("study", "{}"))
    rules = {_label(t): rule_words(t.get("control")) for t in study.get("window", [])}
    found = []
    for window in data["window"].values.tolist():
        names = state_names(data, str(window))
        if len(names) > 1:
            state = np.asarray(data["state"].sel(window=window).values, dtype=int)
            group = str(window).split(".")[0]
            rule = rules.get(str(window), rules.get(group, ""))
            found.append(WindowStates(str(window), names, rule, state))
    return tuple(found)


def state_maps(states: Sequence[WindowStates]) -> list[DayMap]:
    """Return the annual map of the states of each window."""
    return [
        DayMap(
            f"states-{k}",
            f"State of window {each.window} by day and hour",
            each.state,
            each.names,
            each.colours(),
        )
        for k, each in enumerate(states)
    ]


def states_section(
    states: Sequence[WindowStates],
    times: np.ndarray,
    *,
    occupied: Bool[np.ndarray, " time"],
) -> Markup:
    """Return an annual map per window, with the fraction of time in each state."""
    if not states:
        return Markup("")
    windows = [
        {
            "name": each.window,
            "rule": each.rule,
            "map": day_map(shown, times, occupied=occupied),
            "shares": keys(state_shares(each, times, occupied), each.colours()),
        }
        for each, shown in zip(states, state_maps(states), strict=True)
    ]
    return render("states.html", windows=windows)


def state_shares(
    each: WindowStates, times: np.ndarray, occupied: Bool[np.ndarray, " time"]
) -> list[str]:
    """Return name, percentage and number of occupied hours of each state."""
    words = []
    for k, name in enumerate(each.names):
        chosen = occupied & (each.state == k)
        share = 100 * chosen.sum() / max(occupied.sum(), 1)
        words.append(f"{name}: {share:.1f} %, {number(hours_in(times, chosen))} h")
    return words


def states_note(states: Sequence[WindowStates], step: int) -> str:
    """Return the window states at a time step in words."""
    return "; ".join(
        f"{each.window}: {each.names[each.state[step]]}" for each in states
    )


def state_names(data: xr.Dataset, window: str) -> tuple[str, ...]:
    """Return the names of the states of a window in results, most open first."""
    if "state_name" not in data:
        number = int(data["state"].sel(window=window).max()) + 1
        return tuple(f"state {k}" for k in range(number))
    names = data["state_name"].sel(window=window).values.tolist()
    return tuple(str(name) for name in names if name)


def _label(table: dict[str, Any]) -> str:
    return str(table.get("name") or Path(str(table.get("file", ""))).stem)


def rule_words(control: dict[str, Any] | None) -> str:
    """Return the name of the rule, and parameters that differ from the defaults."""
    if not control:
        return ""
    fields = ControlTable.model_fields
    words = [
        f"{key.replace('_deg', ' [°]').replace('_', ' ')} {_plain(value)}"
        for key, value in control.items()
        if key != "rule"
        and key in fields
        and value not in (fields[key].get_default(), "", [], None)
    ]
    rule = str(control.get("rule", ""))
    return f"{rule}: {', '.join(words)}" if words else rule


def _plain(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_plain, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
