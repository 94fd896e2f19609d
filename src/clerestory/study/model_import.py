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
    """Files of an import; no study without weather or sensors."""

    study: Path | None
    files: tuple[Path, ...]


def write_honeybee_model(
    model: HoneybeeModel, folder: str | Path, *, weather: str | Path | None = None
) -> Written:
    """Write a model as Radiance files, BSDF files and, with weather, a study file.

    BSDFs of glass and other sheet materials are computed by ray tracing.
    """
    folder = make_folder(folder)
    files = [_put(folder / "scene.rad", format_rad(model.scene, bsdf_file={}))]
    bsdfs = _bsdfs(model, folder)
    files += dict.fromkeys(bsdfs.values())
    windows = {}
    for group in model.windows:
        matrix = read_bsdf(bsdfs[group.states[0][0]]).transmission_matrix()
        basis, name = _BASES.get(matrix.values.shape[1], "kf"), _word(group.name)
        text = study_files.window_text(name, group.polygons, basis=basis, up=group.up)
        windows[group.name] = _put(folder / f"{name}.rad", text)
    grids = {
        name: study_files.write_sensors(folder / f"{_word(name)}.pts", grid)
        for name, grid in model.grids.items()
    }
    views = {
        n: _put(folder / f"{_word(n)}.vf", f"rvu {format_view(v)}\n")
        for n, v in model.views.items()
    }
    files += [*windows.values(), *grids.values(), *views.values()]
    if weather is None or not grids:
        return Written(None, tuple(files))
    place = study_files.relative_path(weather, folder)
    text = _study_text(model, bsdfs, windows, grids, views, place)
    study = _put(folder / "study.toml", text)
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


def _study_text(
    model: HoneybeeModel,
    bsdfs: Mapping[str, Path],
    windows: Mapping[str, Path],
    grids: Mapping[str, Path],
    views: Mapping[str, Path],
    weather: str,
) -> str:
    return study_files.study_text(
        {
            "title": _plain(model.name),
            "method": "3-phase" if windows else "2-phase",
            "scene": {"files": ["scene.rad"]},
            "window": [
                {
                    "name": group.name,
                    "file": windows[group.name].name,
                    **_layers(group, bsdfs),
                }
                for group in model.windows
            ],
            "sensors": _named(grids),
            "view": _named(views) if windows else [],
            "weather": {"file": weather},
        }
    )


def _layers(group: ApertureGroup, bsdfs: Mapping[str, Path]) -> dict[str, Any]:
    states = [
        {"name": _plain(name), "bsdf": bsdfs[name].name} for name, _ in group.states
    ]
    return {"state": states} if len(states) > 1 else {"bsdf": states[0]["bsdf"]}


def _named(files: Mapping[str, Path]) -> list[dict[str, str]]:
    return [{"name": name, "file": path.name} for name, path in files.items()]


def _plain(name: str) -> str:
    return "".join(c for c in name if c.isalnum() or c in " .,-_()")
