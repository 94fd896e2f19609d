"""Control rules that know temperature and loads of a zone.

The model of the zone is operated along with the shade: its temperature and its loads
are those that follow from the states chosen before.
"""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.checks import one_of, require
from clerestory.control.predictive import ShadeCosts
from clerestory.control.threshold import ShadeStage
from clerestory.control.zone_model import ZoneData, ZoneModel, zone_step

ZoneQuantity = Literal["zone temperature", "heating load", "cooling load"]

# Days of which the loads tell the season
_SEASON_DAYS = 7


def zone_threshold_states(
    model: ZoneModel,
    data: ZoneData,
    shades: ShadeCosts,
    *,
    quantity: ZoneQuantity,
    close_above: Float[np.ndarray, " stage"],
    open_below: Float[np.ndarray, " stage"] | None = None,
    close_after: int = 1,
    open_after: int = 1,
) -> Int[np.ndarray, " time"]:
    """Return the states of a shade that closes by temperature [°C] or load [W].

    The quantity is that of the time step before. With one threshold, the shade has two
    states, the first and the last; with several, a state for each stage.

    Parameters
    ----------
    quantity : temperature of the air, heating or cooling load
    close_above, open_below, close_after, open_after : as for `staged_states`

    Examples
    --------
    >>> model = ZoneModel(20.0, 0.0, 400.0, 500.0, 0.3, 0.5)
    >>> hours = np.ones(12)
    >>> data = ZoneData(20 * hours, 18 * hours, 30 * hours, 0 * hours)
    >>> sun = np.where(np.arange(12) > 5, 2000.0, 0.0)
    >>> shades = ShadeCosts(np.stack([sun, 0 * sun]), np.zeros((2, 12)),
    ...                     np.zeros((2, 12)), hours > 0)
    >>> zone_threshold_states(model, data, shades, quantity="zone temperature",
    ...                       close_above=np.array([24.0])).tolist()
    [0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1]
    """
    one_of(quantity, "quantity", choices=get_args(ZoneQuantity))
    low = close_above if open_below is None else open_below
    stages = [
        ShadeStage(float(upper), float(lower), close_after, open_after)
        for upper, lower in zip(close_above, low, strict=True)
    ]
    count = len(shades.window)
    factor = count - 1 if len(stages) == 1 else 1
    require(
        len(stages) * factor == count - 1,
        f"{len(stages)} thresholds for {count} states; one, or {count - 1}, expected",
    )
    states = np.empty(len(data.outdoor), dtype=int)
    mass, value = float(data.heating_setpoint[0]), np.nan
    for step in range(len(states)):
        state = factor * sum(stage.move(value) for stage in stages)
        states[step] = state
        air, heat, cold, mass = zone_step(
            model,
            mass,
            outdoor=data.outdoor[step],
            limits=(data.heating_setpoint[step], data.cooling_setpoint[step]),
            window=shades.window[state, step],
            internal=data.internal[step] + shades.lighting[state, step],
            hours=data.step_hours,
        )
        found = {"zone temperature": air, "heating load": heat, "cooling load": cold}
        value = float(found[quantity])
    return states


def cooling_season(
    heating: Float[np.ndarray, " time"],
    cooling: Float[np.ndarray, " time"],
    *,
    step_hours: float = 1.0,
) -> Bool[np.ndarray, " time"]:
    """Return whether the zone was cooled more than heated in the seven days before.

    The time before the first step is that at the end of the series.

    >>> load = np.repeat([0.0, 100.0], 24 * 30)
    >>> cooling_season(100 - load, load)[[0, 24 * 29, 24 * 34]].tolist()
    [True, False, True]
    """
    count = round(24 * _SEASON_DAYS / step_hours)
    balance = cooling - heating
    before = np.concatenate([balance[-count:], balance])
    sums = np.cumsum(np.insert(before, 0, 0.0))
    return np.asarray((sums[count:] - sums[:-count])[: len(balance)] > 0)


def seasonal_states(
    shades: ShadeCosts,
    lux: Float[np.ndarray, "state time"],
    *,
    cooled: Bool[np.ndarray, " time"],
    target_lux: float,
) -> Int[np.ndarray, " time"]:
    """Return states that block the sun in the cooling season unless occupied and dark.

    In the cooling season, the state of least gain; while occupied, the one of least
    gain whose illuminance reaches the target, or of most illuminance if none does. At
    other times, the state of greatest gain. While occupied, only states within the
    glare limit count, or the state of least excess if there is none.

    >>> gain = np.array([[500.0, 500.0], [100.0, 100.0]])
    >>> none, occupied = np.zeros((2, 2)), np.array([True, False])
    >>> shades = ShadeCosts(gain, none, none, occupied)
    >>> lux, cooled = np.array([[900.0, 900.0], [90.0, 90.0]]), np.array([True, True])
    >>> seasonal_states(shades, lux, cooled=cooled, target_lux=300.0).tolist()
    [0, 1]
    """
    within = (shades.excess <= 0) | ~shades.occupied
    lit = (lux >= target_lux) | ~shades.occupied
    gain = np.where(cooled, shades.window, -shades.window)
    wanted = np.where(cooled, lit, True)
    best = np.where(within & wanted, gain, np.inf).argmin(axis=0)
    brightest = np.where(within, lux, -np.inf).argmax(axis=0)
    found = np.where((within & wanted).any(axis=0), best, brightest)
    least = shades.excess.argmin(axis=0)
    return np.asarray(np.where(within.any(axis=0), found, least))
