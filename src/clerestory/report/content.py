"""Content of a report as plain data classes.

The page depends only on these values, which come from a run, a results file or an
analytic solution in a test.
"""

from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.errors import InputError
from clerestory.report.animation import Film
from clerestory.report.electric_lighting import LampZone
from clerestory.report.equation_terms import EquationTerms
from clerestory.report.method_table import MethodComparison
from clerestory.report.sensor_points import SensorPoints
from clerestory.report.sunlight import Sunlight
from clerestory.report.view_glare import ViewGlare
from clerestory.report.view_pictures import ViewPictures
from clerestory.report.window_layers import Layer
from clerestory.report.window_states import WindowStates


@dataclass(frozen=True, eq=False)
class Room:
    """Surfaces of the scene as coloured triangles.

    Attributes
    ----------
    corners : corners of each triangle [m]
    colour : RGB reflectance of each triangle, 0…1
    """

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
        """Centroid [m]."""
        weight = self._areas() + 1e-12
        return np.asarray(np.average(self.corners.mean(axis=1), axis=0, weights=weight))

    @property
    def area(self) -> float:
        """Area [m²]."""
        return float(self._areas().sum())

    def _areas(self) -> Float[np.ndarray, " triangle"]:
        sides = self.corners[:, 1:] - self.corners[:, :1]
        return np.asarray(
            np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
        )


@dataclass(frozen=True)
class FactTable:
    """A titled list of labels and values, such as the parameters of tracing."""

    title: str
    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class ReportContent:
    """Content of a report.

    Attributes
    ----------
    title, method, place : title, simulation method and location of the study
    times : local standard time at the middle of each time step
    illuminance, standard_error : values and standard errors over (sensor, time) [lux]
    occupied : whether each time step is an occupied hour
    schedule : description of the occupied hours
    metrics : metrics of each sensor, as returned by `sensor_metrics`, and
        `useful_bands_error` over (band, sensor)
    sensors : positions and directions of the sensors
    room, windows : surfaces of the scene; both may be empty
    north : azimuth of the scene's +y axis, clockwise from north [rad]
    tables : tables of parameters, versions, seeds and compute device
    seconds : run time of each phase [s]
    warnings : warnings of the run
    states : annual states of the windows that have several states
    glare : annual glare of each view
    pictures : pictures written by the run
    film : animation of one day
    terms : terms of the matrix equation, for methods with direct-sun correction
    lamps : dimming of each zone of luminaires
    layers : BSDFs of the window layers
    methods : comparison of several simulation methods
    sunlight : exposure to sunlight on the day given in the study
    """

    title: str
    method: str
    place: str
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
    states: tuple[WindowStates, ...] = ()
    glare: tuple[ViewGlare, ...] = ()
    pictures: tuple[ViewPictures, ...] = ()
    film: Film | None = None
    terms: EquationTerms | None = None
    lamps: tuple[LampZone, ...] = ()
    layers: tuple[Layer, ...] = ()
    methods: MethodComparison | None = None
    sunlight: Sunlight | None = None

    def __post_init__(self) -> None:
        shape = (len(self.sensors), len(self.times))
        if 0 in shape:
            raise InputError(
                f"results of {shape[0]} sensors and {shape[1]} time steps;"
                " at least one of each expected for a report"
            )
        for name in ("illuminance", "standard_error"):
            values = getattr(self, name)
            if values.shape != shape:
                raise InputError(f"{name} of shape {values.shape}; {shape} expected")
            if not np.all(np.isfinite(values)):
                raise InputError(
                    f"{name} contains NaN or infinite values; finite numbers expected"
                )
        if self.occupied.shape != shape[1:]:
            raise InputError(
                f"occupied hours of shape {self.occupied.shape}; {shape[1:]} expected"
            )
