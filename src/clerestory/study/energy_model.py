"""Model of EnergyPlus for a study: reading, and a check that both fit."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Int

from clerestory.checks import require
from clerestory.energyplus.building_model import (
    BuildingModel,
    ModelWindow,
    read_building_model,
)
from clerestory.energyplus.engine_run import HOURS
from clerestory.errors import ClerestoryWarning
from clerestory.scene.window import Window
from clerestory.study.config import Study
from clerestory.study.energy_tables import EnergyTable
from clerestory.study.inputs import Inputs

# Differences of area and orientation of a window group that cause a warning
_AREA, _ANGLE_DEG = 0.05, 10.0


@dataclass(frozen=True, eq=False)
class EnergyModel:
    """Model of EnergyPlus that fits a study, and the study's table about it.

    `windows` are the windows of the model by window group; `step` is the number of each
    time step of the study within the year.
    """

    table: EnergyTable
    building: BuildingModel
    windows: Mapping[str, Sequence[ModelWindow]]
    weather: Path
    step: Int[np.ndarray, " time"]
    steps_per_hour: int

    def zones(self) -> list[str]:
        """Names of the zones that have windows of the study."""
        windows = [window for group in self.windows.values() for window in group]
        return list(dict.fromkeys(window.zone for window in windows))

    def over_year(self, values: np.ndarray) -> np.ndarray:
        """Return values of the study's time steps in the order of the year."""
        year = np.empty(HOURS * self.steps_per_hour, values.dtype)
        year[self.step] = values
        return year


def energy_model(study: Study, inputs: Inputs) -> EnergyModel | None:
    """Return the model that a study names, if any, after a check that both fit.

    Raises
    ------
    InputError : the model has no such objects, the study lacks hours of the year, or
        EnergyPlus is not installed
    """
    table = study.energy
    if table is None:
        return None
    weather = table.weather or study.weather.file
    require(
        weather is not None and weather.suffix.lower() == ".epw",
        "[energy] without an EPW file; the key weather of [energy], or an EPW file of"
        " [weather], expected",
    )
    assert weather is not None
    step, per_hour = _steps(inputs)
    building = read_building_model(table.model)
    groups = {group.name: group for group in inputs.groups}
    windows = {
        each.name: _windows(building, each.surfaces, groups[each.name].outer, study)
        for each in table.window
    }
    known = {name.casefold() for name in building.constructions()}
    for each in table.window:
        states = len(groups[each.name].states)
        require(
            len(each.constructions) == states,
            f'{len(each.constructions)} constructions of window "{each.name}"; one for'
            f" each of its {states} states expected",
        )
        for name in each.constructions:
            message = f'no construction "{name}"; {table.model.name} has '
            listed = ", ".join(sorted(building.constructions())[:8]) or "none"
            require(name.casefold() in known, message + listed, file=table.model)
    for lights in table.lights:
        building.find(lights.lights, "Lights")
    return EnergyModel(table, building, windows, weather, step, per_hour)


def _windows(
    building: BuildingModel, names: Sequence[str], own: Window, study: Study
) -> list[ModelWindow]:
    # Windows of the model; a warning if area or orientation are not those of the study
    found = [building.window(name) for name in names]
    area = sum(window.area for window in found)
    if abs(area / own.area - 1) > _AREA:
        _warn(study, own, f"an area of {own.area:.3g} m², in the model {area:.3g} m²")
    turn = np.radians(study.sky.rotation_deg)
    x, y, z = -own.frame.normal
    outward = np.array(
        [
            x * np.cos(turn) + y * np.sin(turn),
            y * np.cos(turn) - x * np.sin(turn),
            z,
        ]
    )
    for window in found:
        cosine = float(np.clip(window.normal @ outward, -1, 1))
        apart = float(np.degrees(np.arccos(cosine)))
        if apart > _ANGLE_DEG:
            _warn(study, own, f"an orientation {apart:.0f}° from that of {window.name}")
    return found


def _warn(study: Study, own: Window, words: str) -> None:
    assert study.energy is not None
    warnings.warn(
        f'{study.energy.model.name}: window "{own.name}" has {words}',
        ClerestoryWarning,
        stacklevel=4,
    )


def _steps(inputs: Inputs) -> tuple[Int[np.ndarray, " time"], int]:
    # Number of each time step of the weather in a year of 365 days
    weather = inputs.weather
    per_hour = round(60 / weather.step_minutes)
    times = weather.times.astype("datetime64[s]")
    year = times.astype("datetime64[Y]")
    days = (times.astype("datetime64[D]") - year.astype("datetime64[D]")).astype(int)
    leap = ((year + 1).astype("datetime64[D]") - year.astype("datetime64[D]")).astype(
        int
    ) == 366
    days -= leap & (days >= 59)
    seconds = (times - times.astype("datetime64[D]")).astype(int)
    step = days * 24 * per_hour + seconds * per_hour // 3600
    count = len(np.unique(step))
    require(
        count == len(step) == HOURS * per_hour,
        f"[energy] with weather of {count} time steps; the {HOURS * per_hour} of a year"
        " expected",
    )
    return step, per_hour
