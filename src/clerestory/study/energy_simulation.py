"""Heating, cooling and lighting energy by EnergyPlus, with a study's shades and lights.

At each time step, the windows of the model have the constructions of their shade states
in the study, and its luminaires the power by which the study dims them. Solar radiation
of windows and rooms is that of EnergyPlus, or that of the study's matrices.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.energyplus.engine_run import Actuator, AnnualRun, Output, simulate
from clerestory.energyplus.scheduled_solar import with_objects
from clerestory.progress import Progress
from clerestory.study.energy_model import EnergyModel
from clerestory.study.energy_results import (
    comfort_results,
    energy_results,
    matrix_solar_results,
    solar_results,
)
from clerestory.study.energy_solar import SolarRadiation, solar_radiation
from clerestory.study.job import Job

# Meters of energy [J] by use
METERS = {
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


def annual_energy(job: Job, model: EnergyModel, data: xr.Dataset) -> xr.Dataset:
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
    states, zones = _states(data), model.zones()
    solar = None
    if model.table.solar == "matrices":
        solar = solar_radiation(job, model, states)
    windows = [window for group in model.windows.values() for window in group]
    outputs = [Output(meter, sum=True) for meter in METERS.values()]
    outputs += [Output(_TEMPERATURE, zone) for zone in zones]
    if solar is None:
        outputs += [Output(part, w.name) for part in _SOLAR.values() for w in windows]
    values = run_building(
        model,
        states,
        _power(data),
        outputs,
        solar=solar,
        progress=job.display("EnergyPlus"),
    )
    hours = 1 / model.steps_per_hour
    energy, temperature, rest = np.split(
        values, [len(METERS), len(METERS) + len(zones)]
    )
    if solar is None:
        parts = rest.reshape(len(_SOLAR), len(windows), -1)
        parts[0] *= np.array([window.area for window in windows])[:, None]
        sun = solar_results(list(_SOLAR), parts, [w.name for w in windows], hours)
    else:
        sun = matrix_solar_results(solar, hours)
    occupied = data["occupied"].values
    low, high = model.table.comfort_c
    return xr.merge(
        [
            energy_results(list(METERS), energy / JOULES_PER_KWH, hours),
            comfort_results(temperature, zones, occupied, hours, (low, high)),
            sun,
        ]
    )


def run_building(
    model: EnergyModel,
    states: States,
    power: Power,
    outputs: Sequence[Output],
    *,
    solar: SolarRadiation | None = None,
    progress: Progress | None = None,
) -> Float[np.ndarray, "output time"]:
    """Simulate the model of a study, and return outputs at the study's time steps.

    Parameters
    ----------
    states : shade state of each window group at each time step
    power : power of the luminaires of each lighting zone [W]; luminaires of other zones
        are operated by the model
    solar : solar radiation of windows and surfaces; default: that of EnergyPlus
    """
    actuators = [*_shades(model, states), *_lights(model, power)]
    objects: Mapping[str, Mapping[str, object]] = model.building.objects
    if solar is not None:
        actuators += solar.actuators
        objects = with_objects(objects, solar.objects)
    job = AnnualRun(
        objects,
        model.weather,
        actuators,
        outputs,
        model.steps_per_hour,
        source=str(model.table.model),
    )
    return simulate(job, progress=progress)[:, model.step]


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
        if table.zone in power:
            name, _ = model.building.find(table.lights, "Lights")
            values = model.over_year(power[table.zone])
            yield Actuator("Lights", "Electricity Rate", name, values)
