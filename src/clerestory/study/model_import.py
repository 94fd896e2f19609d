"""Conversion of a model of a building to files: scene, windows, sensors, study."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, final

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.shading_system import SampleArea, System
from clerestory.errors import InputError
from clerestory.escaping import file_stems, printable
from clerestory.files import make_folder, read_text, write_text
from clerestory.formats.building_model import (
    ApertureGroup,
    BuildingModel,
    SitePosition,
    unique_name,
)
from clerestory.formats.floor_grids import floor_grids
from clerestory.formats.hbjson_modifiers import BsdfModifier, Modifier
from clerestory.library.bsdf_source import read_bsdf
from clerestory.radiance.rad_writer import format_rad
from clerestory.radiance.view_text import format_view
from clerestory.scene.model import (
    BsdfSurface,
    Glass,
    Material,
    Polygon,
    Scene,
    insert_material,
)
from clerestory.sky.weather import Weather
from clerestory.sky.weather_formats import read_weather
from clerestory.study import study_files

_SAMPLES = 2048
_BASES = {145: "kf", 77: "kh", 73: "kh", 41: "kq"}

# Radius of the earth, and distance of a weather station that is listed [km]
_EARTH_KM, _FAR_KM = 6371.0, 50.0

# File with everything in the model that was not converted
OMITTED_FILE = "left_out.txt"

# File with the values that were assumed
ASSUMED_FILE = "assumptions.txt"


@final
@dataclass(frozen=True)
class Written:
    """Files written by an import; `study` is None without weather or sensors.

    `omitted` describes what was not converted, `assumed` the values that the model
    lacks; `generated` are the names of the grids above floors.
    """

    study: Path | None
    files: tuple[Path, ...]
    omitted: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    generated: tuple[str, ...] = ()


def write_building_model(
    model: BuildingModel,
    folder: str | Path,
    *,
    weather: str | Path | None = None,
    spacing: float = 0.5,
    height: float = 0.76,
    north_deg: float | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Written:
    """Write a model as Radiance and BSDF files and, with weather, as a study.

    BSDFs of glass and other sheet materials are computed by ray tracing. Rooms without
    sensors get a grid above their floor.

    Parameters
    ----------
    spacing, height : spacing of generated grids, and height above the floor [m]
    north_deg : angle from +y of the model to north, counter-clockwise [deg]; None: that
        of the model
    settings : further tables and keys of the study file
    """
    # Read and compute everything before the first file is written
    assumed = model.assumptions
    if weather is not None:
        assumed = (*assumed, *_elsewhere(model.site, read_weather(weather)))
    floors = floor_grids(model, spacing=spacing, height=height)
    sensors = {**model.grids, **floors.grids}
    omitted = (*model.unsupported, *floors.omitted)
    bsdfs = _bsdf_texts(model)

    folder = make_folder(folder)
    scene = _put(folder / "scene.rad", format_rad(model.scene, bsdf_file={}))
    layers = _paths(bsdfs, folder, ".xml")
    for name, path in layers.items():
        _put(path, bsdfs[name][0])
    files = _paths([group.name for group in model.windows], folder, ".rad")
    windows = [
        _window_table(each, layers, files[each.name], bsdfs[each.states[0][0]][1])
        for each in model.windows
    ]
    grids = _paths(sensors, folder, ".pts")
    for name, path in grids.items():
        study_files.write_sensors(path, sensors[name])
    views = _paths(model.views, folder, ".vf")
    for name, path in views.items():
        write_text(path, f"rvu {format_view(model.views[name])}\n")
    listed = [_put(folder / OMITTED_FILE, _lines(omitted) or "nothing\n")]
    if assumed:
        listed.append(_put(folder / ASSUMED_FILE, _lines(assumed)))
    placed = (*files.values(), *grids.values(), *views.values())
    written = (scene, *layers.values(), *placed, *listed)
    study = None
    north = model.north_deg if north_deg is None else north_deg
    if weather is not None and grids:
        tables = {
            "title": printable(model.name),
            "method": "3-phase" if windows else "2-phase",
            "scene": {"files": [scene.name]},
            "window": windows,
            "sensors": _named(grids),
            "view": _named(views) if windows else [],
            "weather": {"file": study_files.relative_path(weather, folder)},
            **({"sky": {"rotation_deg": north}} if north else {}),
            **(settings or {}),
        }
        study = _put(folder / "study.toml", study_files.study_text(tables))
        written = (*written, study)
    return Written(study, written, omitted, assumed, tuple(floors.grids))


def _elsewhere(site: SitePosition | None, weather: Weather) -> Iterator[str]:
    # The position of the weather station, if the site is far from it
    if site is None:
        return
    north, east = weather.latitude_deg, weather.longitude_deg
    turn = np.radians(site.longitude_deg - east)
    a, b = np.radians([site.latitude_deg, north])
    cosine = np.sin(a) * np.sin(b) + np.cos(a) * np.cos(b) * np.cos(turn)
    away = _EARTH_KM * float(np.arccos(np.clip(cosine, -1, 1)))
    if away > _FAR_KM:
        yield (
            f"position of the site: that of the weather file, {north:.2f}° north and"
            f" {east:.2f}° east, {away:.0f} km from that of the model"
        )


def write_scene(scene: Scene, folder: str | Path) -> Written:
    """Write a scene as `scene.rad` into a folder."""
    path = make_folder(folder) / "scene.rad"
    return Written(None, (_put(path, format_rad(scene, bsdf_file={})),))


def _lines(texts: Iterable[str]) -> str:
    return "".join(f"{printable(text)}\n" for text in texts)


def _put(path: Path, text: str) -> Path:
    write_text(path, text)
    return path


def _paths(names: Iterable[str], folder: Path, suffix: str) -> dict[str, Path]:
    # A file for each name, without blanks; the scene has the name scene.rad
    stems = file_stems(names, taken={"scene"}, blank="_")
    return {name: folder / f"{stem}{suffix}" for name, stem in stems.items()}


def _bsdf_texts(model: BuildingModel) -> dict[str, tuple[str, str]]:
    # XML text and basis of each window modifier
    modifiers = dict(state for group in model.windows for state in group.states)
    with TemporaryDirectory() as name:
        path = Path(name) / "bsdf.xml"
        return {name: _bsdf_text(modifiers[name], path) for name in modifiers}


def check_bsdfs(model: BuildingModel) -> None:
    """Require that the BSDFs of the windows of a model are valid."""
    modifiers = dict(state for group in model.windows for state in group.states)
    with TemporaryDirectory() as name:
        for modifier in modifiers.values():
            if isinstance(modifier, BsdfModifier):
                _bsdf_text(modifier, Path(name) / "bsdf.xml")


def _bsdf_text(modifier: Modifier, path: Path) -> tuple[str, str]:
    named = f'the BSDF of modifier "{modifier.name}"'
    if isinstance(modifier, BsdfModifier):
        write_text(path, modifier.xml)
    else:
        write_bsdf(path, sheet_bsdf(modifier), digits=5)
    try:
        matrix = read_bsdf(path).transmission_matrix()
    except InputError as error:
        place = "" if error.line is None else f"line {error.line}: "
        raise InputError(f"{named}: {place}{error.message}") from error
    return read_text(path), _BASES.get(matrix.values.shape[1], "kf")


def sheet_bsdf(modifier: Material) -> Bsdf:
    """Return the transmission BSDF of a flat sheet of a material, by ray tracing."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    sheet = Polygon(corners, "sheet", "sheet")
    area = SampleArea(np.array([[0.0, 0, 0], [1, 1, 0]]), periodic=True)
    traced = generate_bsdf(
        System(Scene({"sheet": modifier}, (sheet,)), area),
        sides="front",
        samples=_SAMPLES,
        seed=1,
        geometry=False,
    )
    part = traced.functions["visible", "transmission_front"]
    return Bsdf({("visible", "transmission_front"): part}, traced.product)


def window_bsdf(modifier: Modifier) -> Bsdf:
    """Return the BSDF of a window modifier."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "bsdf.xml"
        _bsdf_text(modifier, path)
        return read_bsdf(path)


def window_panes(model: BuildingModel) -> Scene:
    """Return the panes of all windows in their first state, as surfaces of a scene."""
    materials: dict[str, Material] = {}
    surfaces: list[Polygon] = []
    for group in model.windows:
        name, modifier = group.states[0]
        if isinstance(modifier, BsdfModifier):
            modifier = BsdfSurface(name, window_bsdf(modifier), 0.0, modifier.up)
        key = insert_material(materials, modifier)
        surfaces += [Polygon(each, key, group.name) for each in group.polygons]
    return Scene(materials, tuple(surfaces))


def _window_table(
    group: ApertureGroup, bsdfs: Mapping[str, Path], path: Path, basis: str
) -> dict[str, Any]:
    # Study-file table of a window group; the polygons are written to a file
    files = [bsdfs[name] for name, _ in group.states]
    text = study_files.window_text(path.stem, group.polygons, basis=basis, up=group.up)
    # View through glass is clear: sunlight is not scattered
    tables: list[dict[str, Any]] = [
        {"bsdf": file.name, **({"peak": True} if isinstance(modifier, Glass) else {})}
        for file, (_, modifier) in zip(files, group.states, strict=True)
    ]
    layers: dict[str, Any] = tables[0]
    if len(files) > 1:
        names: list[str] = []
        for name, _ in group.states:
            names.append(unique_name(name, names))
        layers = {
            "state": [
                {"name": name, **table}
                for name, table in zip(names, tables, strict=True)
            ]
        }
    return {"name": group.name, "file": _put(path, text).name, **layers}


def _named(files: Mapping[str, Path]) -> list[dict[str, str]]:
    return [{"name": name, "file": path.name} for name, path in files.items()]
