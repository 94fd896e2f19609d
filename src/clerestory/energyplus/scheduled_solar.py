"""Solar radiation that EnergyPlus takes from schedules instead of its own calculation.

Objects `SurfaceProperty:SolarIncidentInside` give the radiation on inside surfaces, and
`ComplexFenestrationProperty:SolarAbsorbedLayers` the radiation that layers absorb.
Their schedules are constants that actuators set at each time step (EnergyPlus, *Input
Output Reference*, group "Advanced Construction, Surface, Zone Concepts").
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.energyplus.engine_run import Actuator
from clerestory.energyplus.zone_enclosure import Objects

_SCHEDULE = "Schedule:Constant"
_INSIDE = "SurfaceProperty:SolarIncidentInside"
_LAYERS = "ComplexFenestrationProperty:SolarAbsorbedLayers"


def surface_radiation(
    surface: str, construction: str, values: Float[np.ndarray, " step"]
) -> tuple[Objects, Actuator]:
    """Return objects and actuator of the radiation on an inside surface [W/m²]."""
    schedule = f"Solar on {surface}"
    fields = {
        "surface_name": surface,
        "construction_name": construction,
        "inside_surface_incident_sun_solar_radiation_schedule_name": schedule,
    }
    objects: Objects = {
        _SCHEDULE: {schedule: {"hourly_value": 0.0}},
        _INSIDE: {f"{schedule} inside": fields},
    }
    return objects, _actuator(schedule, values)


def layer_radiation(
    window: str,
    layers: Mapping[str, int],
    values: Float[np.ndarray, "layer step"],
) -> tuple[Objects, list[Actuator]]:
    """Return objects and actuators of the radiation absorbed by layers [W/m²].

    Parameters
    ----------
    layers : number of layers of each construction that the window may have
    values : absorbed radiation of each layer of the construction of the time step
    """
    names = [f"Solar in {window} {number + 1}" for number in range(len(values))]
    schedules: dict[str, Any] = {name: {"hourly_value": 0.0} for name in names}
    absorbed = {}
    for construction, count in layers.items():
        fields = {"fenestration_surface": window, "construction_name": construction}
        for number, name in enumerate(names[:count], 1):
            fields[f"layer_{number}_solar_radiation_absorbed_schedule_name"] = name
        absorbed[f"Solar in {window} {construction}"] = fields
    actuators = [_actuator(name, row) for name, row in zip(names, values, strict=True)]
    return {_SCHEDULE: schedules, _LAYERS: absorbed}, actuators


def with_objects(
    model: Mapping[str, Mapping[str, Any]], added: Sequence[Objects]
) -> Objects:
    """Return a model with further objects."""
    whole: Objects = {kind: dict(members) for kind, members in model.items()}
    kinds = {kind.casefold(): kind for kind in whole}
    for objects in added:
        for kind, members in objects.items():
            known = kinds.setdefault(kind.casefold(), kind)
            whole.setdefault(known, {}).update(members)
    return whole


def _actuator(schedule: str, values: Float[np.ndarray, " step"]) -> Actuator:
    return Actuator(_SCHEDULE, "Schedule Value", schedule, values)
