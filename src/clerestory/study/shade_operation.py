"""Shade operation: the state of every window group at every time step.

Rules based on exterior quantities are evaluated first, then the rule "LM-83" for the
groups of each grid together, then rules on interior illuminance or glare, group by
group.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from clerestory.control.lm83_blinds import Operation, operate_by_direct_sun
from clerestory.control.state_choice import when_occupied
from clerestory.study.control_case import Case
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.control_rules import INSIDE, OUTSIDE
from clerestory.study.window_groups import WindowGroup
from clerestory.study.window_tables import INTERIOR, ControlTable
from clerestory.study.zone_control_rules import (
    ZONE_QUANTITIES,
    ZONES,
    by_zone_threshold,
)


@dataclass(frozen=True, eq=False)
class ShadeOperation:
    """Shade states of each window group over time.

    `kept`: whether the LM-83 limit is met, per time step; None without rule "LM-83".
    """

    states: list[Int[np.ndarray, " time"]]
    kept: Bool[np.ndarray, " time"] | None = None


def operate(signals: ControlInputs) -> ShadeOperation:
    """Return the shade states by the control rules of a study."""
    groups = signals.inputs.groups
    steps = len(signals.times)
    states = [np.full(steps, len(group.states) - 1) for group in groups]

    # Rules based on exterior quantities; without a rule, a group is in shade state 0
    for number, group in enumerate(groups):
        control = group.control
        if control is None or len(group.states) == 1:
            states[number] = np.zeros(steps, dtype=int)
        elif control.rule in OUTSIDE and not _looks_inside(group):
            _decide(signals, number, states)

    kept = _by_direct_sun(signals, states)

    # Rules based on interior illuminance or glare, one window group after the other
    for number, group in enumerate(groups):
        if len(group.states) > 1 and _looks_inside(group):
            _decide(signals, number, states)
    return ShadeOperation(states, kept)


def _looks_inside(group: WindowGroup) -> bool:
    control = group.control
    return control is not None and (
        control.rule in INSIDE
        or control.rule in ZONES
        or control.quantity in (*INTERIOR, *ZONE_QUANTITIES)
    )


def _decide(signals: ControlInputs, number: int, states: list[np.ndarray]) -> None:
    # Set the shade states of one group by the control rule of the group
    control = signals.inputs.groups[number].control
    if control is not None:
        rule = (OUTSIDE | INSIDE | ZONES)[control.rule]
        if control.quantity in ZONE_QUANTITIES:
            rule = by_zone_threshold
        found = rule(Case(signals, number, control, list(states)))
        states[number] = _unless_empty(signals, number, np.asarray(found, dtype=int))


def _by_direct_sun(
    signals: ControlInputs, states: list[np.ndarray]
) -> np.ndarray | None:
    # Rule "LM-83": groups with the same grid together, one grid after the other
    governed = {
        n: group.control
        for n, group in enumerate(signals.inputs.groups)
        if group.control and group.control.rule == "LM-83" and len(group.states) > 1
    }
    kept = None
    for grid in dict.fromkeys(control.grid for control in governed.values()):
        chosen = {n: c for n, c in governed.items() if c.grid == grid}
        found = _of_grid(signals, states, chosen)
        kept = found.kept if kept is None else kept & found.kept
        for n in chosen:
            states[n] = _unless_empty(signals, n, found.states[str(n)])
    return kept


def _of_grid(
    signals: ControlInputs, states: list[np.ndarray], chosen: dict[int, ControlTable]
) -> Operation:
    # Blinds operated by one grid; the states of all other groups are fixed
    groups, control = signals.inputs.groups, next(iter(chosen.values()))
    steps = len(signals.times)
    direct = {
        str(n): np.stack(
            [
                signals.direct(n, [np.full(steps, state)], control.grid)
                for state in range(len(groups[n].states))
            ]
        )
        for n in chosen
    }
    rest = [n for n in range(len(groups)) if n not in chosen]
    static = [signals.direct(n, [states[n]], control.grid) for n in rest]
    return operate_by_direct_sun(
        direct,
        static=np.sum(static, axis=0) if static else None,
        sun_lux=control.sun_lux,
        most_sensors=control.most_sensors,
    )


def _unless_empty(signals: ControlInputs, number: int, state: np.ndarray) -> np.ndarray:
    group = signals.inputs.groups[number]
    if group.control is None or group.control.when_empty is None:
        return state
    empty = group.number_of(group.control.when_empty)
    return when_occupied(state, signals.occupied, otherwise=empty)
