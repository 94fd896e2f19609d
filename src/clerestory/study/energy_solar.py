"""Solar radiation of the windows of a model, from the matrices of a study.

Reflected, absorbed and transmitted radiation follow from the solar properties of the
constructions by incident patch. The radiation that the zone returns is absorbed by the
layers from indoors, transmitted outwards, or reflected.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.checks import require
from clerestory.control.schedule import select_states
from clerestory.energyplus.building_model import ModelWindow
from clerestory.energyplus.complex_optics import ComplexOptics, complex_optics
from clerestory.energyplus.engine_run import Actuator
from clerestory.energyplus.scheduled_solar import (
    layer_radiation,
    surface_radiation,
)
from clerestory.energyplus.zone_enclosure import (
    Objects,
    black_inside,
    inside_surfaces,
    other_windows,
)
from clerestory.errors import ClerestoryWarning
from clerestory.phases.methods import METHODS
from clerestory.study.energy_model import EnergyModel
from clerestory.study.job import Job
from clerestory.study.solar_at_windows import IncidentRadiation, incident_radiation
from clerestory.study.solar_in_zones import ZoneTransfer, zone_transfer

# Difference of the energy balance that causes a warning
_BALANCE = 0.005

# Parts of the solar radiation on a window [W/m²]
PARTS = ("incident", "reflected", "absorbed", "transmitted", "returned")


@dataclass(frozen=True, eq=False)
class WindowRadiation:
    """Solar radiation of one window over time [W/m²].

    Attributes
    ----------
    window : window of the model
    parts : incident radiation; reflected at the outdoor side; absorbed by all layers;
        transmitted into the room; returned to outdoors by the room
    layers : absorbed radiation of each layer, over (layer, time)
    balance : incident − (reflected + absorbed + transmitted), for light from outdoors,
        relative to incident; NaN without reflectance of the BSDF
    """

    window: ModelWindow
    parts: Mapping[str, Float[np.ndarray, " time"]]
    layers: Float[np.ndarray, "layer time"]
    balance: Float[np.ndarray, " time"]

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class SolarRadiation:
    """Solar radiation of all windows and zones of a model, and EnergyPlus' input.

    `closure` is the radiation absorbed in each zone per radiation of its windows,
    before the scaling of view matrices; `objects` and `actuators` set the radiation of
    the model.
    """

    windows: Sequence[WindowRadiation]
    closure: Mapping[str, float]
    objects: Sequence[Objects]
    actuators: Sequence[Actuator]

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class _Pane:
    # Window, number of its group, solar properties of its states, shade states over
    # time, and incident radiation
    window: ModelWindow
    number: int
    optics: Sequence[ComplexOptics]
    state: Int[np.ndarray, " time"]
    incident: IncidentRadiation

    def by_state(
        self, rows: Sequence[Float[np.ndarray, "row patch"]]
    ) -> Float[np.ndarray, "row time"]:
        """Product with the radiation, by matrices of the state at each time step."""
        found = np.zeros((len(rows[0]), len(self.state)))
        for number, matrix in enumerate(rows):
            steps = np.flatnonzero(self.state == number)
            found[:, steps] = matrix @ self.incident.patches[:, steps]
        return found


def solar_radiation(
    job: Job, model: EnergyModel, states: Mapping[str, Int[np.ndarray, " time"]]
) -> SolarRadiation:
    """Return the solar radiation of windows, layers and inside surfaces over time.

    Parameters
    ----------
    states : shade state of each window group at each time step

    Raises
    ------
    InputError : a window has other constructions than complex fenestration states, its
        zone has other windows, or the method of the study has no daylight matrices
    """
    panes = _panes(job, model, states)
    zones = list(dict.fromkeys(pane.window.zone for pane in panes))
    windows, objects, actuators, closure = [], [], [], {}
    for zone in zones:
        own = [pane for pane in panes if pane.window.zone == zone]
        transfer = _transfer(job, model, own, zone)
        closure[zone] = float(transfer.closure.mean())
        walls, received = _inside(own, transfer)
        for surface, values in zip(transfer.surfaces, walls, strict=True):
            black = black_inside(model.building, surface)
            name = surface.scheduled if black else surface.construction
            absorbed = model.over_year(surface.absorptance * values)
            added, actuator = surface_radiation(surface.name, name, absorbed)
            objects += [black, added]
            actuators.append(actuator)
        for pane, back in zip(own, received, strict=True):
            found = _radiation(job, pane, back)
            windows.append(found)
            counts = {one.name: len(one.front) for one in pane.optics}
            layers = np.stack([model.over_year(row) for row in found.layers])
            added, more = layer_radiation(pane.window.name, counts, layers)
            objects.append(added)
            actuators.extend(more)
    return SolarRadiation(windows, closure, objects, actuators)


def _panes(
    job: Job, model: EnergyModel, states: Mapping[str, Int[np.ndarray, " time"]]
) -> list[_Pane]:
    numbers = {group.name: n for n, group in enumerate(job.inputs.groups)}
    method = METHODS[job.study.method]
    require(
        method.windows and not method.facade,
        f'[energy] solar = "matrices" with method "{job.study.method}"; "3-phase" or'
        ' "5-phase" expected',
    )
    panes = []
    for table in model.table.window:
        number = numbers[table.name]
        optics = [complex_optics(model.building, c) for c in table.constructions]
        require(
            len({len(one.partition) for one in optics}) == 1,
            f'constructions of window "{table.name}" on different Klems bases; one'
            " basis expected",
            file=model.table.model,
        )
        incident = incident_radiation(job, number, optics[0].partition)
        panes += [
            _Pane(window, number, optics, states[table.name], incident)
            for window in model.windows[table.name]
        ]
    return panes


def _transfer(
    job: Job, model: EnergyModel, panes: Sequence[_Pane], zone: str
) -> ZoneTransfer:
    surfaces = inside_surfaces(model.building, zone)
    known = [pane.window.name for pane in panes]
    others = other_windows(model.building, surfaces, known)
    message = f'zone "{zone}" has windows without [[energy.window]]: '
    require(
        not others,
        f'{message}{", ".join(others[:4])}; all expected for solar = "matrices"',
        file=model.table.model,
    )
    windows = [(pane.window, pane.optics[0].partition) for pane in panes]
    return zone_transfer(job, surfaces, windows, zone=zone)


def _inside(
    panes: Sequence[_Pane], transfer: ZoneTransfer
) -> tuple[Float[np.ndarray, "surface time"], Float[np.ndarray, "window time"]]:
    radiance = [pane.by_state([o.transmission for o in pane.optics]) for pane in panes]
    reflectance = np.stack(
        [
            np.array([one.diffuse_back()[0] for one in pane.optics])[pane.state]
            for pane in panes
        ]
    )
    return transfer.irradiance(radiance, reflectance)


def _radiation(
    job: Job, pane: _Pane, received: Float[np.ndarray, " time"]
) -> WindowRadiation:
    # Radiation of a window; `received` is the irradiance of its indoor side
    incident = pane.incident.irradiance
    transmitted = pane.by_state([one.transmittance[None] for one in pane.optics])[0]
    most = max(len(one.front) for one in pane.optics)
    layers = pane.by_state([_padded(one.front, most) for one in pane.optics])
    through = incident - transmitted - layers.sum(axis=0)
    states = job.inputs.groups[pane.number].states
    rows = [
        _reflectance(state.fine, one)
        for state, one in zip(states, pane.optics, strict=True)
    ]
    known = [row for row in rows if row is not None]
    reflected, balance = through, np.full_like(incident, np.nan)
    if len(known) == len(rows):
        reflected = (
            pane.by_state([row[None] for row in known])[0] + pane.incident.grazing
        )
        lit = incident > 0
        balance[lit] = (through - reflected)[lit] / incident[lit]
        _check_balance(job, pane, balance[lit])

    # Radiation that the room returns
    figures = [one.diffuse_back() for one in pane.optics]
    back = np.stack([_padded(absorbed[:, None], most)[:, 0] for _, absorbed in figures])
    back_layers = select_states(
        np.repeat(back[:, :, None], len(incident), 2), pane.state
    )
    back_layers = back_layers * received
    reflects = np.array([share for share, _ in figures])[pane.state]
    layers = layers + back_layers
    parts = {
        "incident": incident,
        "reflected": reflected,
        "absorbed": layers.sum(axis=0),
        "transmitted": transmitted,
        "returned": received * (1 - reflects) - back_layers.sum(axis=0),
    }
    return WindowRadiation(pane.window, parts, layers, balance)


def _check_balance(job: Job, pane: _Pane, balance: Float[np.ndarray, " step"]) -> None:
    worst = float(np.abs(balance).max(initial=0.0))
    if worst > _BALANCE:
        group = job.inputs.groups[pane.number].name
        warnings.warn(
            f'window "{group}": reflected, absorbed and transmitted solar radiation'
            f" differ from the incident one by up to {100 * worst:.2g} %; the same"
            " layers in the BSDFs of its states and in the constructions of"
            f' "{pane.window.name}" expected',
            ClerestoryWarning,
            stacklevel=2,
        )


def _padded(rows: np.ndarray, count: int) -> np.ndarray:
    # Rows of zeros for layers that other states have
    return np.pad(rows, ((0, count - len(rows)), (0, 0)))


def _reflectance(bsdf: Bsdf, optics: ComplexOptics) -> np.ndarray | None:
    # Solar reflectance of the study's BSDF by incident patch of the construction
    if ("solar", "reflection_front") not in bsdf.functions:
        return None
    found = bsdf.direct_hemispherical("reflection_front", channel="solar")
    return found if len(found) == len(optics.partition) else None
