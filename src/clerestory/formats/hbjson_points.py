"""Sensor grids and views of honeybee models."""

import numpy as np

from clerestory.errors import located
from clerestory.formats.json_item import Item
from clerestory.scene.projection import Kind
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

_VIEWS: dict[str, Kind] = {
    "v": "perspective",
    "h": "hemispherical",
    "l": "parallel",
    "c": "cylindrical",
    "a": "angular",
    "s": "planisphere",
}


def read_grids(radiance: Item, scale: float) -> list[tuple[str, Sensors]]:
    """Return the sensor grids by name, in metres; empty ones are left out."""
    found: list[tuple[str, Sensors]] = []
    for grid in radiance.items("sensor_grids"):
        sensors = list(grid.items("sensors"))
        if not sensors:
            continue
        places = np.array([s.vector("pos") for s in sensors]) * scale
        facing = np.array([s.vector("dir") for s in sensors])
        name = grid.text("display_name", "") or grid.text("identifier")
        found.append((_unique(name, found), _sensors(places, facing, grid)))
    return found


def _sensors(places: np.ndarray, facing: np.ndarray, grid: Item) -> Sensors:
    length = np.linalg.norm(facing, axis=1, keepdims=True)
    if np.any(length == 0):
        raise grid.wrong("sensors", "directions that are not zero")
    return Sensors(places, facing / length)


def read_views(radiance: Item, scale: float) -> list[tuple[str, View]]:
    """Return the views by name, in metres."""
    found: list[tuple[str, View]] = []
    for item in radiance.items("views"):
        kind = _VIEWS.get(item.text("view_type", "v"))
        if kind is None:
            raise item.wrong("view_type", f"one of {', '.join(_VIEWS)}")
        with located(file=item.file, subject=item.where):
            view = View(
                kind=kind,
                position=item.vector("position") * scale,
                direction=item.vector("direction"),
                up=item.vector("up_vector", (0.0, 0.0, 1.0)),
                horizontal=item.number("h_size", 60.0),
                vertical=item.number("v_size", 60.0),
                shift=item.number("shift", 0.0),
                lift=item.number("lift", 0.0),
            )
        name = item.text("display_name", "") or item.text("identifier")
        found.append((_unique(name, found), view))
    return found


def _unique(
    name: str, found: list[tuple[str, Sensors]] | list[tuple[str, View]]
) -> str:
    plain = "".join(c if c.isalnum() or c in " .-_" else "-" for c in name) or "grid"
    taken, number, label = {one for one, _ in found}, 1, plain
    while label in taken:
        number += 1
        label = f"{plain} {number}"
    return label
