"""Threshold control of shades with hysteresis and delay.

A shade closes when a quantity, such as irradiance, was above the upper threshold for a
number of consecutive time steps, and opens when the quantity was below the lower
threshold. Delays reduce the number of movements under partly cloudy skies.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import one_of, positive, require, same_length


@dataclass
class ShadeStage:
    """One stage of a shade, closed or open, moved step by step.

    Attributes
    ----------
    close_above, open_below : upper and lower threshold
    close_after, open_after : consecutive time steps beyond a threshold before the shade
        moves
    closed : whether the stage is closed
    """

    close_above: float
    open_below: float
    close_after: int = 1
    open_after: int = 1
    closed: bool = False
    _run: int = 0

    def __post_init__(self) -> None:
        low, high = self.open_below, self.close_above
        message = f"open_below is {low:g}; at most close_above = {high:g} expected"
        require(low <= high, message)
        positive((self.close_after, self.open_after), "delay in steps")

    def move(self, value: float) -> bool:
        """Return whether the stage is closed after a further value; NaN is ignored."""
        closed = self.closed
        beyond = value < self.open_below if closed else value > self.close_above
        self._run = self._run + 1 if beyond else 0
        if self._run >= (self.open_after if closed else self.close_after):
            self.closed, self._run = not closed, 0
        return self.closed


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
    one_of(start, "start", choices=(0, 1))
    low = close_above if open_below is None else open_below
    stage = ShadeStage(close_above, low, close_after, open_after, bool(start))
    return np.array([stage.move(value) for value in quantity.tolist()], dtype=int)


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
