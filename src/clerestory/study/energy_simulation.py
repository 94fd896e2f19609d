"""Heating, cooling and lighting energy by EnergyPlus, with a study's shades and lights.

At each time step, the windows of the model have the constructions of their shade states
in the study, and its luminaires the power by which the study dims them.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int

from clerestory.energyplus.engine_run import Actuator, AnnualRun, Output, simulate
from clerestory.progress import Progress
from clerestory.study.energy_model import EnergyModel

# Meters of energy [J] by use
_METERS = {
    "heating": "Heating:EnergyTransfer",
    "cooling": "Cooling:EnergyTransfer",
    "lighting": "InteriorLights:Electricity",
    "equipment": "InteriorEquipment:Electricity",
}

# Solar radiation of a window [W], by part: variables of EnergyPlus
_SOLAR = {
    "incident": "Surface Outside Face Incident Solar Radiation Rate per Area",
    "transmitted": "Surface Window Transmitted Solar Radiation Rate",
    "absorbed": "Surface Window Total Glazing Layers Absorbed Shortwave Radiation Rate",
}
_TEMPERATURE = "Zone Operative Temperature"

JOULES_PER_KWH = 3.6e6

States = Mapping[str, Int[np.ndarray, " time"]]
Power = Mapping[str, Float[np.ndarray, " time"]]


def annual_energy(
    model: EnergyModel, data: xr.Dataset, progress: Progress | None = None
) -> xr.Dataset:
    """Simulate the year with the shade states and dimmed luminaires of a study.

    Parameters
    ----------
    data : results of the study, with `state`, `lighting_power` and `occupied` over time

    Returns
    -------
    `energy` (energy_use, time) [kWh], `operative_temperature` (thermal_zone, time) [°C]
    and `window_solar` (solar_part, energy_window, time) [W], with their sums over the
    year, peaks and hours out of comfort

    Raises
    ------
    InputError : EnergyPlus refuses the model; the message is its own
    """
    windows = [window for group in model.windows.values() for window in group]
    zones = list(dict.fromkeys(window.zone for window in windows))
    outputs = [Output(meter, sum=True) for meter in _METERS.values()]
    outputs += [Output(_TEMPERATURE, zone) for zone in zones]
    outputs += [Output(part, w.name) for part in _SOLAR.values() for w in windows]
    job = AnnualRun(
        model.building.objects,
        model.weather,
        [*_shades(model, _states(data)), *_lights(model, _power(data))],
        outputs,
        model.steps_per_hour,
        source=str(model.table.model),
    )
    values = simulate(job, progress=progress)[:, model.step]
    energy, rest = np.split(values, [len(_METERS)])
    temperature, solar = np.split(rest, [len(zones)])
    solar = solar.reshape(len(_SOLAR), len(windows), -1)
    solar[0] *= np.array([window.area for window in windows])[:, None]
    hours = 1 / model.steps_per_hour
    low, high = model.table.comfort_c
    return xr.merge(
        [
            _energy(energy / JOULES_PER_KWH, hours),
            _comfort(temperature, zones, data["occupied"].values, hours, (low, high)),
            _sun(solar, [window.name for window in windows], hours),
        ]
    )


def _states(data: xr.Dataset) -> States:
    # State of each window group over time; windows with one state have no table
    names = data["window"].values.tolist() if "window" in data.coords else []
    none = np.zeros((len(names), data.sizes["time"]), int)
    found = data["state"].values.astype(int) if "state" in data else none
    return dict(zip(names, found, strict=True))


def _power(data: xr.Dataset) -> Power:
    if "lighting_power" not in data:
        return {}
    names = data["zone"].values.tolist()
    return dict(zip(names, data["lighting_power"].values.astype(float), strict=True))


def _shades(model: EnergyModel, states: States) -> Iterator[Actuator]:
    for table in model.table.window:
        for window in model.windows[table.name]:
            yield Actuator(
                "Surface",
                "Construction State",
                window.name,
                model.over_year(states[table.name]),
                table.constructions,
            )


def _lights(model: EnergyModel, power: Power) -> Iterator[Actuator]:
    for table in model.table.lights:
        name, _ = model.building.find(table.lights, "Lights")
        values = model.over_year(power[table.zone])
        yield Actuator("Lights", "Electricity Rate", name, values)


def _energy(energy: Float[np.ndarray, "use time"], hours: float) -> xr.Dataset:
    axes = "energy_use", "time"
    return xr.Dataset(
        {
            "energy": (axes, energy.astype(np.float32), {"units": "kWh"}),
            "annual_energy": (axes[0], np.nansum(energy, axis=1), {"units": "kWh"}),
            "peak_power": (axes[0], _largest(energy) / hours, {"units": "kW"}),
        },
        coords={axes[0]: list(_METERS)},
    )


def _comfort(
    temperature: Float[np.ndarray, "zone time"],
    zones: Sequence[str],
    occupied: Bool[np.ndarray, " time"],
    hours: float,
    limits: tuple[float, float],
) -> xr.Dataset:
    outside = (temperature < limits[0]) | (temperature > limits[1])
    spent = (outside & occupied).sum(axis=1) * hours
    axes, values = ("thermal_zone", "time"), temperature.astype(np.float32)
    return xr.Dataset(
        {
            "operative_temperature": (axes, values, {"units": "degree_Celsius"}),
            "hours_out_of_comfort": (
                axes[0],
                spent,
                {"units": "h", "comfort_c": list(limits)},
            ),
        },
        coords={axes[0]: np.array(zones, dtype=str)},
    )


def _sun(
    solar: Float[np.ndarray, "part window time"], windows: Sequence[str], hours: float
) -> xr.Dataset:
    axes = "solar_part", "energy_window", "time"
    kwh = np.nansum(solar, axis=2) * hours / 1000
    return xr.Dataset(
        {
            "window_solar": (axes, solar.astype(np.float32), {"units": "W"}),
            "annual_window_solar": (axes[:2], kwh, {"units": "kWh"}),
        },
        coords={axes[0]: list(_SOLAR), axes[1]: np.array(windows, dtype=str)},
    )


def _largest(energy: Float[np.ndarray, "use time"]) -> Float[np.ndarray, " use"]:
    # Largest value over time; NaN for outputs that the model does not have
    known = ~np.isnan(energy).all(axis=1)
    found = np.full(len(energy), np.nan)
    found[known] = np.nanmax(energy[known], axis=1)
    return found
