"""Outlines, sensor grids and views of honeybee models."""

import numpy as np
from jaxtyping import Float

from clerestory.errors import located
from clerestory.formats.json_item import Item
from clerestory.scene.projection import LETTERS
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import area_vector
from clerestory.scene.view import View


def read_grids(radiance: Item, scale: float) -> list[tuple[str, Sensors]]:
    """Return the sensor grids by name, in metres; empty grids are omitted."""
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
        kind = LETTERS.get(item.text("view_type", "v"))
        if kind is None:
            raise item.wrong("view_type", f"one of {', '.join(LETTERS)}")
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


def seamed(
    loops: list[Float[np.ndarray, "_ 3"]],
) -> Float[np.ndarray, "point 3"]:
    """Return one outline with holes, connected by seams to the first corner.

    Holes have the opposite orientation, so that the signed area is correct too.
    """
    first = loops[0]
    outward = area_vector(first)
    outline = [first]
    for hole in loops[1:]:
        turned = hole[::-1] if area_vector(hole) @ outward > 0 else hole
        outline += [first[:1], turned, turned[:1]]
    return np.concatenate(outline)


def plane_of(outline: Float[np.ndarray, "point 3"]) -> tuple[float, ...]:
    """Return normal and distance from the origin [m] of a plane, rounded."""
    normal = area_vector(outline)
    normal /= max(float(np.linalg.norm(normal)), 1e-12)
    distance = float(normal @ outline.mean(axis=0))
    return (*(round(float(x), 3) + 0.0 for x in normal), round(distance, 2) + 0.0)
