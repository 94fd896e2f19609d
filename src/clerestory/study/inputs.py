"""Content of the input files of a study."""

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Int

from clerestory.bands import RGB
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.checks import require
from clerestory.directions import unit
from clerestory.errors import InputError
from clerestory.image.camera import Camera
from clerestory.library.bsdf_source import read_bsdf
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.phases.recent_values import RecentValues
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.view_text import read_view
from clerestory.scene.band_conversion import in_bands
from clerestory.scene.glazing import without_glazing
from clerestory.scene.model import Scene
from clerestory.scene.scaling import scaled
from clerestory.scene.sensors import Sensors, read_sensors
from clerestory.scene.view import View
from clerestory.sky.clear_sky import clear_sky_weather
from clerestory.sky.quality_checks import warn_of_clock
from clerestory.sky.station_file import read_with
from clerestory.sky.weather import Weather
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.weather_selection import select_days
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import band_set
from clerestory.spectral.spectrum_file import read_spectrum
from clerestory.study.config import Study
from clerestory.study.config_tables import SceneTable, ViewTable
from clerestory.study.view_grid_positions import ViewGrid, read_view_grid
from clerestory.study.weather_tables import WeatherTable
from clerestory.study.window_groups import WindowGroup, read_window_groups

# Vertical component of the direction from which +y is up in fisheye views
_LEVEL = 0.9999


@dataclass(frozen=True, eq=False)
class Inputs:
    """Content of the input files of a study; `scene` is the room without its windows.

    `grids` has sensors by grid name; `cameras` and `view_grids` have the order of the
    study. `spectra` are those of materials and glazings.
    """

    scene: Scene
    groups: tuple[WindowGroup, ...]
    grids: dict[str, Sensors]
    cameras: tuple[Camera, ...]
    weather: Weather
    view_grids: tuple[ViewGrid, ...] = ()
    spectra: tuple[Spectrum, ...] = ()

    __repr__ = brief

    def sensors(self) -> Sensors:
        """Return the sensors of all grids, concatenated."""
        grids = self.grids.values()
        return Sensors(
            np.concatenate([grid.position for grid in grids]),
            np.concatenate([grid.direction for grid in grids]),
        )

    def rows(self, grid: str) -> Int[np.ndarray, " sensor"]:
        """Return the sensor indices of a grid, or of all grids if `grid` is empty."""
        owner = np.repeat(list(self.grids), [len(s) for s in self.grids.values()])
        return np.flatnonzero((owner == grid) | (not grid))


def read_inputs(study: Study, *, recent: RecentValues | None = None) -> Inputs:
    """Read the input files of a study; coordinates are converted to metres.

    `recent` has the scenes, layers and weather of other variants of the study.
    """
    metres, recent = study.scene.metres, recent or RecentValues()
    read = partial(_layer, recent=recent)
    groups = [
        group.scaled(metres)
        for table in study.window
        for group in read_window_groups(
            table, read=read, bands=band_set(study.scene.bands)
        )
    ]
    names = [group.name for group in groups]
    for name in names:
        require(
            names.count(name) == 1,
            f'two window groups are named "{name}"; different names expected',
        )
    for group in groups:
        if group.control is not None and group.control.file is not None:
            group.schedule()
    scene, spectra = recent.value(
        ("scene", study.scene.model_dump_json()),
        lambda: _scene(study.scene),
    )
    grids = {
        table.label: scaled(read_sensors(table.file), metres) for table in study.sensors
    }
    windows = [group.inner for group in groups]
    place = partial(read_view_grid, scene=scene, windows=windows, grids=grids)
    return Inputs(
        scene=scene,
        groups=tuple(groups),
        grids=grids,
        cameras=tuple(_camera(table, metres) for table in study.view),
        weather=recent.value(
            (
                "weather",
                study.weather.model_dump_json(),
                study.schedule.model_dump_json(),
            ),
            lambda: study_weather(study),
        ),
        view_grids=tuple(place(table, metres=metres) for table in study.view_grid),
        spectra=(*spectra, *map(read_spectrum, _glazing_spectra(study))),
    )


def _layer(path: Path, *, recent: RecentValues) -> Bsdf:
    return recent.value(("layer", path), lambda: read_bsdf(path))


def _scene(table: SceneTable) -> tuple[Scene, tuple[Spectrum, ...]]:
    # The scene without panes that windows replace, in the bands of the study, and the
    # spectra of its materials
    bands, whole = band_set(table.bands), read_rad(*table.files)
    scene = scaled(without_glazing(whole, table.glazing), table.metres)
    if bands == RGB:
        return scene, ()
    given = {one.material: read_spectrum(one.file) for one in table.spectrum}
    tints = [
        tint.spectrum()
        for name, material in scene.materials.items()
        if (tint := getattr(material, "tint", None)) and name not in given
    ]
    return in_bands(scene, bands, spectra=given), (*given.values(), *tints)


def _glazing_spectra(study: Study) -> list[Path]:
    # Files of the transmittances of windows, each once
    tables = [state for window in study.window for state in window.states()]
    files = [table.spectrum for table in tables if table.spectrum is not None]
    return list(dict.fromkeys(files))


def _camera(table: ViewTable, metres: float) -> Camera:
    view = scaled(_view(table), metres)
    return Camera(view, *view.size_for(table.resolution))


def _view(table: ViewTable) -> View:
    # That of the file, or a fisheye view
    if table.file is not None:
        return read_view(table.file)
    direction = unit(np.array(table.direction, dtype=float))
    level = abs(direction[2]) < _LEVEL
    up = np.array([0.0, 0, 1] if level else [0.0, 1, 0])
    place = np.array(table.position, dtype=float)
    return View("angular", place, direction, up, horizontal=180, vertical=180)


def study_weather(study: Study) -> Weather:
    """Return the weather of the simulated time steps."""
    table = study.weather
    weather = select_days(
        _whole(table), first=table.first_day or "01-01", last=table.last_day or "12-31"
    )
    step = weather.step_minutes * table.every
    weather = replace(weather.select(_chosen(weather, table)), step_minutes=step)
    start, end = study.schedule.from_hour, study.schedule.to_hour
    require(
        occupied_hours(weather.times, from_hour=start, to_hour=end).any(),
        f"no time step lies between {start:g} and {end:g} h, the study's schedule; at"
        " least one expected",
        file=table.file,
    )
    return weather


def _whole(table: WeatherTable) -> Weather:
    sky = table.clear_sky
    if sky is not None:
        return clear_sky_weather(
            sky.site(), turbidity=sky.turbidity, step_minutes=sky.step_minutes
        )
    if table.file is None:
        raise InputError("no weather; a file or a clear sky expected")
    if table.measured is None:
        weather = read_weather(table.file)
    else:
        weather = read_with(table.file, table.measured)
    warn_of_clock(weather)
    return weather


def _chosen(weather: Weather, table: WeatherTable) -> np.ndarray:
    # Every n-th time-step index within the given hours (at the given moments, if any)
    steps = occupied_hours(
        weather.times, from_hour=table.from_hour, to_hour=table.to_hour
    )
    if table.moments:
        stamps = np.datetime_as_string(weather.times, unit="m").tolist()
        named = np.array([stamp[5:] in table.moments for stamp in stamps])
        for moment in sorted(set(table.moments) - {stamp[5:] for stamp in stamps}):
            raise InputError(
                f"no step at {moment}; the middle of a step, such as"
                f" {stamps[len(stamps) // 2][5:]}, expected",
                file=table.file,
            )
        steps &= named
    numbers = np.flatnonzero(steps)[:: table.every]
    require(
        len(numbers) > 0,
        f"no time step lies between {table.from_hour:g} and {table.to_hour:g} h; at"
        " least one expected",
        file=table.file,
    )
    return numbers
