"""Conversion of a Honeybee model to files: scene, windows, sensors, views, study."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.shading_system import SampleArea, System
from clerestory.errors import InputError
from clerestory.files import make_folder, write_text
from clerestory.formats.hbjson import ApertureGroup, HoneybeeModel
from clerestory.formats.hbjson_modifiers import BsdfModifier, Modifier
from clerestory.radiance.rad_writer import format_rad
from clerestory.radiance.view_text import format_view
from clerestory.scene.model import Material, Polygon, Scene
from clerestory.study import study_files

_SAMPLES = 2048
_BASES = {145: "kf", 77: "kh", 73: "kh", 41: "kq"}


@final
@dataclass(frozen=True)
class Written:
    """Files written by an import; `study` is None without weather or sensors."""

    study: Path | None
    files: tuple[Path, ...]


def write_honeybee_model(
    model: HoneybeeModel, folder: str | Path, *, weather: str | Path | None = None
) -> Written:
    """Write a Honeybee model as Radiance and BSDF files and, with weather, as a study.

    BSDFs of glass and other sheet materials are computed by ray tracing.
    """
    folder = make_folder(folder)
    scene = _put(folder / "scene.rad", format_rad(model.scene, bsdf_file={}))
    bsdfs = _bsdfs(model, folder)
    windows = [_window_table(group, bsdfs, folder) for group in model.windows]
    grids = {name: folder / f"{_word(name)}.pts" for name in model.grids}
    for name, path in grids.items():
        study_files.write_sensors(path, model.grids[name])
    views = {name: folder / f"{_word(name)}.vf" for name in model.views}
    for name, path in views.items():
        write_text(path, f"rvu {format_view(model.views[name])}\n")
    outlines = [folder / window["file"] for window in windows]
    layers = dict.fromkeys(bsdfs.values())
    files = (scene, *layers, *outlines, *grids.values(), *views.values())
    if weather is None or not grids:
        return Written(None, files)
    tables = {
        "title": _plain(model.name),
        "method": "3-phase" if windows else "2-phase",
        "scene": {"files": [scene.name]},
        "window": windows,
        "sensors": _named(grids),
        "view": _named(views) if windows else [],
        "weather": {"file": study_files.relative_path(weather, folder)},
    }
    study = _put(folder / "study.toml", study_files.study_text(tables))
    return Written(study, (*files, study))


def write_scene(scene: Scene, folder: str | Path) -> Written:
    """Write a scene as `scene.rad` into a folder."""
    path = make_folder(folder) / "scene.rad"
    return Written(None, (_put(path, format_rad(scene, bsdf_file={})),))


def _put(path: Path, text: str) -> Path:
    write_text(path, text)
    return path


def _word(name: str) -> str:
    return "_".join(name.split())


def _bsdfs(model: HoneybeeModel, folder: Path) -> dict[str, Path]:
    # One BSDF file per window modifier
    found: dict[str, Path] = {}
    for group in model.windows:
        for name, modifier in group.states:
            if name not in found:
                found[name] = folder / f"{_word(name)}.xml"
                _write_modifier(modifier, found[name])
    return found


def _write_modifier(modifier: Modifier, path: Path) -> None:
    if isinstance(modifier, BsdfModifier):
        write_text(path, modifier.xml)
        try:
            read_bsdf(path)
        except InputError as error:
            message = f'the BSDF of modifier "{modifier.name}": {error.message}'
            raise InputError(message, file=error.file, line=error.line) from error
    else:
        write_bsdf(path, sheet_bsdf(modifier), digits=5)


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


def _window_table(
    group: ApertureGroup, bsdfs: Mapping[str, Path], folder: Path
) -> dict[str, Any]:
    # Study-file table of a window group; the polygons are written to a file
    states = [
        {"name": _plain(name), "bsdf": bsdfs[name].name} for name, _ in group.states
    ]
    matrix = read_bsdf(folder / states[0]["bsdf"]).transmission_matrix()
    basis, name = _BASES.get(matrix.values.shape[1], "kf"), _word(group.name)
    text = study_files.window_text(name, group.polygons, basis=basis, up=group.up)
    layers = {"state": states} if len(states) > 1 else {"bsdf": states[0]["bsdf"]}
    file = _put(folder / f"{name}.rad", text).name
    return {"name": group.name, "file": file, **layers}


def _named(files: Mapping[str, Path]) -> list[dict[str, str]]:
    return [{"name": name, "file": path.name} for name, path in files.items()]


def _plain(name: str) -> str:
    return "".join(c for c in name if c.isalnum() or c in " .,-_()")
