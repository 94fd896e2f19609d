"""New study file from a room, windows, a BSDF and a weather file."""

import json
import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import make_folder, write_text
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.window_reader import read_windows
from clerestory.scene.floor_grid import floor_grid, room_side
from clerestory.scene.scene_checks import check_scene
from clerestory.scene.sensors import read_sensors
from clerestory.scene.window import Window
from clerestory.sky.weather_formats import read_weather

STUDY_FILE, SENSOR_FILE = "study.toml", "workplane.pts"


@dataclass(frozen=True)
class NewStudy:
    """Files written for a new study.

    Attributes
    ----------
    study : path of the study file
    sensors : number of sensors
    turned : names of windows that were flipped to face the room
    """

    study: Path
    sensors: int
    turned: tuple[str, ...]


def begin_study(
    folder: str | Path,
    *,
    scene: Sequence[str | Path],
    windows: Sequence[str | Path],
    bsdf: str | Path,
    weather: str | Path,
    sensors: str | Path | None = None,
    spacing: float = 0.5,
    height: float = 0.76,
) -> NewStudy:
    """Write a study file for a room, and a sensor grid if none is given.

    Input files are not changed. By default, a sensor grid is placed above the floor of
    the room. A window whose back faces the room is flipped in a copy of its file.
    Warnings are issued for probable mistakes, such as glazing left in the scene.

    Parameters
    ----------
    scene : Radiance scene files, materials first, without the window glazing
    windows : Radiance files of window polygons
    bsdf : BSDF file of the glazing and shading of all windows
    weather : weather file
    sensors : sensor file; by default a grid above the floor
    spacing, height : spacing of the grid, and its height above the floor [m]

    Raises
    ------
    InputError : a file is invalid, or the room behind a window is not closed
    OutputError : the folder is not writable
    """
    folder = Path(folder)
    if (folder / STUDY_FILE).exists():
        raise InputError("is there already; a new folder expected", file=folder)
    room = read_rad(*scene)
    groups = {Path(file): read_windows(file) for file in windows}
    read_bsdf(bsdf)
    read_weather(weather)
    for doubt in check_scene(room, [w for found in groups.values() for w in found]):
        warnings.warn(doubt, ClerestoryWarning, stacklevel=2)

    # Sensor grid above the floor
    if sensors is None:
        first, *others = [w for found in groups.values() for w in found]
        grid = floor_grid(
            room, first, others=others, spacing=spacing, height=height
        ).position
        points, count = folder / SENSOR_FILE, len(grid)
    else:
        points, count = Path(sensors), len(read_sensors(sensors))

    # Flip windows to face the room; write files only after all are read
    make_folder(folder)
    shown, turned = [], []
    for file, found in groups.items():
        wrong = [w.name for w in found if room_side(room, w) < 0]
        shown.append(folder / file.name if wrong else file)
        turned += wrong
        if wrong:
            write_text(shown[-1], _windows_text(found, wrong))

    if sensors is None:
        lines = [" ".join(f"{x:.4f}" for x in point) + " 0 0 1" for point in grid]
        write_text(points, "\n".join(lines) + "\n")
    text = _study_text(
        title=folder.resolve().name,
        scene=[_relative(file, folder) for file in scene],
        windows=[_relative(file, folder) for file in shown],
        bsdf=_relative(bsdf, folder),
        sensors=_relative(points, folder),
        weather=_relative(weather, folder),
    )
    write_text(folder / STUDY_FILE, text)
    return NewStudy(folder / STUDY_FILE, count, tuple(turned))


def _relative(file: str | Path, folder: Path) -> str:
    return Path(os.path.relpath(file, folder)).as_posix()


def _windows_text(windows: Sequence[Window], turned: Sequence[str]) -> str:
    # Polygons with vertices counter-clockwise as seen from the room
    parts = ["# Windows whose front faces the room.\n"]
    for window in windows:
        up = " ".join(f"{x:.6g}" for x in np.round(window.frame.up, 6))
        sign = -1 if window.name in turned else 1
        parts.append(f"\n#@rfluxmtx h=kf u={_axis(up)}\n")
        parts.append(f"void glow {window.name} 0 0 4 1 1 1 0\n")
        for number, polygon in enumerate(window.polygons):
            corners = polygon.vertices[::sign]
            parts.append(f"{window.name} polygon {window.name}.{number + 1}\n")
            parts.append(f"0 0 {corners.size}\n")
            parts += [" ".join(f"{x:.9g}" for x in c) + "\n" for c in corners.tolist()]
    return "".join(parts)


def _axis(up: str) -> str:
    # Direction in rfluxmtx syntax: an axis name or three numbers
    names = {"0 0 1": "Z", "0 1 0": "Y", "1 0 0": "X"}
    return names.get(up, ",".join(up.split()))


def _study_text(
    *,
    title: str,
    scene: Sequence[str],
    windows: Sequence[str],
    bsdf: str,
    sensors: str,
    weather: str,
) -> str:
    def quoted(words: str) -> str:
        return json.dumps(words, ensure_ascii=False)

    files = ", ".join(quoted(file) for file in scene)
    openings = "".join(
        f"[[window]]\nfile = {quoted(file)}\nbsdf = {quoted(bsdf)}\n\n"
        for file in windows
    )
    return f"""# Paths are relative to this file; docs/study-file.md explains every key.

title = {quoted(title)}
method = "3-phase"

[scene]
files = [{files}]

{openings}[[sensors]]
file = {quoted(sensors)}

[weather]
file = {quoted(weather)}

[sky]
rotation_deg = 0.0       # how far the scene's +y points east of north

[trace]
relative_error = 0.01

[schedule]
from_hour = 8
to_hour = 18
"""
