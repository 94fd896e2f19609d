"""LM-83's rule: close blinds when more than 2 % of the sensors get direct sun.

Direct sun is 1000 lux or more of light that comes straight from the sun. Groups of
windows are operated one by one; at each step the least closed combination of states
that keeps the rule is taken.

Reference: IES LM-83-12 and LM-83-23, Approved Method: spatial daylight autonomy and
annual sunlight exposure (blinds operation).
"""

import itertools
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.errors import InputError

SUN_LUX = 1000.0
MOST_SENSORS = 0.02

# More combinations of states than this are not tried one by one.
_MOST_COMBINATIONS = 256


class Operation(NamedTuple):
    """Blinds operated by the rule.

    Attributes
    ----------
    states : per group, over time
    kept : whether the rule is kept at each step; false where even all closed breaks it
    """

    states: dict[str, Int[np.ndarray, " time"]]
    kept: Bool[np.ndarray, " time"]


def operate_by_direct_sun(
    direct: Mapping[str, Float[np.ndarray, "_ sensor time"]],
    *,
    static: Float[np.ndarray, "sensor time"] | None = None,
    sun_lux: float = SUN_LUX,
    most_sensors: float = MOST_SENSORS,
) -> Operation:
    """Return the states that LM-83's rule asks for.

    Parameters
    ----------
    direct : per group, direct illuminance in every state from the most open on [lux],
        over (state, sensor, time)
    static : direct illuminance through windows without blinds [lux]
    sun_lux, most_sensors : the rule's numbers

    Raises
    ------
    InputError : no groups, or arrays that do not fit

    Notes
    -----
    Of combinations with the same sum of state numbers the first is taken, groups in
    their order. Beyond 256 combinations groups are closed one after another, the one
    that puts most sensors in the sun first.

    Examples
    --------
    >>> sun = np.array([[[2000.0, 500.0]], [[100.0, 25.0]]])  # open, closed; two hours
    >>> operate_by_direct_sun({"south": sun}).states["south"].tolist()
    [1, 0]
    """
    if not direct:
        raise InputError("no window group with blinds; at least one expected")
    shapes = {values.shape[1:] for values in direct.values()}
    if len(shapes) > 1 or (static is not None and {static.shape} != shapes):
        raise InputError(f"direct light over {shapes}; (sensor, time) alike expected")
    base = np.zeros(next(iter(shapes))) if static is None else static
    counts = [len(values) for values in direct.values()]
    if np.prod([float(count) for count in counts]) > _MOST_COMBINATIONS:
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
    groups = list(direct)
    steps = np.arange(base.shape[1])
    states = {group: np.zeros(len(steps), dtype=int) for group in groups}
    last = {group: len(values) - 1 for group, values in direct.items()}
    total = base + sum(values[0] for values in direct.values())
    for _ in range(sum(last.values())):
        bad = (total >= sun_lux).mean(axis=0) > most_sensors
        share = np.stack(
            [
                (direct[g][states[g], :, steps].T * (total >= sun_lux)).sum(axis=0)
                * (states[g] < last[g])
                - (states[g] == last[g])
                for g in groups
            ]
        )
        worst = share.argmax(axis=0)
        for column, group in enumerate(groups):
            close = bad & (worst == column) & (states[group] < last[group])
            states[group] = states[group] + close
        total = base + sum(direct[g][states[g], :, steps].T for g in groups)
    kept = (total >= sun_lux).mean(axis=0) <= most_sensors
    return Operation(states, np.asarray(kept))
