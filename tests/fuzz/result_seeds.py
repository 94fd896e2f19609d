"""Studies, matrices, results, schedules and measured series."""

import importlib
import importlib.resources
import io
import runpy
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
from optics_seeds import sealed
from reader import Reader

import clerestory as cl
from sample_files import SCAN, four_sensors

TESTS = Path(__file__).parents[1]
DEMO = Path(cl.__file__).parent / "demo"
ROOM = TESTS / "cli" / "room"


def _matrices(_: Path) -> list[bytes]:
    values = np.random.default_rng(0).uniform(0, 1, (3, 4, 3))
    head = "#?RADIANCE\nrmtxop a.mtx\nNROWS=3\nNCOLS=4\nNCOMP=3\nFORMAT={}\n\n"
    text = "\n".join(" ".join(f"{v:.5g}" for v in row.ravel()) for row in values)
    return [
        (head.format("ascii") + text + "\n").encode(),
        head.format("float").encode() + values.astype("<f4").tobytes(),
        head.format("double").encode() + values.astype("<f8").tobytes(),
    ]


def _netcdf(folder: Path) -> list[bytes]:
    axis = importlib.import_module("clerestory.matrix.axis")
    netcdf = importlib.import_module("clerestory.matrix.netcdf")
    values = np.random.default_rng(0).uniform(0, 1, (3, 4, 5))
    matrix = cl.TransferMatrix(values, axis.sensor_axis(4), axis.unknown_axis(5))
    netcdf.write_netcdf(folder / "seed.nc", matrix)
    return [(folder / "seed.nc").read_bytes()]


LOGGER = """utc_offset_hours = -6
[[logger]]
file = "log.csv"
time = "when"
columns = {"lux.1" = "A"}
"""
LOG = "when,A\n2024-06-26T08:30,100\n2024-06-26T08:35,110\n"


def _measured(function: Callable[..., object], path: Path) -> object:
    return function(path, near=four_sensors())


def _plain(function: Callable[..., object], path: Path) -> object:
    return function(path, utc_offset_hours=1.0)


def _study(folder: Path) -> list[bytes]:
    for file in DEMO.iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    weather = folder / "723170TYA.CSV"
    shutil.copy(importlib.resources.files("pvlib") / "data" / weather.name, weather)
    return [(DEMO / "study.toml").read_bytes(), BLINDS.encode()]


def room(folder: Path) -> None:
    for file in ROOM.iterdir():
        shutil.copy(file, folder)
    analytic = importlib.import_module("clerestory.bsdf.analytic")
    klems = importlib.import_module("clerestory.hemisphere.klems")
    writer = importlib.import_module("clerestory.bsdf.xml_writer")
    layer = analytic.lambertian(0.5, klems.klems("quarter"))
    writer.write_bsdf(folder / "diffuser.xml", layer)


def _room_study(folder: Path) -> list[bytes]:
    room(folder)
    return [(ROOM / "study.toml").read_bytes()]


def _inputs(function: Callable[..., object], path: Path) -> object:
    study = importlib.import_module("clerestory.study.inputs")
    return study.read_inputs(function(path))


# ------------------------------------- Results -------------------------------------
def _results(folder: Path) -> None:
    made = runpy.run_path(str(TESTS / "unit" / "report" / "analytic_room.py"))
    points = made["desk_points"](spacing=3.0)
    few = made["analytic_results"](times=made["year"](days=1), points=points)
    storage = importlib.import_module("clerestory.study.results")
    storage.save_results(few, folder)


def _results_nc(folder: Path) -> list[bytes]:
    _results(folder)
    (folder / "run.json").unlink()
    return [(folder / "results.nc").read_bytes()]


def _run_json(folder: Path) -> list[bytes]:
    _results(folder)
    return [(folder / "run.json").read_bytes(), RUN.encode()]


def _reported(function: Callable[..., object], path: Path) -> object:
    content = importlib.import_module("clerestory.report.content_from_results")
    return content.from_results(function(path.parent))


def _tables(function: Callable[..., object], path: Path) -> object:
    content = importlib.import_module("clerestory.report.content_from_results")
    return content.run_tables(function(path))


# ------------------------------------ Honeybee ------------------------------------
def _honeybee(folder: Path, name: str) -> list[bytes]:
    honeybee = importlib.import_module("clerestory.metrics.honeybee_writer")
    times = np.datetime64("2023-01-01T00:30", "s") + np.arange(24) * 3600
    lux = {"desks": np.tile(100.0 + np.arange(24), (3, 1))}
    honeybee.write_honeybee(folder, lux, times, direct=lux)
    (folder / "grid_states.json").write_text('{"desks": {"south": ["up", "down"]}}')
    return [(folder / name).read_bytes()]


def _folder(function: Callable[..., object], path: Path) -> object:
    while not (path / "grids_info.json").exists() and path != path.parent:
        path = path.parent
    found = function(path)
    return [found.illuminance(grid) for grid in found.paths]


def _honeybee_reader(name: str) -> Reader:
    return Reader(
        "metrics.honeybee:read_honeybee",
        name,
        make=lambda folder: _honeybee(folder, name),
        use=_folder,
    )


RUN = """{"seed": 1, "seconds": {"tracing": 1.5}, "warnings": ["one"],
 "versions": {"clerestory": "0.2"}, "matrices": {"V-0123.nc": {"found": true}},
 "study": {"method": "3-phase", "window": [{"name": "south"}]}, "device": "cpu"}
"""
BLINDS = """title = "Blinds"
method = "3-phase"
[scene]
files = ["room.rad"]
[[window]]
name = "south"
file = "window.rad"
[window.control]
rule = "fixed"
state = "down"
[[window.state]]
name = "up"
bsdf = "double_pane.xml"
[[window.state]]
name = "down"
bsdf = "venetian_blind.xml"
[[sensors]]
file = "desks.pts"
[weather.clear_sky]
latitude_deg = 50.0
longitude_deg = 8.5
utc_offset_hours = 1
[trace]
samples = 100
"""


SWEEP = """[sweep]
sky.rotation_deg = [0, 90]
trace.seed = [1, 2]
"""
VARIANT = """[[variant]]
name = "more paths"
trace.samples = 200
"""


def _sweep(folder: Path) -> list[bytes]:
    _study(folder)
    return [(BLINDS + more).encode() for more in (SWEEP, VARIANT)]


def _folder_of(found, path):
    return found(path.parent)


MATRIX = "#?RADIANCE\nNROWS={}\nNCOLS={}\nNCOMP=3\nFORMAT=ascii\n\n1 1 1 2 2 2\n"


def _times_sky(found, path):
    from clerestory.compat.streams import Streams

    words = [str(path.parent / "dc.mtx"), str(path)]
    return found(words, Streams(sink=io.BytesIO()))


def _rays(form):
    return lambda found, path: found(path, form)


READERS = {
    "sky of dctimestep": Reader(
        "compat.matrix_programs:dctimestep",
        "s.smx",
        ("1 1 1\n2 2 2\n", MATRIX.format(2, 1)),
        beside={"dc.mtx": MATRIX.format(1, 2)},
        use=_times_sky,
    ),
    "rays": Reader(
        "compat.streams:read_rays", "rays.txt", ("0 0 1 0 0 1\n",), use=_rays("a")
    ),
    "binary rays": Reader(
        "compat.streams:read_rays",
        "rays.bin",
        make=lambda _: [np.array([0, 0, 1, 0, 0, 1], "f4").tobytes()],
        use=_rays("f"),
    ),
    "matrix": Reader("cli.multiply:read_any_matrix", "m.mtx", make=_matrices),
    "netcdf": Reader("matrix.netcdf:read_netcdf", "m.nc", make=_netcdf, sealed=sealed),
    "study": Reader("study.config:read_study", "study.toml", make=_study),
    "variants": Reader("study.variants:read_variants", "study.toml", make=_sweep),
    "finished variants": Reader(
        "study.variant_run:_finished",
        "finished.json",
        ('{"a": "0123", "b": "4567"}',),
        use=_folder_of,
    ),
    "study inputs": Reader(
        "study.config:read_study", "study.toml", make=_room_study, use=_inputs
    ),
    "results": Reader(
        "study.results:read_results", "results.nc", make=_results_nc, use=_reported
    ),
    "run facts": Reader(
        "study.results:_read_run", "run.json", make=_run_json, use=_tables
    ),
    "honeybee grids": _honeybee_reader("grids_info.json"),
    "honeybee states": _honeybee_reader("grid_states.json"),
    "honeybee hours": _honeybee_reader("sun-up-hours.txt"),
    "honeybee array": _honeybee_reader("__static_apertures__/default/total/desks.npy"),
    "schedule": Reader(
        "control.schedule:read_schedule",
        "s.csv",
        ("time,south\n2023-01-01T08:00,1\n2023-01-01T18:00,0\n",),
    ),
    "mapping": Reader(
        "comparison.mapping:read_measured_series",
        "m.toml",
        (SCAN, LOGGER),
        beside={"nine.csv": "south, broken, north\n1, 9, 2\n3, 9, 4\n", "log.csv": LOG},
        use=_measured,
    ),
    "mapped grid": Reader(
        "comparison.mapping:read_measured_series",
        "nine.csv",
        ("south, broken, north\n1, 9, 2\n3, 9, 4\n",),
        beside={"m.toml": SCAN},
        use=lambda function, path: _measured(function, path.with_name("m.toml")),
    ),
    "measured series": Reader(
        "comparison.logger_files:read_plain",
        "log.csv",
        ("time,lux.1\n2024-06-26T08:30,100\n2024-06-26T08:35,110\n",),
        use=_plain,
    ),
}
