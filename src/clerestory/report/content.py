"""Content of a report as data classes.

Pages are made from these classes alone; tests fill them from analytic solutions.
"""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int

from clerestory.checks import require
from clerestory.report.heat_map import DayHourGrid, day_hour_grid
from clerestory.report.uncertain_value import number
from clerestory.study.title_block import TitleBlock


class Room(NamedTuple):
    """Scene as triangles: corners [m] and RGB reflectance of each triangle."""

    corners: Float[np.ndarray, "triangle 3 3"]
    colour: Float[np.ndarray, "triangle 3"]


@dataclass(frozen=True, eq=False)
class WindowSurface:
    """Surface and orientation of a window group.

    Attributes
    ----------
    name : name of the group
    corners : corners of the triangles [m]
    normal : unit normal of the front, which must face the room
    up : unit vector of the up direction of the BSDF
    """

    name: str
    corners: Float[np.ndarray, "triangle 3 3"]
    normal: Float[np.ndarray, "3"]
    up: Float[np.ndarray, "3"]

    @property
    def centre(self) -> Float[np.ndarray, "3"]:
        """Centroid of the window surface [m]."""
        weight = self._areas() + 1e-12
        return np.asarray(np.average(self.corners.mean(axis=1), axis=0, weights=weight))

    @property
    def area(self) -> float:
        """Area of the window surface [m²]."""
        return float(self._areas().sum())

    def _areas(self) -> Float[np.ndarray, " triangle"]:
        sides = self.corners[:, 1:] - self.corners[:, :1]
        return np.asarray(
            np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
        )


@dataclass(frozen=True, eq=False)
class SensorPoints:
    """Names, grid names, positions [m] and unit normals of sensors."""

    names: tuple[str, ...]
    grids: tuple[str, ...]
    position: Float[np.ndarray, "sensor 3"]
    direction: Float[np.ndarray, "sensor 3"]

    def __len__(self) -> int:
        return len(self.names)

    def by_grid(self) -> dict[str, Int[np.ndarray, " member"]]:
        """Return the sensor indices of each grid, by name of the grid."""
        grids = np.array(self.grids, dtype=object)
        return {name: np.flatnonzero(grids == name) for name in dict.fromkeys(grids)}


class FactTable(NamedTuple):
    """Titled table of labels and values, such as ray-tracing parameters."""

    title: str
    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class ReportContent:
    """Content of a report: results, metrics, scene and records of a run.

    Attributes
    ----------
    title, method, place : title, simulation method and location of the study
    data : dataset of `Results`, from which optional sections are made
    times : local standard time at the middle of each time step
    illuminance, standard_error : illuminance and its standard error [lux]
    occupied : whether each time step is within the occupied hours
    schedule : description of the occupied hours
    metrics : metrics of each sensor, as returned by `sensor_metrics`
    sensors : positions and directions of the sensors
    room, windows : surfaces of the scene and of its windows; both may be empty
    north : azimuth of the scene's +y axis, clockwise from north [rad]
    tables : tables of parameters, versions, seeds and compute device
    seconds : run time of each phase [s]
    warnings : warnings issued during the run
    selection : number of sensors shown, such as "500 of 6,521 sensors"; empty if all
    picture_folder : folder with pictures of the run; None for a report without pictures
    title_block : project, client, author, logo and notes
    """

    title: str
    method: str
    place: str
    data: xr.Dataset
    times: np.ndarray
    illuminance: Float[np.ndarray, "sensor time"]
    standard_error: Float[np.ndarray, "sensor time"]
    occupied: Bool[np.ndarray, " time"]
    schedule: str
    metrics: xr.Dataset
    sensors: SensorPoints
    room: Room
    windows: tuple[WindowSurface, ...] = ()
    north: float = 0.0
    tables: tuple[FactTable, ...] = ()
    seconds: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    selection: str = ""
    picture_folder: Path | None = None
    title_block: TitleBlock = field(default_factory=TitleBlock)

    def __post_init__(self) -> None:
        require(
            len(self.sensors) and len(self.times),
            f"the results contain {len(self.sensors)} sensors and {len(self.times)}"
            " time steps; a report needs at least one of each",
        )
        for name in ("illuminance", "standard_error"):
            valid = np.isfinite(getattr(self, name)).all()
            what = f"the {name.replace('_', ' ')}s contain NaN or infinite values"
            require(valid, f"{what}; finite numbers expected")

    @cached_property
    def grid(self) -> DayHourGrid:
        """Cells (day, time of day) of the annual heat maps."""
        return day_hour_grid(self.times)

    def occupied_share(self, chosen: Bool[np.ndarray, " time"]) -> str:
        """Text such as "12.3 %, 450 h": occupied hours in the chosen time steps."""
        counted = self.occupied & chosen
        share = 100 * counted.sum() / max(self.occupied.sum(), 1)
        return f"{share:.1f} %, {number(self.grid.hours(counted))} h"
