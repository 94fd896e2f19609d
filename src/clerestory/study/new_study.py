"""Creation of a study from a room, windows, a BSDF and weather, and of the demo."""

import importlib.resources
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from clerestory.checks import one_of, require
from clerestory.constants import LIBRARY_PREFIX
from clerestory.errors import ClerestoryWarning
from clerestory.escaping import toml_value
from clerestory.files import make_folder, replace_file, write_text
from clerestory.library.bsdf_source import is_library_name, read_bsdf
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.view_text import format_view
from clerestory.radiance.window_reader import Pane, read_panes
from clerestory.scene.desk_views import DESK_VIEWS, desk_views
from clerestory.scene.glazing import glazing_panes, without_glazing
from clerestory.scene.model import Scene
from clerestory.scene.room_grids import RoomGrid
from clerestory.scene.scaling import METRES, Unit, scaled
from clerestory.scene.scene_checks import warn_of_scene
from clerestory.scene.sensors import read_sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window
from clerestory.sky.weather_formats import read_weather
from clerestory.study import study_files
from clerestory.study.new_windows import (
    NewWindow,
    Panes,
    faces_left_out,
    sorted_windows,
)

STUDY_FILE, SENSOR_FILE, VIEW_FILE = "study.toml", "workplane.pts", "desk.vf"

# Window file of panes that are taken out of the scene
WINDOW_FILE = "panes.rad"

# Glazing of windows for which no BSDF is given
GLAZING = f"{LIBRARY_PREFIX}double-lowe-6"

_HEAD = """# Paths are relative to this file; docs/study-file.md explains every key.
# rotation_deg is the azimuth of the +y axis of the scene, clockwise from north.

"""

# Weather of the demo study: TMY3 year of Greensboro, North Carolina, from pvlib
_WEATHER = "723170TYA.CSV"

# Title and BSDF file of the demo study
_DEMO_BLIND = ("FLEXLAB test room, venetian blind", "venetian_blind.xml")


@dataclass(frozen=True)
class NewStudy:
    """Study file, numbers of sensors, rooms, windows and views; reversed windows.

    `faces` is the number of faces that are left out, by name of the panes.
    """

    study: Path
    sensors: int
    turned: tuple[str, ...]
    rooms: int = 1
    views: int = 0
    windows: int = 1
    faces: Mapping[str, int] = field(default_factory=dict)


def begin_study(
    folder: str | Path,
    *,
    scene: Sequence[str | Path],
    bsdf: str | Path,
    weather: str | Path,
    windows: Sequence[str | Path] = (),
    glazing: Sequence[str] = (),
    sensors: str | Path | None = None,
    spacing: float = 0.5,
    height: float = 0.76,
    units: Unit = "metres",
    views: bool = False,
) -> NewStudy:
    """Write a study file for rooms, by default with a sensor grid above each floor.

    Rooms are separated by walls up to the ceiling; each has a grid of its own. With
    `views`, fisheye views are proposed at the desk nearest to the windows of each room,
    along and towards the façade, for pictures and glare.

    Panes are the polygons of the files `windows`, or those of the materials `glazing`
    in the scene. Of panes modelled as solids, or as parallel faces up to 0.1 m apart,
    the face towards the room is used. Panes whose back faces the room are turned in a
    copy; those of several rooms or orientations are written as several windows.
    Warnings are issued for probable mistakes, such as glazing left in the scene.
    `units` is the unit of length of the scene, the windows and the sensors; `spacing`
    and `height` are in metres.
    """
    one_of(units, "units", choices=METRES)
    metres = METRES[units]
    folder = Path(folder)
    exists = (folder / STUDY_FILE).exists()
    require(not exists, "contains a study; a new folder expected", file=folder)
    words = "both window files and" if windows else "neither window files nor"
    require(
        bool(windows) != bool(glazing),
        f"{words} materials of the glazing; one of them expected",
    )
    whole = read_rad(*scene)
    files = _panes(whole, windows, glazing)
    room = scaled(without_glazing(whole, glazing), metres)
    read_bsdf(bsdf)
    read_weather(weather)
    grid = {"spacing": spacing, "height": height}
    groups, rooms = sorted_windows(
        room, files, metres=metres, grid=None if sensors and not views else grid
    )
    out = faces_left_out(files, groups)
    every = [group for found in groups.values() for group in found]
    warn_of_scene(room, [scaled(group.window, metres) for group in every])
    grids = (
        [each.sensors for each in rooms]
        if sensors is None
        else [scaled(read_sensors(sensors), metres)]
    )
    eyes = [desk_views(room, each, height=height) if views else [] for each in rooms]
    _warn_of_omitted(rooms, eyes if views else [])

    # Write files only after all input files are read
    make_folder(folder)
    shown = [
        file
        for given, found in groups.items()
        for file in _files(
            folder,
            given,
            found,
            copied=bool(glazing) or any(file == given for file, _ in out),
        )
    ]
    kept: list[str | Path] = [] if sensors is None else [sensors]
    if sensors is None:
        kept += [
            study_files.write_sensors(folder / name, scaled(one, 1 / metres))
            for name, one in zip(_numbered(SENSOR_FILE, grids), grids, strict=True)
        ]
    seen = [scaled(view, 1 / metres) for each in eyes for view in each]
    for name, view in zip(_numbered(VIEW_FILE, seen), seen, strict=True):
        write_text(folder / name, f"rvu {format_view(view)}\n")
    layer = str(bsdf)
    if not is_library_name(bsdf):
        layer = study_files.relative_path(bsdf, folder)
    tables = {
        "title": folder.resolve().name,
        "method": "3-phase",
        "scene": {
            "files": [study_files.relative_path(file, folder) for file in scene],
            **({} if units == "metres" else {"units": units}),
            **({"glazing": list(glazing)} if glazing else {}),
        },
        "window": [
            {"file": study_files.relative_path(f, folder), "bsdf": layer} for f in shown
        ],
        "sensors": [{"file": study_files.relative_path(f, folder)} for f in kept],
        **({"view": [{"file": f} for f in _numbered(VIEW_FILE, seen)]} if seen else {}),
        "weather": {"file": study_files.relative_path(weather, folder)},
        "sky": {"rotation_deg": 0.0},
        "trace": {"relative_error": 0.01},
        "schedule": {"from_hour": 8, "to_hour": 18},
    }
    write_text(folder / STUDY_FILE, _HEAD + study_files.study_text(tables))
    return NewStudy(
        folder / STUDY_FILE,
        sum(map(len, grids)),
        tuple(dict.fromkeys(g.window.name for g in every if g.turned)),
        rooms=len(rooms) or 1,
        views=len(seen),
        windows=len(every),
        faces={name: count for (_, name), count in out.items()},
    )


def _panes(
    scene: Scene, windows: Sequence[str | Path], glazing: Sequence[str]
) -> dict[Path, Panes]:
    # Panes by file and modifier; those of the scene are written to a file
    if windows:
        return {Path(file): read_panes(file) for file in windows}
    found = glazing_panes(scene, glazing)
    return {
        Path(WINDOW_FILE): {
            name: [Pane(polygon, "full", None) for polygon in polygons]
            for name, polygons in found.items()
        }
    }


def _files(
    folder: Path, given: Path, found: Sequence[NewWindow], *, copied: bool
) -> list[Path]:
    # The given file, a copy with panes changed, or a file for each window group
    if not found:
        return []
    copied |= any(group.turned for group in found)
    if all(group.whole for group in found):
        if copied:
            text = "\n".join(_text(group.window) for group in found)
            write_text(folder / given.name, text)
        return [folder / given.name if copied else given]
    names = _numbered(given.name, found)
    for name, group in zip(names, found, strict=True):
        write_text(folder / name, _text(group.window))
    return [folder / name for name in names]


def _warn_of_omitted(rooms: Sequence[RoomGrid], eyes: Sequence[Sequence[View]]) -> None:
    for room, found in zip(rooms, eyes, strict=False):
        if len(found) < DESK_VIEWS:
            warnings.warn(
                f'the desk behind window "{room.windows[0].name}" faces a partition or'
                f" a wall less than 1 m away: {DESK_VIEWS - len(found)} of {DESK_VIEWS}"
                " views omitted; add views of your own",
                ClerestoryWarning,
                stacklevel=3,
            )


def _numbered(name: str, of: Sequence[object]) -> list[str]:
    # A name for each item: the name itself if there is only one
    stem, suffix = name.rsplit(".", 1) if "." in name else (name, "rad")
    several = [f"{stem}_{number}.{suffix}" for number, _ in enumerate(of, start=1)]
    return several if len(of) > 1 else [name] * len(of)


def _text(window: Window) -> str:
    # Radiance text of a window; vertices are counter-clockwise as seen from the room
    outlines = [polygon.vertices for polygon in window.polygons]
    return study_files.window_text(window.name, outlines, up=window.frame.up)


def write_demo(folder: str | Path, *, bsdf: str | Path | None = None) -> Path:
    """Copy the demo study into a folder, created if missing; return its study file.

    The room has a venetian blind, or `bsdf`, a BSDF file or the name of a built-in
    product. Existing files are not overwritten.

    Raises
    ------
    InputError : a BSDF is given, but cannot be read, or the folder has a study already
    """
    folder = Path(folder)
    study = folder / STUDY_FILE
    if bsdf is not None:
        read_bsdf(bsdf)
        message = "a study is here already; another folder expected with a BSDF"
        require(not study.exists(), message, file=study)
    make_folder(folder)
    bundled = importlib.resources.files("clerestory") / "demo"
    weather = importlib.resources.files("pvlib") / "data" / _WEATHER
    for source in (*bundled.iterdir(), weather):
        target = folder / source.name
        if source.is_file() and not target.exists():
            with replace_file(target) as stream:
                stream.write(source.read_bytes())
    if bsdf is not None:
        _replace_blind(study, bsdf)
    return study


def _replace_blind(study: Path, bsdf: str | Path) -> None:
    # Another BSDF, and its name in the title of the demo study
    path, name = str(bsdf), Path(bsdf).stem.removeprefix(LIBRARY_PREFIX)
    if not is_library_name(bsdf):
        path = study_files.relative_path(bsdf, study.parent)
    title, file = _DEMO_BLIND
    text = study.read_text(encoding="utf-8").replace(" behind a venetian blind", "")
    text = text.replace(f'"{title}"', toml_value(f"FLEXLAB test room, {name}"))
    write_text(study, text.replace(f'"{file}"', toml_value(path)))
