"""Resistance-capacitance model of a zone with heating and cooling, and its fit.

Two nodes: air without capacity, and building mass. With outdoor temperature θ_e, gains
Φ_a and Φ_m of air and mass, and the conductances H,

    0        = H_ea (θ_e − θ_a) + H_am (θ_m − θ_a) + Φ_a + Φ_hc
    C dθ_m/dt = H_am (θ_a − θ_m) + H_em (θ_e − θ_m) + Φ_m.

Heating and cooling Φ_hc keep the air between two setpoints, as in the simple hourly
method of ISO 13790:2008, 7.2.2, which has one node more. Parameters are fitted to
simulated temperatures and loads by least squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from clerestory.array_types import Series, Values
from clerestory.brief_repr import brief
from clerestory.checks import has_shape, positive, require

# Periods of the fit, and time before each that is simulated without being compared [h]
_PERIOD, _WARM_UP = 336.0, 48.0

# Temperature difference that counts as much as the mean load [K]
_DEGREES = 1.0


@final
@dataclass(frozen=True)
class ZoneModel:
    """Conductances and capacity of a zone.

    Attributes
    ----------
    air_outdoors, mass_outdoors, air_mass : conductances H_ea, H_em and H_am [W/K]
    capacity : heat capacity of the mass [Wh/K]
    window_to_air, internal_to_air : share of the gains of windows and of people,
        equipment and luminaires that heats the air; the rest heats the mass
    constant : constant gain of the mass, such as from the ground [W]
    """

    air_outdoors: float
    mass_outdoors: float
    air_mass: float
    capacity: float
    window_to_air: float
    internal_to_air: float
    constant: float = 0.0


@final
@dataclass(frozen=True, eq=False)
class ZoneData:
    """Conditions of a zone over time; gains are in watts, temperatures in °C.

    `heating_setpoint` and `cooling_setpoint` limit the air temperature; `internal` are
    gains of people and equipment, `step_hours` is the length of a time step.
    """

    outdoor: Float[np.ndarray, "*lane time"]
    heating_setpoint: Float[np.ndarray, "*lane time"]
    cooling_setpoint: Float[np.ndarray, "*lane time"]
    internal: Float[np.ndarray, "*lane time"]
    step_hours: float = 1.0

    __repr__ = brief

    def __post_init__(self) -> None:
        positive(self.step_hours, "length of a time step", unit="h")
        for name in ("heating_setpoint", "cooling_setpoint", "internal"):
            has_shape(getattr(self, name), self.outdoor.shape, name)

    def select(self, steps: Any) -> "ZoneData":
        """Return the conditions of selected time steps."""
        names = ("outdoor", "heating_setpoint", "cooling_setpoint", "internal")
        return replace(self, **{name: getattr(self, name)[steps] for name in names})


@final
@dataclass(frozen=True, eq=False)
class ZoneRun:
    """Simulated air temperature [°C] and loads [W] of a zone, such as of EnergyPlus.

    `window` is the net gain through windows, `lighting` that of luminaires [W].
    """

    window: Series
    lighting: Series
    air: Series
    heating: Series
    cooling: Series

    __repr__ = brief


# Air temperature, heating and cooling [W], and mass temperature after the step
_Step = tuple[Any, Any, Any, Any]


def zone_step(
    model: ZoneModel,
    mass: Any,
    *,
    outdoor: Any,
    limits: tuple[Any, Any],
    window: Any,
    internal: Any,
    hours: float,
) -> _Step:
    """Return air temperature, heating, cooling, and mass temperature after a time step.

    All quantities are numbers, or arrays that broadcast.

    >>> model = ZoneModel(50.0, 0.0, 500.0, 5000.0, 0.5, 0.5)
    >>> step = zone_step(model, 20.0, outdoor=0.0, limits=(20.0, 26.0), window=0.0,
    ...                  internal=0.0, hours=1.0)
    >>> [round(float(x), 6) for x in step]  # 50 W/K times 20 K
    [20.0, 1000.0, 0.0, 20.0]
    """
    to_air = model.window_to_air * window + model.internal_to_air * internal
    to_mass = window + internal - to_air + model.constant
    whole = model.air_outdoors + model.air_mass
    free = (model.air_outdoors * outdoor + model.air_mass * mass + to_air) / whole
    air = np.clip(free, *limits)
    load = whole * (air - free)
    loss = model.air_mass + model.mass_outdoors
    level = (model.air_mass * air + model.mass_outdoors * outdoor + to_mass) / loss
    kept = np.exp(-hours * loss / model.capacity)
    after = level + (mass - level) * kept
    return air, np.maximum(load, 0), np.maximum(-load, 0), after


def simulate_zone(
    model: ZoneModel,
    data: ZoneData,
    window: Float[np.ndarray, "*lane time"],
    lighting: Float[np.ndarray, "*lane time"],
    *,
    start: float | Values | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return air temperature [°C], heating and cooling load [W] over time.

    Parameters
    ----------
    window, lighting : gains of windows and luminaires [W], of one or several cases
    start : temperature of the mass at the beginning; default: the heating setpoint
    """
    mass = data.heating_setpoint[..., 0] if start is None else start
    found = np.empty((3, *window.shape))
    for step in range(window.shape[-1]):
        *outputs, mass = zone_step(
            model,
            mass,
            outdoor=data.outdoor[..., step],
            limits=(
                data.heating_setpoint[..., step],
                data.cooling_setpoint[..., step],
            ),
            window=window[..., step],
            internal=data.internal[..., step] + lighting[..., step],
            hours=data.step_hours,
        )
        for row, values in zip(found, outputs, strict=True):
            row[..., step] = values
    return found[0], found[1], found[2]


@final
@dataclass(frozen=True, eq=False)
class ZoneFit:
    """Fitted model of a zone, with its errors against the simulated year.

    Attributes
    ----------
    model : fitted parameters
    temperature_error : root mean square error of the air temperature [K]
    load_error : root mean square error of heating less cooling, relative to its root
        mean square
    energy_error : largest relative error of the sum of heating and cooling in the year
    """

    model: ZoneModel
    temperature_error: float
    load_error: float
    energy_error: float


def fit_zone(data: ZoneData, runs: Sequence[ZoneRun]) -> ZoneFit:
    """Fit a zone model to simulated years by least squares.

    Periods of two weeks of all runs are simulated together, each after two days whose
    results are not compared. The mass begins at the temperature that balances the air.

    Parameters
    ----------
    data : conditions that all runs have in common
    runs : simulated temperatures and loads, such as with different shade states

    Raises
    ------
    InputError : no run, or less than three weeks of data
    """
    require(runs, "no simulated run of the zone; one or more expected")
    hours = data.step_hours
    length, before = (round(h / hours) for h in (_PERIOD, _WARM_UP))
    count = (len(data.outdoor) - before) // length
    require(count > 0, "less than 16 days of a zone's data; a longer run expected")
    starts = np.arange(count) * length
    index = starts[:, None] + np.arange(before + length)

    def lanes(name: str) -> np.ndarray:
        return np.stack([getattr(run, name)[index] for run in runs])

    window, lighting, air = lanes("window"), lanes("lighting"), lanes("air")
    load = lanes("heating") - lanes("cooling")
    scale = max(float(np.abs(load).mean()), 1.0)
    part = data.select(index)

    def residuals(vector: np.ndarray) -> np.ndarray:
        zone = _model(vector)
        begin = _mass(zone, part, window, lighting, air=air, load=load)
        found, heat, cold = simulate_zone(zone, part, window, lighting, start=begin)
        apart = [(found - air) / _DEGREES, (heat - cold - load) / scale]
        return np.concatenate([each[..., before:].ravel() for each in apart])

    span = float(np.ptp(data.outdoor)) or 1.0
    size = float(np.abs(load).max()) / span + 1.0
    first = np.array([*np.log([size, size / 10, 5 * size, 50 * size]), 0.0, 0.0, 0.0])
    best = least_squares(residuals, first, max_nfev=60)
    model = _model(best.x)
    return ZoneFit(model, *_errors(model, data, runs))


def _model(vector: Values) -> ZoneModel:
    # Positive parameters by their logarithms, shares by the logistic function
    conductances = np.exp(np.clip(vector[:4], -10, 25))
    shares = 1 / (1 + np.exp(-np.clip(vector[4:6], -30, 30)))
    return ZoneModel(*map(float, (*conductances, *shares, 100 * vector[6])))


def _mass(
    model: ZoneModel,
    data: ZoneData,
    window: Float[np.ndarray, "*lane time"],
    lighting: Float[np.ndarray, "*lane time"],
    *,
    air: Float[np.ndarray, "*lane time"],
    load: Float[np.ndarray, "*lane time"],
) -> np.ndarray:
    # Temperature of the mass at the first step, from the balance of the air
    internal = data.internal[..., 0] + lighting[..., 0]
    gains = model.window_to_air * window[..., 0] + model.internal_to_air * internal
    outdoors = model.air_outdoors * (data.outdoor[..., 0] - air[..., 0])
    return np.asarray(air[..., 0] - (outdoors + gains + load[..., 0]) / model.air_mass)


def _errors(
    model: ZoneModel, data: ZoneData, runs: Sequence[ZoneRun]
) -> tuple[float, float, float]:
    window, lighting, air = (
        np.stack([getattr(run, name) for run in runs])
        for name in ("window", "lighting", "air")
    )
    load = np.stack([run.heating - run.cooling for run in runs])
    start = _mass(model, data, window, lighting, air=air, load=load)
    found, heat, cold = simulate_zone(model, data, window, lighting, start=start)
    apart = np.sqrt(np.mean((found - air) ** 2))
    of_load = np.sqrt(np.mean((heat - cold - load) ** 2) / max(np.mean(load**2), 1e-9))
    year = np.abs(load).sum(axis=1)
    of_year = np.abs((heat + cold).sum(axis=1) / np.maximum(year, 1e-9) - 1).max()
    return float(apart), float(of_load), float(of_year)
