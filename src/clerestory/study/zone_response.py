"""Response of the zones of a model to each shade state, simulated by EnergyPlus.

One year is simulated for each shade state, with that state in all hours and the
luminaires that it requires. The runs give the gains through the windows in every state,
and the loads to which zone models are fitted.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Series
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.control.zone_model import ZoneData, ZoneFit, ZoneRun, fit_zone
from clerestory.energyplus.building_model import ModelWindow
from clerestory.energyplus.engine_run import Output
from clerestory.phases.matrix_equation import States
from clerestory.study.electric_lighting import operate_luminaires
from clerestory.study.energy_model import EnergyModel
from clerestory.study.energy_simulation import JOULES_PER_KWH, METERS, run_building
from clerestory.study.energy_solar import SolarRadiation, solar_radiation
from clerestory.study.job import Job
from clerestory.study.luminaire_matrices import Lamps

_OUTDOOR = Output("Site Outdoor Air Drybulb Temperature", "Environment")

# Variables of a zone
_ZONE = {
    "air": "Zone Mean Air Temperature",
    "heating_setpoint": "Zone Thermostat Heating Setpoint Temperature",
    "cooling_setpoint": "Zone Thermostat Cooling Setpoint Temperature",
    "heating": "Zone Air System Sensible Heating Rate",
    "cooling": "Zone Air System Sensible Cooling Rate",
    "convective": "Zone Total Internal Convective Heating Rate",
    "radiant": "Zone Total Internal Radiant Heating Rate",
    "visible": "Zone Total Internal Visible Radiation Heating Rate",
    "lights": "Zone Lights Total Heating Rate",
}
_WINDOW = {
    "gain": "Surface Window Heat Gain Rate",
    "loss": "Surface Window Heat Loss Rate",
}

# Function of shade states and a grid: illuminance of its sensors [lux]
Illuminance = Callable[[States, str], Float[np.ndarray, "sensor time"]]


@dataclass(frozen=True, eq=False)
class ZoneResponse:
    """Zone of a model: conditions, fitted model, and loads in each shade state.

    `luminaires` are the lighting zones of the study in it, `runs` the simulated
    years, one for each shade state, the most open first.
    """

    name: str
    data: ZoneData
    runs: Sequence[ZoneRun]
    fit: ZoneFit
    luminaires: Sequence[str]

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class BuildingResponse:
    """What control rules may know about the building; computed on demand.

    `illuminance` is the daylight of a grid in given shade states.
    """

    job: Job
    model: EnergyModel
    lamps: Lamps
    occupied: Bool[np.ndarray, " time"]
    illuminance: Illuminance
    _made: list[bool] = field(default_factory=list)

    __repr__ = brief

    def lighting_power(self, states: States) -> dict[str, Series]:
        """Return the power of the luminaires of each lighting zone [W]."""
        grids = [zone.table.grid for zone in self.lamps.zones]
        if not grids:
            return {}
        uses = operate_luminaires(
            self.lamps,
            [self.illuminance(states, grid) for grid in grids],
            rows=[self.job.inputs.rows(grid) for grid in grids],
            occupied=self.occupied,
            step_hours=1 / self.model.steps_per_hour,
        )
        names = [zone.table.label for zone in self.lamps.zones]
        return {name: use.power for name, use in zip(names, uses, strict=True)}

    def results(self) -> xr.Dataset:
        """Return energy in each fixed state, and errors of the zone models."""
        if not self._made:
            return xr.Dataset()
        zones = list(self.zones.values())
        fits = [zone.fit for zone in zones]
        errors = [[f.temperature_error, f.load_error, f.energy_error] for f in fits]
        names = {"zone_model": [zone.name for zone in zones]}
        kinds = {"zone_model_figure": ["temperature [K]", "load", "energy"]}
        uses = {"energy_use": list(METERS)}
        kwh = {"units": "kWh"}
        return xr.Dataset(
            {
                "zone_model_error": (("zone_model", "zone_model_figure"), errors),
                "fixed_state_energy": (
                    ("fixed_state", "energy_use"),
                    np.stack([run.energy for run in self._runs]),
                    kwh,
                ),
            },
            coords=names | kinds | uses,
        )

    @cached_property
    def zones(self) -> dict[str, ZoneResponse]:
        """Zones that have windows of the study, by name."""
        return {name: self._zone(name) for name in self.model.zones()}

    @cached_property
    def outdoor(self) -> Series:
        """Outdoor temperature [°C]."""
        return self._runs[0].outdoor

    def gains(self, group: str, zone: str) -> Float[np.ndarray, "state time"]:
        """Return the net gain through a group's windows in a zone, by state [W]."""
        groups = {each.name: each for each in self.job.inputs.groups}
        names = [w.name for w in self.model.windows.get(group, ()) if w.zone == zone]
        count = len(groups[group].states)
        none = np.zeros((count, len(self.occupied)))
        if not names:
            return none
        rows = [sum(run.windows[n] for n in names) for run in self._runs[:count]]
        return np.stack(rows)

    def _zone(self, name: str) -> ZoneResponse:
        found = [run.zones[name] for run in self._runs]
        first = found[0]
        lights = [
            table.zone
            for table in self.model.table.lights
            if self._place(table.lights).casefold() == name.casefold()
        ]
        internal = first["convective"] + first["radiant"] + first["visible"]
        if lights:
            internal = internal - first["lights"]
        data = ZoneData(
            self.outdoor,
            first["heating_setpoint"],
            first["cooling_setpoint"],
            internal,
            1 / self.model.steps_per_hour,
        )
        windows = [w.name for w in self._windows() if w.zone == name]
        runs = [
            ZoneRun(
                np.sum([run.windows[w] for w in windows], axis=0),
                each["lights"] if lights else np.zeros_like(internal),
                each["air"],
                each["heating"],
                each["cooling"],
            )
            for run, each in zip(self._runs, found, strict=True)
        ]
        return ZoneResponse(name, data, runs, fit_zone(data, runs), lights)

    def _place(self, lights: str) -> str:
        _, found = self.model.building.find(lights, "Lights")
        field = "zone_or_zonelist_or_space_or_spacelist_name"
        return str(found.get(field, ""))

    def _windows(self) -> list[ModelWindow]:
        return [window for group in self.model.windows.values() for window in group]

    @cached_property
    def _runs(self) -> "list[_Run]":
        # One year for each state; groups with fewer states have their last one
        counts = [len(group.states) for group in self.job.inputs.groups]
        steps = len(self.occupied)
        fixed = [
            [np.full(steps, min(state, count - 1)) for count in counts]
            for state in range(max(counts))
        ]
        prepared = [
            (states, self.lighting_power(states), self._solar(states))
            for states in fixed
        ]
        workers = max(1, min(len(fixed), os.cpu_count() or 1))
        with ThreadPoolExecutor(workers) as pool:
            runs = [
                pool.submit(self._run, number, *each)
                for number, each in enumerate(prepared)
            ]
            found = [run.result() for run in runs]
        self._made.append(True)
        return found

    def _solar(self, states: States) -> SolarRadiation | None:
        if self.model.table.solar != "matrices":
            return None
        return solar_radiation(self.job, self.model, self._named(states))

    def _named(self, states: States) -> dict[str, Int[np.ndarray, " time"]]:
        names = [group.name for group in self.job.inputs.groups]
        return dict(zip(names, states, strict=True))

    def _run(
        self,
        number: int,
        states: States,
        power: Mapping[str, Series],
        solar: SolarRadiation | None,
    ) -> "_Run":
        zones, windows = self.model.zones(), self._windows()
        outputs = [_OUTDOOR, *(Output(meter, sum=True) for meter in METERS.values())]
        outputs += [Output(name, zone) for zone in zones for name in _ZONE.values()]
        outputs += [Output(n, w.name) for w in windows for n in _WINDOW.values()]
        values = run_building(
            self.model,
            self._named(states),
            power,
            outputs,
            solar=solar,
            progress=self.job.display(f"EnergyPlus, shade state {number}"),
        )
        first = 1 + len(METERS)
        middle = first + len(zones) * len(_ZONE)
        require(
            bool(np.isfinite(values[[0, *range(first, len(values))]]).all()),
            "EnergyPlus gives no temperatures or loads in some hours; a model with"
            " thermostats and ideal or other air systems, and a run period of a year,"
            " expected for rules that know the zone",
            file=self.model.table.model,
        )
        of_zones = values[first:middle].reshape(len(zones), len(_ZONE), -1)
        of_windows = values[middle:].reshape(len(windows), 2, -1)
        net = {
            w.name: gain - loss
            for w, (gain, loss) in zip(windows, of_windows, strict=True)
        }
        for each in solar.windows if solar else ():
            inward = each.parts["transmitted"] - each.parts["returned"]
            net[each.window.name] = net[each.window.name] + inward * each.window.area
        return _Run(
            values[0],
            np.nansum(values[1:first], axis=1) / JOULES_PER_KWH,
            {
                zone: dict(zip(_ZONE, rows, strict=True))
                for zone, rows in zip(zones, of_zones, strict=True)
            },
            net,
        )


@dataclass(frozen=True, eq=False)
class _Run:
    # A year in one state: outdoor temperature, energy by use [kWh], variables of zones,
    # and net gains of windows [W]
    outdoor: Series
    energy: Float[np.ndarray, " use"]
    zones: Mapping[str, Mapping[str, Series]]
    windows: Mapping[str, Series]
