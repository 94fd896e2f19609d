"""Annual states of windows, such as open or closed, selected by a control rule."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Int, UInt8
from matplotlib import colormaps

from clerestory.escaping import printable
from clerestory.report.class_map import DayMap, keys
from clerestory.report.content import ReportContent
from clerestory.report.markup import render
from clerestory.report.section import Section
from clerestory.report.uncertain_value import setting_label, setting_words
from clerestory.study.window_tables import ControlTable


@dataclass(frozen=True, eq=False)
class WindowStates:
    """State of a window group (such as open or closed) at each time step.

    `names` are the states from open to closed; `state` is an index of `names`. `rule`
    describes the control rule and may be empty.
    """

    window: str
    names: tuple[str, ...]
    rule: str
    state: Int[np.ndarray, " time"]

    def colours(self) -> UInt8[np.ndarray, "kind 3"]:
        """Colour of each state, from light for open to dark for closed."""
        place = np.linspace(0.08, 0.92, max(len(self.names), 2))[: len(self.names)]
        return np.round(255 * colormaps["YlGnBu"](place)[:, :3]).astype(np.uint8)


def window_states(data: xr.Dataset) -> tuple[WindowStates, ...]:
    """Return the shade states over the year of each window with several states."""
    if "state" not in data:
        return ()
    study = json.loads(data.attrs.get("study", "{}"))
    rules = {
        table_name(t): rule_words(t.get("control")) for t in study.get("window", [])
    }
    found = []
    for window in data["window"].values.tolist():
        names = state_names(data, str(window))
        if len(names) > 1:
            state = np.asarray(data["state"].sel(window=window).values, dtype=int)
            group = str(window).split(".")[0]
            rule = rules.get(str(window), rules.get(group, ""))
            found.append(WindowStates(str(window), names, rule, state))
    return tuple(found)


def states_section(content: ReportContent) -> Section:
    """Return annual maps of windows, with the fraction of time in each shade state."""
    states = window_states(content.data)
    if not states:
        return Section()
    maps = [
        DayMap(
            f"states-{k}",
            f"State of window {each.window} by day and hour",
            each.state,
            each.names,
            each.colours(),
        )
        for k, each in enumerate(states)
    ]
    windows = [
        {
            "name": each.window,
            "rule": each.rule,
            "map": shown.drawing(content.grid, occupied=content.occupied),
            "shares": keys(_shares(each, content), each.colours()),
        }
        for each, shown in zip(states, maps, strict=True)
    ]
    return Section(render("states.html", windows=windows), maps=maps)


def _shares(each: WindowStates, content: ReportContent) -> list[str]:
    # For each window state: name, percentage and number of occupied hours
    return [
        f"{name}: {content.occupied_share(each.state == k)}"
        for k, name in enumerate(each.names)
    ]


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


def table_name(table: dict[str, Any]) -> str:
    """Return `name` of a table in the study; without a name, the stem of its file."""
    return str(table.get("name") or printable(Path(str(table.get("file", ""))).stem))


def rule_words(control: dict[str, Any] | None) -> str:
    """Return the name of a control rule and its parameters other than defaults."""
    if not control:
        return ""
    fields = ControlTable.model_fields
    chosen = {
        setting_label(key): value
        for key, value in control.items()
        if key != "rule" and key in fields and value != fields[key].get_default()
    }
    words = setting_words(chosen)
    rule = str(control.get("rule", ""))
    return f"{rule}: {words}" if words else rule
