"""Blind operation of IES LM-83: at most 2 % of the sensors in direct sunlight.

A sensor is in direct sunlight at 1000 lux or more from the sun without reflections.
Each window group has a blind state of its own; at each time step, the most open
combination of states that meets the criterion is chosen.

Reference: IES LM-83-12, Approved Method: spatial daylight autonomy and
annual sunlight exposure (blinds operation).
"""

import itertools
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.checks import has_shape, require

SUN_LUX = 1000.0
MOST_SENSORS = 0.02

# Largest number of combinations of states for an exhaustive search
_MOST_COMBINATIONS = 256


class Operation(NamedTuple):
    """Blind states of each window group, and time steps that meet the criterion."""

    states: dict[str, Int[np.ndarray, " time"]]
    kept: Bool[np.ndarray, " time"]


def operate_by_direct_sun(
    direct: Mapping[str, Float[np.ndarray, "_ sensor time"]],
    *,
    static: Float[np.ndarray, "sensor time"] | None = None,
    sun_lux: float = SUN_LUX,
    most_sensors: float = MOST_SENSORS,
) -> Operation:
    """Return the blind operation of LM-83.

    Parameters
    ----------
    direct : direct illuminance through each window group [lux], over (state, sensor,
        time), with states from the most open to the most closed
    static : direct illuminance through windows without blinds [lux]
    sun_lux : lowest direct illuminance of a sensor in direct sunlight [lux]
    most_sensors : largest permitted fraction of sensors in direct sunlight

    The most open combination of states has the smallest sum of state numbers; among
    equal sums, the first window groups are most open. If there are more than 256
    combinations, one window group at a time is closed by one state: the group that
    contributes most direct illuminance to sensors in direct sunlight.

    >>> sun = np.array([[[2000.0, 500.0]], [[100.0, 25.0]]])  # open, closed; two hours
    >>> operate_by_direct_sun({"south": sun}).states["south"].tolist()
    [1, 0]
    """
    require(direct, "no window group with blinds; at least one expected")
    base = np.zeros(next(iter(direct.values())).shape[1:]) if static is None else static
    for group, values in direct.items():
        has_shape(values, (len(values), *base.shape), f"direct illuminance of {group}")
    counts = [len(values) for values in direct.values()]
    if math.prod(counts) > _MOST_COMBINATIONS:
        return _one_by_one(direct, base, sun_lux, most_sensors)

    # Try combinations from all open to all closed
    order = sorted(itertools.product(*map(range, counts)), key=sum)
    chosen = np.full(base.shape[1], -1)
    for number, states in enumerate(order):
        total = base + sum(
            values[state] for values, state in zip(direct.values(), states, strict=True)
        )
        good = (total >= sun_lux).mean(axis=0) <= most_sensors
        chosen[(chosen < 0) & good] = number
    kept = chosen >= 0
    table = np.array(order)[np.where(kept, chosen, len(order) - 1)]
    return Operation(
        {group: table[:, column] for column, group in enumerate(direct)}, kept
    )


def _one_by_one(
    direct: Mapping[str, Float[np.ndarray, "_ sensor time"]],
    base: Float[np.ndarray, "sensor time"],
    sun_lux: float,
    most_sensors: float,
) -> Operation:
    steps = np.arange(base.shape[1])
    states = {group: np.zeros(len(steps), dtype=int) for group in direct}
    last = {group: len(values) - 1 for group, values in direct.items()}
    while True:
        lux = {g: values[states[g], :, steps].T for g, values in direct.items()}
        sunny = base + sum(lux.values()) >= sun_lux
        kept = sunny.mean(axis=0) <= most_sensors
        closable = np.stack([states[group] < last[group] for group in direct])
        if not np.any(~kept & closable):
            return Operation(states, np.asarray(kept))
        added = np.stack([(each * sunny).sum(axis=0) for each in lux.values()])
        worst = np.where(closable, added, -1).argmax(axis=0)
        for column, group in enumerate(direct):
            states[group] += ~kept & closable[column] & (worst == column)
