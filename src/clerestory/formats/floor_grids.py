"""Sensor grids above the floors of those rooms of a model that have none."""

from dataclasses import dataclass
from typing import final

import numpy as np

from clerestory.formats.building_model import BuildingModel, GridLabel, unique_name
from clerestory.scene.polygon_grid import polygon_grid
from clerestory.scene.sensors import Sensors

_UP = np.array([0.0, 0.0, 1.0])


@final
@dataclass(frozen=True, eq=False)
class FloorGrids:
    """Grids and their labels by name, and descriptions of the rooms without floor."""

    grids: dict[str, Sensors]
    labels: dict[str, GridLabel]
    omitted: tuple[str, ...]


def floor_grids(model: BuildingModel, *, spacing: float, height: float) -> FloorGrids:
    """Return a grid above the floor of each room without sensors.

    A room has sensors if a grid of the model refers to it or lies in it. `spacing` and
    `height` above the floor are in metres.
    """
    grids: dict[str, Sensors] = {}
    labels: dict[str, GridLabel] = {}
    omitted = []
    served = {label.room for label in model.labels.values()}
    for room in model.rooms:
        inner = (room.contains(sensors.position) for sensors in model.grids.values())
        if room.identifier in served or any(inner):
            continue
        points = polygon_grid(room.outlines, spacing=spacing, height=height)
        if not len(points):
            omitted.append(
                f'a grid for room "{room.name}": it has no floor of any area'
            )
            continue
        name = unique_name(room.name, {**model.grids, **grids})
        grids[name] = Sensors(points, np.tile(_UP, (len(points), 1)))
        labels[name] = GridLabel(room.identifier, room.identifier)
    return FloorGrids(grids, labels, tuple(omitted))
