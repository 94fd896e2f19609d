"""Shade control rules: shade state of each window group at each time step.

Rules based on interior illuminance or glare are evaluated group by group, in the order
of the study file. Window groups evaluated before are in their chosen shade states,
groups evaluated later are closed, so that limits on illuminance or DGP can be met.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.control.bright_period import bright_states
from clerestory.control.control_rule import Situation, apply_rule, load_rule
from clerestory.control.profile_angle import blocking_states
from clerestory.control.schedule import states_at
from clerestory.control.season import SEASONS, season_numbers
from clerestory.control.state_choice import Limit, best_states, least_closed
from clerestory.control.threshold import staged_states, threshold_states
from clerestory.errors import InputError
from clerestory.glare.dgp import simplified_dgp
from clerestory.metrics.melanopic import MELANOPIC_LUX
from clerestory.study.control_case import Case, StateTimes

DGP_BELOW = 0.40


def fixed(case: Case) -> StateTimes:
    """Return the shade state of rule "fixed", the same at all time steps."""
    group = case.signals.inputs.groups[case.number]
    return np.full(len(case.signals.times), group.number_of(case.control.state))


def cut_off(case: Case) -> StateTimes:
    """Return the shade state of the most open slat tilt that blocks direct sun."""
    control = case.control
    profile = case.signals.profile(case.number, vertical=control.vertical)
    slats = [tilt for tilt in control.tilts_deg if tilt != "raised"]
    found = blocking_states(
        profile,
        tilts=np.radians(slats),
        width=control.slat_width or 0.0,
        spacing=control.slat_spacing or 0.0,
    )
    sunny = _sunny(case) & np.isfinite(profile)
    return np.where(sunny, found + len(control.tilts_deg) - len(slats), 0)


def by_profile(case: Case) -> StateTimes:
    """Return the count of `angles_deg` above the solar profile angle as shade state."""
    angle = case.signals.profile(case.number, vertical=case.control.vertical)
    if case.control.vertical:
        angle = np.abs(angle)
    below = [angle < np.radians(limit) for limit in case.control.angles_deg]
    return np.where(_sunny(case), np.sum(below, axis=0), 0)


def by_threshold(case: Case) -> StateTimes:
    """Return shade states by thresholds of one quantity, with hysteresis and delays."""
    control = case.control
    quantity = _quantity(case)
    delays = {
        "close_after": delay_steps(case, control.close_after),
        "open_after": delay_steps(case, control.open_after),
    }
    low = control.open_below
    if len(control.close_above) == 1:
        closed = threshold_states(
            quantity,
            close_above=control.close_above[0],
            open_below=low[0] if low else None,
            **delays,
        )
        return closed * (case.count - 1)
    return staged_states(
        quantity,
        close_above=np.array(control.close_above),
        open_below=np.array(low) if low else None,
        **delays,
    )


def by_glare(case: Case) -> StateTimes:
    """Return the most open shade state with DGP below the limit."""
    bound = case.control.dgp_below or DGP_BELOW
    if case.control.grid:
        dgp = glare_of_eyes(case, case.control.grid)
    else:
        dgp = glare_by_state(case, until=bound)
    return least_closed([Limit(dgp, bound)])


def by_score(case: Case) -> StateTimes:
    """Return the shade state of highest mean min(illuminance, target) within limits."""
    control = case.control
    target = control.target_lux or case.signals.study.metrics.target_lux
    lux = case.illuminance(control.grid)
    score = np.stack([np.minimum(each, target).mean(axis=0) for each in lux])
    limits = []
    if control.lux_below is not None:
        most = np.stack([each.max(axis=0) for each in lux])
        limits.append(Limit(most, control.lux_below))
    if control.dgp_below is not None:
        limits.append(Limit(glare_by_state(case), control.dgp_below))
    return best_states(score, limits)


def by_bright_period(case: Case) -> StateTimes:
    """Return the states that give melanopic light for four hours by noon."""
    control, signals = case.control, case.signals
    edi = np.stack([each.mean(axis=0) for each in case.melanopic_edi(control.grid)])
    group = signals.inputs.groups[case.number]
    rest = np.full(len(signals.times), group.number_of(control.state))
    limits = []
    if control.dgp_below is not None:
        limits.append(Limit(glare_by_state(case), control.dgp_below))
        rest = least_closed(limits, at_least=rest)
    return bright_states(
        edi,
        signals.times,
        target=control.target_lux or MELANOPIC_LUX,
        afterwards=rest,
        limits=limits,
        step_hours=signals.step_minutes / 60,
    )


def by_schedule(case: Case) -> StateTimes:
    """Return the shade states of a schedule file; a line applies until the next one."""
    group = case.signals.inputs.groups[case.number]
    return states_at(group.schedule(), case.signals.times)[group.name]


def by_season(case: Case) -> StateTimes:
    """Return the shade state of rule "season": one in each season."""
    group = case.signals.inputs.groups[case.number]
    states = [group.number_of(getattr(case.control, season)) for season in SEASONS]
    latitude = case.signals.inputs.weather.latitude_deg
    season = season_numbers(case.signals.times, latitude_deg=latitude)
    return np.asarray(np.array(states)[season])


def by_function(case: Case) -> StateTimes:
    """Return the shade states chosen by a user-defined function."""
    file, function = case.control.function.rsplit(":", 1)
    rule = load_rule(case.signals.study.folder / file, function)
    try:
        return apply_rule(rule, situation(case))
    except InputError:
        raise
    except Exception as error:  # any exception of the user-defined function
        reason = " ".join(str(error).split())[:200]
        raise InputError(
            f'rule "{function}" ended with {type(error).__name__}: {reason}', file=file
        ) from error


def situation(case: Case) -> Situation:
    """Return the inputs of a user-defined function."""
    signals, number = case.signals, case.number
    weather = signals.inputs.weather
    return Situation(
        signals.times,
        case.count,
        signals.occupied,
        {
            "irradiance": signals.irradiance(number),
            "illuminance": signals.facade_illuminance(number),
            "direct irradiance": signals.direct_irradiance(number),
            "direct normal": weather.direct_normal,
            "diffuse horizontal": weather.diffuse_horizontal,
            "profile": signals.profile(number),
            "altitude": np.arcsin(np.clip(signals.sun[:, 2], -1, 1)),
        },
        _wanted(case),
    )


def _wanted(case: Case) -> dict[str, Float[np.ndarray, "state time"]]:
    # DGP, mean illuminance and melanopic EDI of each grid, by state, if in `needs`
    found, needs = {}, case.control.needs
    if "illuminance" in needs:
        for grid in case.signals.inputs.grids:
            lux = case.illuminance(grid)
            found[f"illuminance {grid}"] = np.stack([e.mean(axis=0) for e in lux])
    if "melanopic EDI" in needs:
        for grid in case.signals.inputs.grids:
            edi = case.melanopic_edi(grid)
            found[f"melanopic EDI {grid}"] = np.stack([e.mean(axis=0) for e in edi])
    if "glare" in needs:
        found["dgp"] = glare_by_state(case)
    return found


# Rules by name: on exterior quantities, and on interior illuminance or glare
OUTSIDE: dict[str, Callable[[Case], StateTimes]] = {
    "fixed": fixed,
    "cut-off": cut_off,
    "profile angle": by_profile,
    "threshold": by_threshold,
    "season": by_season,
    "schedule": by_schedule,
}
INSIDE: dict[str, Callable[[Case], StateTimes]] = {
    "glare": by_glare,
    "best": by_score,
    "melanopic": by_bright_period,
    "python": by_function,
}


def _sunny(case: Case) -> np.ndarray:
    direct = case.signals.direct_irradiance(case.number)
    return np.asarray(direct > case.control.sun_above)


def delay_steps(case: Case, minutes: float) -> int:
    """Return a delay in time steps, at least one."""
    return max(1, int(np.ceil(minutes / case.signals.step_minutes - 1e-9)))


def _quantity(case: Case) -> Float[np.ndarray, " time"]:
    signals, number = case.signals, case.number
    weather = signals.inputs.weather
    match case.control.quantity:
        case "facade irradiance":
            return signals.irradiance(number)
        case "facade illuminance":
            return signals.facade_illuminance(number)
        case "facade direct irradiance":
            return signals.direct_irradiance(number)
        case "direct normal":
            return weather.direct_normal
        case "diffuse horizontal":
            return weather.diffuse_horizontal
        case "global horizontal":
            level = weather.direct_normal * np.maximum(signals.sun[:, 2], 0)
            return np.asarray(weather.diffuse_horizontal + level)
        case "outdoor temperature":
            require(
                signals.building is not None,
                'quantity "outdoor temperature" without [energy]; a model expected',
            )
            assert signals.building is not None
            return signals.building.outdoor
        case "illuminance":
            opened = [np.zeros_like(state) for state in case.others]
            lux = signals.illuminance(opened, case.control.grid)
            return np.asarray(lux.mean(axis=0))
        case "melanopic EDI":
            opened = [np.zeros_like(state) for state in case.others]
            edi = signals.melanopic_edi(opened, case.control.grid)
            return np.asarray(edi.mean(axis=0))
        case _:
            raise AssertionError


def glare_of_eyes(case: Case, grid: str) -> Float[np.ndarray, "state time"]:
    """Simplified DGP of each shade state, at the brightest eye of a grid."""
    lux = case.illuminance(grid)
    return np.stack([simplified_dgp(each.max(axis=0)) for each in lux])


def glare_by_state(
    case: Case, *, until: float = -np.inf
) -> Float[np.ndarray, "state time"]:
    """DGP of each shade state; infinite if a more open state has DGP ≤ `until`."""
    steps, enough = np.arange(len(case.signals.times)), max(until, 0) or np.inf
    glare = np.full((case.count, len(steps)), np.inf)

    def dgp(state: int, enough: float) -> np.ndarray:
        states, control = case.with_state(state), case.control
        return case.signals.dgp(states, steps, control, enough=enough)

    for state in range(case.count):
        if len(steps):
            found = glare[state, steps] = dgp(state, enough)
            steps = steps[found > until]
    # Where no state has DGP ≤ `until`, the lowest counts, not a lower limit of it
    limited = np.isfinite(enough) and case.signals.looks_at_grids(case.control)
    if limited and len(steps):
        for state in range(case.count):
            glare[state, steps] = dgp(state, np.inf)
    return glare
