"""Shades driven by a measured quantity: thresholds with hysteresis and delay.

A motor that follows a threshold at once wears out under broken clouds. It closes
when the quantity has been above the upper threshold for a while, and opens when it
has been below the lower one for a while.
"""

import numpy as np
from jaxtyping import Float, Int

from clerestory.errors import InputError


def threshold_states(
    quantity: Float[np.ndarray, " time"],
    *,
    close_above: float,
    open_below: float | None = None,
    close_after: int = 1,
    open_after: int = 1,
    start: int = 0,
) -> Int[np.ndarray, " time"]:
    """Return 1 (closed) or 0 (open) at each step.

    Parameters
    ----------
    quantity : irradiance [W/m²], illuminance [lux] or what else drives the shade;
        NaN counts as no news
    close_above, open_below : thresholds; the lower one is the upper one if not given
    close_after, open_after : steps in a row beyond the threshold before it moves
    start : state before the first step

    Raises
    ------
    InputError : the lower threshold is above the upper, or a delay below 1

    Examples
    --------
    >>> lux = np.array([10.0, 60.0, 45.0, 60.0, 20.0, 20.0])
    >>> threshold_states(lux, close_above=50, open_below=30).tolist()
    [0, 1, 1, 1, 0, 0]
    >>> threshold_states(lux, close_above=50, close_after=2).tolist()
    [0, 0, 0, 0, 0, 0]
    """
    low = close_above if open_below is None else open_below
    if low > close_above:
        raise InputError(
            f"opens below {low:g} and closes above {close_above:g}; the lower threshold"
            " below the upper one expected"
        )
    if min(close_after, open_after) < 1 or start not in (0, 1):
        raise InputError(
            f"delays of {close_after} and {open_after} steps from state {start}; 1 or"
            " more steps, and state 0 or 1, expected"
        )
    states = np.empty(len(quantity), dtype=int)
    closed, run = bool(start), 0
    above, below = quantity > close_above, quantity < low
    for step in range(len(quantity)):
        wants = below[step] if closed else above[step]
        run = run + 1 if wants else 0
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
    """Return state 0 … n of a shade that closes in n stages.

    Each stage has its own thresholds, growing; the state is the number of stages that
    are closed.

    Examples
    --------
    >>> w = np.array([100.0, 300.0, 600.0, 200.0])
    >>> staged_states(w, close_above=np.array([250.0, 500.0])).tolist()
    [0, 1, 2, 0]
    """
    low = close_above if open_below is None else open_below
    if len(low) != len(close_above) or np.any(np.diff(close_above) <= 0):
        raise InputError(
            f"thresholds {close_above} and {low}; growing ones, two per stage, expected"
        )
    stages = [
        threshold_states(
            quantity,
            close_above=float(upper),
            open_below=float(lower),
            close_after=close_after,
            open_after=open_after,
        )
        for upper, lower in zip(close_above, low, strict=True)
    ]
    return np.asarray(np.sum(stages, axis=0))
