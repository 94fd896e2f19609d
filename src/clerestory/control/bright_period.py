"""Control of shades for a bright period of the day at eyes, such as four hours by noon.

Until a day has had its period, the shade is as closed as the target allows, and open
where no state reaches it; after that it follows another rule. The period of WELL v2,
feature L03, is four hours with a melanopic EDI of 250 lux that begin by noon.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import has_shape, positive
from clerestory.control.state_choice import Limit, best_states, within_limits

# Length of the period, and latest hour of its beginning [h]
_HOURS, _NOON = 4.0, 12.0


def bright_states(
    light: Float[np.ndarray, "state time"],
    times: np.ndarray,
    *,
    target: float,
    afterwards: Int[np.ndarray, " time"],
    limits: Sequence[Limit] = (),
    step_hours: float = 1.0,
    period_hours: float = _HOURS,
    last_begin: float = _NOON,
) -> Int[np.ndarray, " time"]:
    """Return the shade state at each time step.

    The most closed state with the target within the limits is taken until the target
    was kept for the period; if none has it, the state with the most light within the
    limits. States `afterwards` follow: when the period is over, when it cannot begin
    any more, and in the dark.

    Parameters
    ----------
    light : melanopic EDI or illuminance in every state, the most open first [lux]
    times : centres of the time steps
    limits : limits of other quantities, such as DGP
    last_begin : hour of the day by which the period must begin

    Examples
    --------
    >>> times = np.arange("2023-06-01T08:30", "2023-06-01T14:30", 60, "datetime64[m]")
    >>> open_lux = np.array([200.0, 600, 900, 900, 900, 900])
    >>> light = np.stack([open_lux, 0.5 * open_lux, 0.1 * open_lux])
    >>> bright_states(light, times, target=250, afterwards=np.full(6, 2)).tolist()
    [0, 1, 1, 1, 1, 2]
    """
    positive(target, "the target", unit="lux")
    has_shape(afterwards, (len(times),), "states afterwards")
    allowed = within_limits(limits, light.shape)
    reached = (light >= target) & allowed
    last = len(light) - 1
    closed = last - reached[::-1].argmax(axis=0)
    chosen = np.where(reached.any(axis=0), closed, best_states(light, limits))
    count = max(1, round(period_hours / step_hours))
    states = np.array(afterwards)
    begin = times.astype("datetime64[s]") - np.timedelta64(
        round(1800 * step_hours), "s"
    )
    day = begin.astype("datetime64[D]")
    hour = (begin - day) / np.timedelta64(3600, "s")
    run, done = 0, False
    for step in range(len(times)):
        if step and day[step] != day[step - 1]:
            run, done = 0, False
        too_late = run == 0 and hour[step] > last_begin
        if done or too_late or light[:, step].max() <= 0:
            continue
        states[step] = chosen[step]
        run = run + 1 if light[chosen[step], step] >= target else 0
        done = run >= count
    return states
