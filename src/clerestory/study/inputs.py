"""Content of the input files of a study."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from clerestory.errors import InputError
from clerestory.phases.picture_matrices import Camera
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.view_text import read_view
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors, read_sensors
from clerestory.sky.weather import Weather
from clerestory.study.config import Study
from clerestory.study.config_tables import ViewTable
from clerestory.study.study_weather import study_weather
from clerestory.study.window_groups import WindowGroup, read_window_groups


@dataclass(frozen=True, eq=False)
class Inputs:
    """Inputs of a study.

    Attributes
    ----------
    scene : room and surroundings, without the windows
    groups : window groups
    grids : sensors of each grid, by grid name
    cameras : views with picture sizes, in the order of the study file
    weather : weather of the simulated time steps
    """

    scene: Scene
    groups: tuple[WindowGroup, ...]
    grids: dict[str, Sensors]
    cameras: tuple[Camera, ...]
    weather: Weather

    def sensors(self) -> Sensors:
        """Return the sensors of all grids, concatenated."""
        grids = self.grids.values()
        return Sensors(
            np.concatenate([grid.position for grid in grids]),
            np.concatenate([grid.direction for grid in grids]),
        )

    def rows(self, grid: str) -> Int[np.ndarray, " sensor"]:
        """Return the indices of the sensors of a grid, or all if `grid` is empty."""
        owner = np.repeat(list(self.grids), [len(s) for s in self.grids.values()])
        return np.flatnonzero((owner == grid) | (not grid))


def read_inputs(study: Study) -> Inputs:
    """Read the files of a study."""
    groups = [group for table in study.window for group in read_window_groups(table)]
    names = [group.name for group in groups]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f'two window groups are named "{name}"; different names expected'
            )
    return Inputs(
        scene=read_rad(*study.scene.files),
        groups=tuple(groups),
        grids={table.label: read_sensors(table.file) for table in study.sensors},
        cameras=tuple(_camera(table) for table in study.view),
        weather=study_weather(study),
    )


def _camera(table: ViewTable) -> Camera:
    view = read_view(table.file)
    return Camera(view, *view.size_for(table.resolution))
