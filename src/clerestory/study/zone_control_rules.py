"""Shade control rules that know the zones of a model of EnergyPlus."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.control.predictive import (
    Forecast,
    ShadeCosts,
    Weights,
    predictive_states,
)
from clerestory.control.zone_rules import (
    cooling_season,
    seasonal_states,
    zone_threshold_states,
)
from clerestory.study.control_case import Case
from clerestory.study.control_rules import (
    DGP_BELOW,
    delay_steps,
    glare_by_state,
    glare_of_eyes,
)
from clerestory.study.zone_response import BuildingResponse, ZoneResponse

_StateTimes = Int[np.ndarray, " time"]


@dataclass(frozen=True, eq=False)
class _ZoneCase:
    # Zone of the windows of a group, and consequences of the group's states
    building: BuildingResponse
    zone: ZoneResponse
    shades: ShadeCosts

    __repr__ = brief


def by_season(case: Case) -> _StateTimes:
    """Return states that block the sun when cooling, unless occupied and dark."""
    found, control = _zone_case(case), case.control
    first = found.zone.runs[0]
    hours = found.zone.data.step_hours
    if control.season_above is None:
        cooled = cooling_season(first.heating, first.cooling, step_hours=hours)
    else:
        cooled = _running_mean(found.building.outdoor, hours) > control.season_above
    lux = np.stack([e.mean(axis=0) for e in case.illuminance(control.grid)])
    target = control.target_lux or case.signals.study.metrics.target_lux
    return seasonal_states(found.shades, lux, cooled=cooled, target_lux=target)


def by_prediction(case: Case) -> _StateTimes:
    """Return states of least energy over the coming hours within the glare limit."""
    found, control = _zone_case(case), case.control
    weights = Weights(
        heating=control.heating_weight,
        cooling=control.cooling_weight,
        lighting=control.lighting_weight,
        movement=control.movement_cost,
        view=control.view_cost,
    )
    forecast = Forecast(
        control.horizon,
        control.temperature_error,
        control.gain_error,
        seed=case.signals.study.trace.seed,
    )
    zone = found.zone
    return predictive_states(
        zone.fit.model, zone.data, found.shades, weights=weights, forecast=forecast
    )


def by_zone_threshold(case: Case) -> _StateTimes:
    """Return states by thresholds of the temperature or a load of the zone."""
    found, control = _zone_case(case), case.control
    quantity: Any = control.quantity
    return zone_threshold_states(
        found.zone.fit.model,
        found.zone.data,
        found.shades,
        quantity=quantity,
        close_above=np.array(control.close_above),
        open_below=np.array(control.open_below) if control.open_below else None,
        close_after=delay_steps(case, control.close_after),
        open_after=delay_steps(case, control.open_after),
    )


# Rules by name, and quantities of the rule "threshold" that belong to zones
ZONES: dict[str, Callable[[Case], _StateTimes]] = {
    "cooling season": by_season,
    "predictive": by_prediction,
}
ZONE_QUANTITIES = ("zone temperature", "heating load", "cooling load")


def _zone_case(case: Case) -> _ZoneCase:
    building, groups = case.signals.building, case.signals.inputs.groups
    group = groups[case.number]
    rule = f'rule "{case.control.rule}" of window "{group.name}"'
    require(building is not None, f"{rule} without [energy]; a model expected")
    assert building is not None
    zones = {w.zone for w in building.model.windows.get(group.name, ())}
    require(
        len(zones) == 1,
        f"{rule}: its windows are in {len(zones)} zones of the model; one expected",
    )
    zone = building.zones[zones.pop()]

    # Gains of this group in each state, and of the other groups in theirs
    gains = building.gains(group.name, zone.name)
    for number, other in enumerate(groups):
        if number != case.number:
            states, steps = case.others[number], np.arange(gains.shape[1])
            gains = gains + building.gains(other.name, zone.name)[states, steps]
    power = [building.lighting_power(case.with_state(s)) for s in range(case.count)]
    none = np.zeros(gains.shape[1])
    lighting = np.stack([sum((p[n] for n in zone.luminaires), none) for p in power])
    shades = ShadeCosts(gains, lighting, _excess(case), case.signals.occupied)
    return _ZoneCase(building, zone, shades)


def _excess(case: Case) -> Float[np.ndarray, "state time"]:
    # Relative excess of DGP over its limit; none without views and eyes
    control, study = case.control, case.signals.study
    bound = control.dgp_below or DGP_BELOW
    if control.eye_grid:
        return glare_of_eyes(case, control.eye_grid) / bound - 1
    if control.rule != "threshold" and (study.view or study.view_grid):
        return glare_by_state(case) / bound - 1
    return np.full((case.count, len(case.signals.times)), -1.0)


def _running_mean(
    values: Float[np.ndarray, " time"], hours: float
) -> Float[np.ndarray, " time"]:
    # Mean of the seven days before each step
    count = round(7 * 24 / hours)
    sums = np.cumsum(np.concatenate([[0.0], values[-count:], values]))
    return np.asarray((sums[count:] - sums[:-count])[: len(values)] / count)
