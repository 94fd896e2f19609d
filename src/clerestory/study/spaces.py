"""Spaces of a study: the sensors, windows, openings and views that belong to each.

Without tables [[space]] every grid that faces up is a space. Windows and openings
belong to the space of the nearest sensor in front of them, views to that of the nearest
sensor unless the table names them, as do the positions of view grids.
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from scipy.spatial import cKDTree

from clerestory.checks import require
from clerestory.metrics.procedure import cell_area
from clerestory.scene.inside import inside_polygon
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import Polygon
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.results import VIEWS

# Least upward component of the direction of sensors that face up
_UP = 0.7


def label_spaces(study: Study, inputs: Inputs, openings: xr.Dataset) -> xr.Dataset:
    """Return the space of each sensor, window, opening and view, and floor areas [m²].

    `openings` are results of `sunlight`; a space is "" if there is none.
    """
    owner = sensor_spaces(study, inputs)
    position = inputs.sensors().position
    found = xr.Dataset(
        {
            "space": ("sensor", owner.astype(str)),
            "floor_area": ("sensor", _areas(study, owner, position), {"units": "m2"}),
        }
    )
    inside = owner != ""
    nearest = _Nearest(position[inside], owner[inside])
    if inputs.groups:
        frames = [group.inner.frame for group in inputs.groups]
        centres = [_centre(group.inner.polygons) for group in inputs.groups]
        spaces = nearest.before(np.array(centres), np.array([f.normal for f in frames]))
        found["window_space"] = "window", spaces
    if "sun_point" in openings:
        points, normals = openings["sun_point"], openings["opening_normal"]
        spaces = nearest.before(points.values, normals.values)
        found["opening_space"] = "opening", spaces
    if study.view and inputs.cameras:
        eyes = np.array([camera.position for camera in inputs.cameras])
        spaces = nearest.of(eyes)
        named = {view: table.name for table in study.space for view in table.views}
        labels = [table.label for table in study.view]
        chosen = [named.get(v, s) for v, s in zip(labels, spaces, strict=True)]
        found["view_space"] = "view", np.array(chosen, dtype=str)
    if inputs.view_grids:
        turns = [grid.table.directions for grid in inputs.view_grids]
        places = [
            np.repeat(grid.position, count, axis=0)
            for grid, count in zip(inputs.view_grids, turns, strict=True)
        ]
        found["grid_view_space"] = VIEWS, nearest.of(np.concatenate(places))
    return found


def sensor_spaces(study: Study, inputs: Inputs) -> np.ndarray:
    """Return the name of the space of every sensor; "" outside all spaces."""
    grid = np.repeat(list(inputs.grids), [len(s) for s in inputs.grids.values()])
    if not study.space:
        level = {name: _faces_up(grid) for name, grid in inputs.grids.items()}
        chosen = {name for name in level if level[name] or not any(level.values())}
        return np.array([n if n in chosen else "" for n in grid], dtype=object)
    flat = inputs.sensors().position[:, :2]
    owner = np.full(len(grid), "", dtype=object)
    for table in study.space:
        member = np.isin(grid, table.grids)
        if table.corners:
            corners = study.scene.metres * np.array(table.corners, dtype=float)
            member = inside_polygon(flat, corners)
        require(
            member.any(), f'no sensor is in space "{table.name}"; at least one expected'
        )
        twice = member & (owner != "")
        require(
            not twice.any(),
            f'{twice.sum()} sensors are in space "{table.name}" and in another one; one'
            " space for each sensor expected",
        )
        owner[member] = table.name
    return owner


def _faces_up(grid: Sensors) -> bool:
    return bool(np.median(grid.direction[:, 2]) > _UP)


class _Nearest:
    # Spaces of the nearest sensors

    def __init__(self, position: np.ndarray, owner: np.ndarray) -> None:
        self.position, self.owner = position, owner

    def of(self, points: Float[np.ndarray, "point 3"]) -> np.ndarray:
        number = cKDTree(self.position).query(points)[1]
        return np.asarray(self.owner[number].astype(str))

    def before(
        self,
        points: Float[np.ndarray, "point 3"],
        normals: Float[np.ndarray, "point 3"],
    ) -> np.ndarray:
        # Nearest sensors on the side that the normals point to, or nearest of all
        found = []
        for point, normal in zip(points, normals, strict=True):
            away = self.position - point
            length = np.linalg.norm(away, axis=1)
            front = away @ normal > 0
            ranked = np.where(front | ~front.any(), length, np.inf)
            found.append(self.owner[np.argmin(ranked)])
        return np.array(found, dtype=str)


def _areas(study: Study, owner: np.ndarray, position: np.ndarray) -> np.ndarray:
    # Floor area of each sensor: an equal part of that of its space
    tables = {table.name: table for table in study.space}
    area = np.zeros(len(owner))
    for name in dict.fromkeys(owner[owner != ""].tolist()):
        member = owner == name
        table, count = tables.get(name), member.sum()
        if table is not None and table.area is not None:
            area[member] = table.area / count
        elif table is not None and table.corners:
            metres = study.scene.metres * np.array(table.corners, dtype=float)
            area[member] = _polygon_area(metres) / count
        else:
            area[member] = cell_area(position[member])
    return area


def _polygon_area(corners: np.ndarray) -> float:
    x, y = corners.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def _centre(polygons: tuple[Polygon, ...]) -> np.ndarray:
    vertices = np.concatenate([polygon.vertices for polygon in polygons])
    return np.asarray((vertices.min(axis=0) + vertices.max(axis=0)) / 2)
