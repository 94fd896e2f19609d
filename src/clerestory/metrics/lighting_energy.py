"""Lighting energy of daylight-controlled luminaires.

A photosensor at the work plane controls the luminaires. They are dimmed between minimum
and full output to supplement daylight up to the setpoint, or are switched on if
daylight is below the setpoint. Electric power is a linear function of light output, as
measured for dimmable ballasts (Rubinstein, 1984).
"""

from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from jaxtyping import Bool, Float

from clerestory.checks import not_negative, positive, within

Control = Literal["dimming", "dimming with switch-off", "on-off", "none"]


@final
@dataclass(frozen=True)
class LightingZone:
    """Luminaires controlled by one photosensor.

    Attributes
    ----------
    power : electric power of the luminaires at full output [W]
    full_lux : illuminance at the photosensor from the luminaires at full output [lux]
    setpoint_lux : illuminance to be maintained at the photosensor [lux]
    control : "dimming": dimming down to the minimum output; "dimming with switch-off":
        also off if daylight reaches the setpoint; "on-off": full output or off; "none":
        full output when occupied
    least_output, least_power : minimum light output and corresponding electric power,
        as fractions of full output and full power
    standby : electric power of switched-off luminaires [W]
    """

    power: float
    full_lux: float
    setpoint_lux: float = 500.0
    control: Control = "dimming"
    least_output: float = 0.1
    least_power: float = 0.2
    standby: float = 0.0

    def __post_init__(self) -> None:
        positive(self.power, "power", unit="W")
        positive(self.full_lux, "illuminance at full output", unit="lux")
        positive(self.setpoint_lux, "setpoint", unit="lux")
        not_negative(self.standby, "standby power", unit="W")
        within(self.least_output, "least output", least=0, most=np.nextafter(1, 0))
        within(
            self.least_power, "least power, a fraction of full power,", least=0, most=1
        )


@final
@dataclass(frozen=True, eq=False)
class LightingUse:
    """Light output, electric power [W] and energy [Wh] of the luminaires.

    Light output is a fraction of full output; `illuminance` [lux] includes daylight.
    """

    output: Float[np.ndarray, " time"]
    power: Float[np.ndarray, " time"]
    illuminance: Float[np.ndarray, " time"]
    energy: float


def lighting_use(
    zone: LightingZone,
    daylight: Float[np.ndarray, " time"],
    occupied: Bool[np.ndarray, " time"],
    *,
    step_hours: float = 1.0,
) -> LightingUse:
    """Return light output, electric power and energy of the luminaires of a zone.

    Daylight illuminance is in lux. The luminaires are off in unoccupied steps. The
    standard error of the energy follows from that of all replicates of the daylight
    (`metrics.replicates`).

    >>> zone = LightingZone(power=100, full_lux=500, least_output=0, least_power=0)
    >>> use = lighting_use(zone, np.array([0.0, 250.0, 900.0]), np.ones(3, bool))
    >>> use.power.tolist(), use.energy
    ([100.0, 50.0, 0.0], 150.0)
    """
    output, power = _output(zone, daylight, occupied)
    illuminance = np.asarray(daylight + output * zone.full_lux)
    energy = float(power.sum() * step_hours)
    return LightingUse(output, power, illuminance, energy)


def lighting_saving(use: LightingUse, reference: LightingUse) -> float:
    """Energy saving of a lighting control, as a fraction of the reference energy."""
    positive(reference.energy, "energy of the reference", unit="Wh")
    return 1 - use.energy / reference.energy


def _output(
    zone: LightingZone,
    daylight: Float[np.ndarray, " time"],
    occupied: Bool[np.ndarray, " time"],
) -> tuple[Float[np.ndarray, " time"], Float[np.ndarray, " time"]]:
    missing = np.clip((zone.setpoint_lux - daylight) / zone.full_lux, 0, 1)
    dimmed = zone.control.startswith("dimming")
    switched = zone.control in ("dimming with switch-off", "on-off")
    output = np.maximum(missing, zone.least_output) if dimmed else np.ones_like(missing)
    lit = occupied & (missing > 0) if switched else occupied
    slope = (1 - zone.least_power) / (1 - zone.least_output)
    power = zone.power * (zone.least_power + slope * (output - zone.least_output))
    return np.where(lit, output, 0.0), np.where(lit, power, zone.standby)
