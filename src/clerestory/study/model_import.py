"""Conversion of a Honeybee model to files: scene, windows, sensors, views, study."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import final

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
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.sensors import Sensors

_SAMPLES = 2048
_BASES = {145: "kf", 77: "kh", 73: "kh", 41: "kq"}


@final
@dataclass(frozen=True)
class Written:
    """Files written by an import.

    Attributes
    ----------
    study : path of the study file; None without weather or sensors
    files : paths of all files, in the order of writing
    """

    study: Path | None
    files: tuple[Path, ...]


def write_honeybee_model(
    model: HoneybeeModel, folder: str | Path, *, weather: str | Path | None = None
) -> Written:
    """Write a model as Radiance files, BSDF files and a study file.

    BSDFs of glass and other sheet materials are computed by ray tracing.

    Parameters
    ----------
    weather : weather file of the study; without it no study file is written

    Raises
    ------
    InputError : a BSDF of the model is invalid
    OutputError : the folder cannot be written
    """
    folder = make_folder(folder)
    files = [_put(folder / "scene.rad", format_rad(model.scene, bsdf_file={}))]
    bsdfs = _bsdfs(model, folder)
    files += dict.fromkeys(bsdfs.values())
    windows = {}
    for group in model.windows:
        path = folder / f"{_word(group.name)}.rad"
        matrix = read_bsdf(bsdfs[group.states[0][0]]).transmission_matrix()
        basis = _BASES.get(matrix.values.shape[1], "kf")
        windows[group.name] = _put(path, _window_text(group, basis))
    grids = {
        n: _put(folder / f"{_word(n)}.pts", _points(g)) for n, g in model.grids.items()
    }
    views = {
        n: _put(folder / f"{_word(n)}.vf", f"rvu {format_view(v)}\n")
        for n, v in model.views.items()
    }
    files += [*windows.values(), *grids.values(), *views.values()]
    if weather is None or not grids:
        return Written(None, tuple(files))
    text = _study_text(model, folder, bsdfs, windows, grids, views, Path(weather))
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
            raise InputError(
                f'the BSDF of modifier "{modifier.name}": {error.message}',
                file=error.file,
                line=error.line,
            ) from error
        return
    write_bsdf(path, sheet_bsdf(modifier), digits=5)


def sheet_bsdf(modifier: Modifier) -> Bsdf:
    """Return the transmission BSDF of a flat sheet of a material, by ray tracing."""
    if isinstance(modifier, BsdfModifier):
        raise InputError(f'"{modifier.name}" is a BSDF already')
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


def _window_text(group: ApertureGroup, basis: str) -> str:
    up = "" if group.up is None else " u=" + ",".join(f"{x:g}" for x in group.up)
    lines = [
        f"#@rfluxmtx h={basis}{up}",
        "void glow window_glow",
        "0",
        "0",
        "4 1 1 1 0",
    ]
    for number, outline in enumerate(group.polygons, 1):
        lines += ["", f"window_glow polygon {_word(group.name)}.{number}", "0", "0"]
        lines.append(str(3 * len(outline)))
        lines += [f"    {x:.7g} {y:.7g} {z:.7g}" for x, y, z in outline]
    return "\n".join(lines) + "\n"


def _points(sensors: Sensors) -> str:
    rows = np.concatenate([sensors.position, sensors.direction], axis=1)
    return "".join(" ".join(f"{x:.7g}" for x in row) + "\n" for row in rows)


def _study_text(
    model: HoneybeeModel,
    folder: Path,
    bsdfs: dict[str, Path],
    windows: dict[str, Path],
    grids: dict[str, Path],
    views: dict[str, Path],
    weather: Path,
) -> str:
    lines = [
        f'title = "{_plain(model.name)}"',
        f'method = "{"3-phase" if windows else "2-phase"}"',
        "",
        "[scene]",
        'files = ["scene.rad"]',
    ]
    for group in model.windows:
        file = windows[group.name].name
        lines += ["", "[[window]]", f'name = "{group.name}"', f'file = "{file}"']
        if len(group.states) == 1:
            lines.append(f'bsdf = "{bsdfs[group.states[0][0]].name}"')
            continue
        for name, _ in group.states:
            lines += ["", "[[window.state]]", f'name = "{_plain(name)}"']
            lines.append(f'bsdf = "{bsdfs[name].name}"')
    for name, path in grids.items():
        lines += ["", "[[sensors]]", f'name = "{name}"', f'file = "{path.name}"']
    for name, path in views.items() if windows else ():
        lines += ["", "[[view]]", f'name = "{name}"', f'file = "{path.name}"']
    place = _relative(weather, folder)
    lines += ["", "[weather]", f'file = "{place}"']
    return "\n".join(lines) + "\n"


def _relative(file: Path, folder: Path) -> str:
    # No relative path exists to a different drive
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return file.resolve().as_posix()


def _plain(name: str) -> str:
    return "".join(c for c in name if c.isalnum() or c in " .,-_()")
