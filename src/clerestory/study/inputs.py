"""All that a study names, read and checked before anything is traced."""

import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml import read_bsdf
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.hemisphere.partition import RingPartition
from clerestory.matrix.axis import Axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.metrics.hours import occupied_hours
from clerestory.phases.pictures import Camera
from clerestory.scene.model import Scene
from clerestory.scene.rad import read_rad
from clerestory.scene.sensors import Sensors, read_sensors
from clerestory.scene.view_text import read_view
from clerestory.scene.window import Window, read_windows
from clerestory.sky.doubts import warn_of_clock
from clerestory.sky.period import select_days
from clerestory.sky.read import read_weather
from clerestory.sky.station import read_with
from clerestory.sky.weather import Weather
from clerestory.study.config import Study, ViewTable, WindowTable


@dataclass(frozen=True, eq=False)
class WindowGroup:
    """A window group and what stands in it.

    Attributes
    ----------
    inner, outer : the window with the patches of its room side and its outer side
    transmission : matrix T of its BSDF
    fine : the BSDF that direct sun is traced through
    peak : whether what it passes straight is kept as sharp as the sun
    """

    inner: Window
    outer: Window
    transmission: TransferMatrix
    fine: Bsdf
    peak: bool

    @property
    def name(self) -> str:
        """Name of the window group."""
        return self.inner.name


@dataclass(frozen=True, eq=False)
class Inputs:
    """What a study is made of.

    Attributes
    ----------
    scene : the room without its windows
    groups : the window groups
    grids : sensors by the name of their grid
    cameras : of the study's views, in order
    weather : the part of the year that is simulated
    """

    scene: Scene
    groups: tuple[WindowGroup, ...]
    grids: dict[str, Sensors]
    cameras: tuple[Camera, ...]
    weather: Weather

    def sensors(self) -> Sensors:
        """Return the sensors of all grids, one after the other."""
        grids = self.grids.values()
        return Sensors(
            np.concatenate([grid.position for grid in grids]),
            np.concatenate([grid.direction for grid in grids]),
        )


def read_inputs(study: Study) -> Inputs:
    """Read the files of a study.

    Raises
    ------
    InputError : a file is wrong, or two of them do not fit together
    """
    groups = [group for table in study.window for group in _window_groups(table)]
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
        weather=_weather(study),
    )


def _camera(table: ViewTable) -> Camera:
    view = read_view(table.file)
    return Camera(view, *view.size_for(table.resolution))


def _weather(study: Study) -> Weather:
    # The days asked for, with at least one hour that counts
    table = study.weather
    whole = (
        read_weather(table.file)
        if table.measured is None
        else read_with(table.file, table.measured)
    )
    warn_of_clock(whole)
    weather = select_days(
        whole,
        first=table.first_day or "01-01",
        last=table.last_day or "12-31",
    )
    start, end = study.schedule.from_hour, study.schedule.to_hour
    if not occupied_hours(weather.times, from_hour=start, to_hour=end).any():
        raise InputError(
            f"no time step lies between {start:g} and {end:g} h, the study's schedule;"
            " at least one expected",
            file=study.weather.file,
        )
    return weather


def _window_groups(table: WindowTable) -> list[WindowGroup]:
    # One group for each modifier in the file, all with the same BSDF
    bsdf = read_bsdf(table.bsdf)
    fine = read_bsdf(table.sun_bsdf) if table.sun_bsdf else bsdf
    windows = read_windows(table.file)
    labels = [table.label]
    if len(windows) > 1:
        labels = [f"{table.label}.{window.name}" for window in windows]
    groups = []
    for label, window in zip(labels, windows, strict=True):
        transmission = bsdf.transmission_matrix(window=label)
        named = replace(window, name=label)
        groups.append(
            WindowGroup(
                _with_patches(named, transmission.rows, file=table.bsdf),
                _with_patches(named, transmission.columns, file=table.bsdf),
                transmission,
                fine,
                table.peak,
            )
        )
    return groups


def _with_patches(window: Window, axis: Axis, *, file: Path) -> Window:
    # The BSDF decides how the window is cut into patches
    if not isinstance(axis.partition, RingPartition):
        raise InputError("is not given on patches of a hemisphere", file=file)
    if not axis.partition.matches(window.partition):
        warnings.warn(
            f'{file}: has the {len(axis.partition)} patches of "{axis.partition.name}",'
            f' window "{window.name}" asks for the {len(window.partition)} of'
            f' "{window.partition.name}"; those of the BSDF are used',
            ClerestoryWarning,
            stacklevel=2,
        )
    return replace(window, partition=axis.partition)
