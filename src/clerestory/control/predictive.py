"""Predictive control of shades: least energy over the coming hours, without glare.

At each time step, dynamic programming finds the states of the coming hours that cost
least: heating, cooling and electric light, movements, and the view. The temperature of
the mass of a zone model is the state of the system, on a grid with linear
interpolation. Only the first state is used, then the horizon recedes (model predictive
control).

Reference: R. Bellman, Dynamic Programming, 1957.
"""

from dataclasses import dataclass, field
from typing import final

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Values
from clerestory.brief_repr import brief
from clerestory.checks import has_shape, not_negative, positive, require
from clerestory.control.zone_model import ZoneData, ZoneModel, zone_step

# Temperatures of the mass on the grid, and margin beyond the setpoints [K]
_NODES, _MARGIN = 32, 6.0

# Cost of one unit of excess over a limit; larger than any energy of an hour [kWh]
_EXCESS = 1e4

# Starts that are planned together
_TOGETHER = 1095


@final
@dataclass(frozen=True)
class Weights:
    """Costs of predictive control, in units of energy [kWh].

    Attributes
    ----------
    heating, cooling, lighting : factor of each energy
    movement : cost of one change of the state
    view : cost of one occupied hour in the most closed state; proportional between
    """

    heating: float = 1.0
    cooling: float = 1.0
    lighting: float = 1.0
    movement: float = 0.0
    view: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            not_negative(value, f"weight of {name}")


@final
@dataclass(frozen=True)
class Forecast:
    """Horizon of the forecast [h], and its standard errors.

    Errors grow with the root of the time ahead, up to `temperature_error` [K] and
    `gain_error` (relative, of the gain through windows) at the horizon, as those of a
    random walk; both 0: the coming weather is known. `seed` is that of the errors.
    """

    horizon: float = 24.0
    temperature_error: float = 0.0
    gain_error: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        positive(self.horizon, "horizon", unit="h")
        not_negative(self.temperature_error, "error of the temperature", unit="K")
        not_negative(self.gain_error, "error of the gain")


@final
@dataclass(frozen=True, eq=False)
class ShadeCosts:
    """Consequences of each shade state over time.

    Attributes
    ----------
    window : net gain through the windows [W]
    lighting : power of the luminaires [W]
    excess : relative excess of glare over its limit, at most 0 within it
    occupied : whether the zone is occupied at each time step
    """

    window: Float[np.ndarray, "state time"]
    lighting: Float[np.ndarray, "state time"]
    excess: Float[np.ndarray, "state time"]
    occupied: Bool[np.ndarray, " time"]

    __repr__ = brief

    def __post_init__(self) -> None:
        for name in ("lighting", "excess"):
            has_shape(getattr(self, name), self.window.shape, name)
        has_shape(self.occupied, self.window.shape[1:], "occupied")


def predictive_states(
    model: ZoneModel,
    data: ZoneData,
    shades: ShadeCosts,
    *,
    weights: Weights = Weights(),
    forecast: Forecast = Forecast(),
) -> Int[np.ndarray, " time"]:
    """Return the shade states of predictive control.

    Glare counts in occupied time steps; if every state exceeds the limit, the one of
    least excess is chosen.

    Examples
    --------
    A warm zone in the evening sun, with a blind that halves the gain:

    >>> model = ZoneModel(20.0, 0.0, 400.0, 3000.0, 0.3, 0.5)
    >>> hours = np.ones(24)
    >>> data = ZoneData(25 * hours, 20 * hours, 25 * hours, 0 * hours)
    >>> sun = np.where(np.arange(24) > 15, 1000.0, 0.0)
    >>> shades = ShadeCosts(np.stack([sun, sun / 2]), np.zeros((2, 24)),
    ...                     np.zeros((2, 24)), hours > 0)
    >>> predictive_states(model, data, shades)[16:20].tolist()
    [1, 1, 1, 1]
    """
    steps = len(data.outdoor)
    require(
        shades.window.shape[1] == steps,
        f"{shades.window.shape[1]} time steps of the shades; {steps} expected",
    )
    plan = _Plan(model, data, shades, weights, forecast)
    states = np.empty(steps, dtype=int)
    mass, before = float(data.heating_setpoint[0] + data.cooling_setpoint[0]) / 2, -1
    for begin in range(0, steps, _TOGETHER):
        starts = np.arange(begin, min(begin + _TOGETHER, steps))
        costs = plan.costs(starts)
        for step, cost in zip(starts.tolist(), costs, strict=True):
            place, low = plan.place(np.array(mass))
            total = cost[low] + place * (cost[low + 1] - cost[low])
            if before >= 0:
                moved = np.arange(len(total)) != before
                total = total + weights.movement * moved
            before = states[step] = int(total.argmin())
            *_, mass = plan.step(mass, step, before)
    return states


@dataclass(frozen=True, eq=False)
class _Plan:
    # Costs of the states by dynamic programming, for many starts at once
    model: ZoneModel
    data: ZoneData
    shades: ShadeCosts
    weights: Weights
    forecast: Forecast
    nodes: Values = field(init=False)
    fixed: Float[np.ndarray, "state time"] = field(init=False)

    def __post_init__(self) -> None:
        low = self.data.heating_setpoint.min() - _MARGIN
        high = self.data.cooling_setpoint.max() + _MARGIN
        object.__setattr__(self, "nodes", np.linspace(low, high, _NODES))
        object.__setattr__(self, "fixed", self._fixed_costs())

    def _fixed_costs(self) -> Float[np.ndarray, "state time"]:
        # Costs that do not depend on temperature [kWh]
        shades, hours = self.shades, self.data.step_hours
        closed = np.arange(len(shades.window))[:, None] / max(1, len(shades.window) - 1)
        light = self.weights.lighting * shades.lighting / 1000 * hours
        view = self.weights.view * hours * closed * shades.occupied
        excess = np.maximum(shades.excess, 0) * shades.occupied
        return np.asarray(light + view + _EXCESS * excess)

    def place(self, mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the place between two nodes (0…1), and the index of the lower one."""
        width = self.nodes[1] - self.nodes[0]
        where = np.clip((mass - self.nodes[0]) / width, 0, _NODES - 1.000001)
        low = where.astype(int)
        return where - low, low

    def step(
        self, mass: float, at: int, state: int
    ) -> tuple[float, float, float, float]:
        """Return air temperature, loads, and the mass temperature after a step."""
        found = zone_step(
            self.model,
            mass,
            outdoor=self.data.outdoor[at],
            limits=(self.data.heating_setpoint[at], self.data.cooling_setpoint[at]),
            window=self.shades.window[state, at],
            internal=self.data.internal[at] + self.shades.lighting[state, at],
            hours=self.data.step_hours,
        )
        air, heat, cold, after = map(float, found)
        return air, heat, cold, after

    def costs(
        self, starts: Int[np.ndarray, " start"]
    ) -> Float[np.ndarray, "start node state"]:
        """Return the cost of each state at each start, and of the best later ones."""
        count, states = len(self.data.outdoor), len(self.shades.window)
        ahead = max(1, round(self.forecast.horizon / self.data.step_hours))
        errors = self._errors(starts, ahead)
        after = np.zeros((len(starts), _NODES, states))
        lanes = np.arange(len(starts))[:, None, None]
        every = np.arange(states)
        for lead in range(ahead - 1, -1, -1):
            at = np.minimum(starts + lead, count - 1)
            warmer, more = errors[:, lead, :, None, None].transpose(1, 0, 2, 3)
            limits = (
                self.data.heating_setpoint[at][:, None, None],
                self.data.cooling_setpoint[at][:, None, None],
            )
            light = self.shades.lighting[:, at].T[:, None, :]
            _, heat, cold, mass = zone_step(
                self.model,
                self.nodes[:, None],
                outdoor=self.data.outdoor[at][:, None, None] + warmer,
                limits=limits,
                window=self.shades.window[:, at].T[:, None, :] * more,
                internal=self.data.internal[at][:, None, None] + light,
                hours=self.data.step_hours,
            )
            energy = self.weights.heating * heat + self.weights.cooling * cold
            spent = energy * (self.data.step_hours / 1000)
            place, low = self.place(mass)
            # Cost after the step, with the next state free at the cost of a movement
            free = after.min(axis=2, keepdims=True) + self.weights.movement
            best = np.minimum(after, free)
            below, above = best[lanes, low, every], best[lanes, low + 1, every]
            fixed = self.fixed[:, at].T[:, None, :]
            inside = (starts + lead < count)[:, None, None]
            spent = spent + fixed + below + place * (above - below)
            after = np.where(inside, spent, 0.0)
        return after

    def _errors(
        self, starts: Int[np.ndarray, " start"], ahead: int
    ) -> Float[np.ndarray, "start lead two"]:
        # Error of the temperature [K] and factor of the gains, for each start and lead
        found = np.zeros((len(starts), ahead, 2))
        sizes = self.forecast.temperature_error, self.forecast.gain_error
        if any(sizes):
            random = np.random.default_rng([self.forecast.seed, int(starts[0])])
            walk = random.standard_normal((len(starts), ahead - 1, 2)).cumsum(axis=1)
            found[:, 1:] = walk / np.sqrt(max(1, ahead - 1)) * np.array(sizes)
        found[..., 1] = np.maximum(1 + found[..., 1], 0)
        return found
