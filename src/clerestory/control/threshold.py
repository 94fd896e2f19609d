"""Threshold control of shades with hysteresis and delay.

A shade closes when a quantity, such as irradiance, was above the upper threshold for a
number of consecutive time steps, and opens when the quantity was below the lower
threshold. Delays reduce the number of movements under partly cloudy skies.
"""

from functools import partial

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import one_of, positive, require, same_length


def threshold_states(
    quantity: Float[np.ndarray, " time"],
    *,
    close_above: float,
    open_below: float | None = None,
    close_after: int = 1,
    open_after: int = 1,
    start: int = 0,
) -> Int[np.ndarray, " time"]:
    """Return the state of a shade at each time step: 1 closed, 0 open.

    Parameters
    ----------
    quantity : irradiance, illuminance or another quantity; NaN does not move the shade
    close_above, open_below : upper and lower threshold; default of `open_below`:
        `close_above`
    close_after, open_after : consecutive time steps above or below the threshold
        before the shade moves
    start : shade state before the first time step

    >>> lux = np.array([10.0, 60.0, 45.0, 60.0, 20.0, 20.0])
    >>> threshold_states(lux, close_above=50, open_below=30).tolist()
    [0, 1, 1, 1, 0, 0]
    >>> threshold_states(lux, close_above=50, close_after=2).tolist()
    [0, 0, 0, 0, 0, 0]
    """
    low = close_above if open_below is None else open_below
    message = f"open_below is {low:g}; at most close_above = {close_above:g} expected"
    require(low <= close_above, message)
    positive((close_after, open_after), "delay in steps")
    one_of(start, "start", choices=(0, 1))
    states = np.empty(len(quantity), dtype=int)
    closed, run = bool(start), 0
    above, below = quantity > close_above, quantity < low
    for step in range(len(quantity)):
        beyond = below[step] if closed else above[step]
        run = run + 1 if beyond else 0
        if run >= (open_after if closed else close_after):
            closed, run = not closed, 0
        states[step] = closed
    return states


def staged_states(
    quantity: Float[np.ndarray, " time"],
    *,
    close_above: Float[np.ndarray, " stage"],
    open_below: Float[np.ndarray, " stage"] | None = None,
    close_after: int = 1,
    open_after: int = 1,
) -> Int[np.ndarray, " time"]:
    """Return the state, 0 to n, of a shade with n stages at each time step.

    Upper and lower thresholds increase from stage to stage; the state is the number of
    closed stages.

    >>> w = np.array([100.0, 300.0, 600.0, 200.0])
    >>> staged_states(w, close_above=np.array([250.0, 500.0])).tolist()
    [0, 1, 2, 0]
    """
    low = close_above if open_below is None else open_below
    same_length(low, close_above, "thresholds to open", "thresholds to close")
    increasing = np.all(np.diff(close_above) > 0)
    require(increasing, f"close_above is {close_above}; increasing numbers expected")
    stage = partial(
        threshold_states, quantity, close_after=close_after, open_after=open_after
    )
    stages = [
        stage(close_above=float(upper), open_below=float(lower))
        for upper, lower in zip(close_above, low, strict=True)
    ]
    return np.asarray(np.sum(stages, axis=0))
