"""Metrics of a recipe for viewers of VTK: the model, and the cells of its grids."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from clerestory.files import read_text
from clerestory.image.colour_scale import ColourScale
from clerestory.recipes.model import RecipeModel
from clerestory.scene.sensor_cells import sensor_faces
from clerestory.scene.tessellate import meshes
from clerestory.study.drawing import room_drawing
from clerestory.study.model_import import window_panes
from clerestory.study.vtkjs import (
    Surfaces,
    pane_surfaces,
    room_surfaces,
    write_vtkjs,
)

# Percentages that are not shares of the whole
_SMALL = "Daylight factor [%]"

# Scene that recipes write into their folder
VISUALIZATION = "visualization.vtkjs"


def write_visualization(
    folder: Path, chosen: RecipeModel, shown: Mapping[str, str]
) -> None:
    """Write the metrics of a folder of results, and the model, as a .vtkjs file.

    `shown` are the folders of the metrics, by label: a file for each grid, with a value
    for each sensor.
    """
    found = {
        label: _values(folder / place, chosen)
        for label, place in shown.items()
        if (folder / place).is_dir()
    }
    grids = []
    for name, record in chosen.records.items():
        sensors = chosen.model.grids[name]
        corners = sensor_faces(sensors.position, sensors.direction)
        values = {label: metric[record.full_id] for label, metric in found.items()}
        grids.append(Surfaces(f"grid {record.full_id}", corners, values))
    scales = {label: _scale(label, metric) for label, metric in found.items()}
    write_vtkjs(folder / VISUALIZATION, [*grids, *_building(chosen)], scales=scales)


def _values(folder: Path, chosen: RecipeModel) -> dict[str, np.ndarray]:
    found = {}
    for record in chosen.grids:
        place = folder / record.full_id
        [path] = [
            each
            for each in place.parent.iterdir()
            if each.stem == place.name and each.suffix != ".json"
        ]
        found[record.full_id] = np.array(read_text(path).split(), dtype=float)
    return found


def _scale(label: str, metric: Mapping[str, np.ndarray]) -> ColourScale:
    # Percentages up to 100, other values up to their maximum
    most = max(float(values.max()) for values in metric.values())
    share = label.endswith("[%]") and label != _SMALL
    top = 100.0 if share else max(most, 1e-9)
    return ColourScale(0.0, top, (0.0, top), palette="viridis")


def _building(chosen: RecipeModel) -> list[Surfaces]:
    panes = [
        pane_surfaces("windows", mesh.vertices[mesh.faces])
        for mesh in meshes(window_panes(chosen.model))
    ]
    drawn = room_drawing(chosen.model.scene)
    if not drawn:
        return panes
    corners, colours, names = (
        drawn[name].values
        for name in ("triangle", "triangle_colour", "triangle_material")
    )
    return [*panes, *room_surfaces(corners, colours, [str(name) for name in names])]
