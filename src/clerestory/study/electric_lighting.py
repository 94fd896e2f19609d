"""Dimming level, illuminance and energy use of the luminaires of a study."""

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int

from clerestory.checks import require
from clerestory.metrics.lighting_energy import LightingUse, LightingZone, lighting_use
from clerestory.metrics.replicates import hourly_replicates, metric_components
from clerestory.study.lighting_tables import LightingTable
from clerestory.study.luminaire_matrices import Lamps, Zone

# Number of fixed-point iterations for lighting zones that illuminate each other
_ROUNDS = 8


def lighting(
    lamps: Lamps,
    hourly: xr.Dataset,
    *,
    rows: Sequence[Int[np.ndarray, " sensor"]],
    occupied: Bool[np.ndarray, " time"],
    step_hours: float,
) -> xr.Dataset:
    """Return dimming level, illuminance and power of the luminaires over time.

    Photosensors of dimmed zones measure daylight and the light of other zones,
    photosensors of switched zones ("on-off") measure daylight only. `rows` has the
    indices of the sensors whose illuminance controls each zone.
    """
    if not lamps.zones:
        return xr.Dataset()
    operate = partial(
        operate_luminaires, lamps, rows=rows, occupied=occupied, step_hours=step_hours
    )
    uses = operate([hourly["illuminance"][chosen].values for chosen in rows])

    # Operate the luminaires for all replicates of the daylight at their photosensors
    read = [hourly.isel(sensor=chosen).load() for chosen in rows]
    varied = zip(*map(hourly_replicates, read), strict=True)
    energies = [
        [use.energy for use in operate([lux.values for lux in daylight])]
        for daylight in varied
    ]
    return _dataset(lamps, uses, np.array(energies).reshape(-1, len(uses)))


def operate_luminaires(
    lamps: Lamps,
    daylight: Sequence[Float[np.ndarray, "_ time"]],
    *,
    rows: Sequence[Int[np.ndarray, " sensor"]],
    occupied: Bool[np.ndarray, " time"],
    step_hours: float,
) -> list[LightingUse]:
    """Return the use of the luminaires of each zone for daylight at its sensors."""
    full, uses = lamps.illuminance, list[LightingUse]()
    output = np.zeros((len(lamps.zones), len(occupied)))
    for _ in range(1 if len(lamps.zones) == 1 else _ROUNDS):
        uses = []
        for number, (zone, lux) in enumerate(zip(lamps.zones, daylight, strict=True)):
            others = np.delete(np.arange(len(lamps.zones)), number)
            seen, chosen = lux.astype(float), rows[number]
            if zone.table.control != "on-off":
                seen = seen + full[np.ix_(others, chosen)].T @ output[others]
            own = full[number, chosen]
            use = lighting_use(
                _governed(zone, own),
                _reading(zone.table, seen, own),
                occupied,
                step_hours=step_hours,
            )
            output[number] = use.output
            uses.append(use)
    return uses


def _governed(zone: Zone, full: np.ndarray) -> LightingZone:
    table = zone.table
    require(
        len(full) and full.min() > 0,
        f'the luminaires of lighting "{table.label}" do not illuminate all sensors of'
        f' grid "{table.grid}"; light at each sensor expected',
    )
    return LightingZone(
        power=zone.power,
        full_lux=float(full.mean()),
        setpoint_lux=table.setpoint_lux,
        control=table.control,
        least_output=table.least_output,
        least_power=table.least_power,
        standby=table.standby,
    )


def _reading(
    table: LightingTable, seen: Float[np.ndarray, "sensor time"], full: np.ndarray
) -> Float[np.ndarray, " time"]:
    # Photosensor reading [lux]: mean illuminance of the sensors, or the reading at
    # which the sensor with the largest deficit reaches the setpoint illuminance
    if table.reading == "mean":
        return np.asarray(seen.mean(axis=0))
    missing = ((table.setpoint_lux - seen) / full[:, None]).max(axis=0)
    return np.asarray(table.setpoint_lux - full.mean() * missing)


def _dataset(
    lamps: Lamps, uses: Sequence[LightingUse], varied: Float[np.ndarray, "_ zone"]
) -> xr.Dataset:
    units = {"units": "lux"}
    axes, output = ("zone", "time"), np.stack([use.output for use in uses])
    lux = (lamps.illuminance.T @ output).astype(np.float32)
    power = np.stack([use.power for use in uses]).astype(np.float32)
    energy = np.array([use.energy for use in uses])
    parts = metric_components(energy, list(varied))
    names = np.array([zone.table.label for zone in lamps.zones], dtype=str)
    melanopic = {}
    if lamps.melanopic is not None:
        edi = (lamps.melanopic.T @ output).astype(np.float32)
        melanopic = {"electric_melanopic_edi": (("sensor", "time"), edi, units)}
    return xr.Dataset(
        {
            **melanopic,
            "electric_illuminance": (("sensor", "time"), lux, units),
            "dimming": (axes, output.astype(np.float32), {"units": "1"}),
            "lighting_power": (axes, power, {"units": "W"}),
            "lighting_energy": ("zone", energy, {"units": "Wh"}),
            "lighting_energy_error": (
                "zone",
                np.linalg.norm(parts, axis=0),
                {"units": "Wh"},
            ),
            "lighting_energy_components": (
                ("replicate", "zone"),
                parts,
                {"units": "Wh"},
            ),
        },
        coords={"zone": names},
    )
