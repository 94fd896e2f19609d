"""Names that are commands, through every writer, read by Radiance and by the library.

A command in a name makes a marker file if it is executed. Radiance's own programs read
what is written.
"""

import ast
import csv
import importlib.resources
import json
import re
import subprocess
import tomllib
import warnings
import zipfile
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import xarray as xr
from hostile_names import MARKER, NAMES, more_names, require_no_marker
from result_seeds import _results
from scene_seeds import _hbjson

import clerestory
from clerestory import escaping
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Detail, Product
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.mgf_text import mgf_text
from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.cli.progress import _bars, say
from clerestory.comparison.calibration_model import CalibrationModel
from clerestory.comparison.calibration_output import write_calibration
from clerestory.comparison.calibration_run import CalibratedStudy
from clerestory.comparison.comparison_output import _write_csv
from clerestory.comparison.time_alignment import Pairs
from clerestory.control.schedule import StateSchedule, read_schedule, write_schedule
from clerestory.energyplus.input_objects import InputObject, object_name, write_objects
from clerestory.escaping import terminal_text
from clerestory.files import write_text
from clerestory.formats.hbjson import read_hbjson
from clerestory.formats.mgf import parse_mgf
from clerestory.hemisphere.klems import klems
from clerestory.image.exr import read_exr, write_exr
from clerestory.image.picture import Picture
from clerestory.image.radiance_hdr import read_radiance, write_radiance
from clerestory.matrix.axis import Axis, unknown_axis
from clerestory.matrix.netcdf import read_netcdf, write_netcdf
from clerestory.matrix.radiance_format import read_matrix, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.metrics.honeybee import STATIC, read_honeybee
from clerestory.metrics.honeybee_writer import write_honeybee
from clerestory.phases.matrix_store import MatrixStore
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.rad_writer import format_rad
from clerestory.radiance.window_reader import read_windows
from clerestory.recipes import grid_summary
from clerestory.recipes.annual import AnnualLight
from clerestory.recipes.breeam_credits import write_credits
from clerestory.recipes.en17037_levels import write_levels
from clerestory.recipes.grid_glare import write_glare
from clerestory.recipes.leed_credits import write_points
from clerestory.recipes.model import read_model
from clerestory.recipes.outputs import _write_hourly
from clerestory.report.bsdf_plot import share_figure
from clerestory.report.calibration_page import write_calibration_page
from clerestory.report.embedded_data import figure_png
from clerestory.report.markup import element, embedded_json, render
from clerestory.report.page_assets import content_policy
from clerestory.report.variants_page import write_variants_page
from clerestory.scene.model import Mirror, Mixture, Plastic, Polygon, Scene
from clerestory.study.model_import import write_building_model
from clerestory.study.outputs import (
    _METRICS,
    write_energy,
    write_hourly,
    write_lighting,
    write_metrics,
)
from clerestory.study.results import Results, read_results, save_results
from clerestory.study.spectral_table import write_spectra
from clerestory.study.study_files import study_text, window_text
from clerestory.study.title_block import TitleBlock
from clerestory.study.unknown_quantities import UnknownQuantities
from clerestory.study.variant_figures import RunFigures, VariantFigure
from clerestory.study.variant_outputs import write_variants
from clerestory.study.view_grid_outputs import write_grid_dgp, write_grid_views
from clerestory.study.vtkjs import Surfaces, write_vtkjs
from clerestory.uncertainty.calibration import calibrate
from clerestory.uncertainty.distributions import normal
from clerestory.uncertainty.draws import Unknown
from clerestory.uncertainty.expansion import Expansion, Part
from clerestory.uncertainty.residual_covariance import SensorErrors

pyradiance = pytest.importorskip("pyradiance", reason="Radiance reads the files")
BIN = Path(pyradiance.__file__).parent / "bin"
ALL = list(dict.fromkeys([*NAMES, *more_names(150)]))
GREY = np.full(3, 0.5)
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    require_no_marker(tmp_path)


def radiance(command, folder, **options):
    """Output of a Radiance program that accepts its input."""
    program, *words = command
    path = {"PATH": f"{BIN}:/usr/bin:/bin", "RAYPATH": f".:{BIN.parent / 'lib'}"}
    done = subprocess.run(
        [str(BIN / program), *map(str, words)],
        cwd=folder,
        capture_output=True,
        check=False,
        env=path,
        timeout=120,
        **options,
    )
    assert done.returncode == 0, f"{command}: {done.stderr[-500:]!r}"
    require_no_marker(folder)
    return done.stdout


def scene_of(names):
    surfaces, materials = [], {}
    for number, name in enumerate(names):
        if name:
            materials[name] = Plastic(name, GREY)
        key = name or "plain"
        surfaces.append(Polygon(np.add(SQUARE, [0, 0, number]), key, name))
    return Scene(materials, tuple(surfaces))


# ------------------------------- Rules of escaping -------------------------------
@pytest.mark.parametrize(
    "rule",
    [escaping.radiance_name, escaping.file_stem, escaping.table_cell],
    ids=lambda rule: rule.__name__,
)
def test_different_names_remain_different(rule):
    found = {}
    for name in [*ALL, *(rule(name) for name in ALL)]:
        assert found.setdefault(rule(name), name) == name


def test_plain_names_are_unchanged():
    for name in ("wall", "wall#2", "a-b_c.d", "50%", "[1]", "a=b"):
        assert escaping.radiance_name(name) == name
        assert escaping.table_cell(name) == name
    assert escaping.file_stem("Büro 3.b") == "Büro 3.b"


def test_file_names_differ_whatever_the_case(folder):
    stems = escaping.file_stems(ALL)
    assert len({stem.casefold() for stem in stems.values()}) == len(stems)
    for stem in stems.values():
        write_text(folder / f"{stem}.txt", "")
    written = {path.stem for path in folder.iterdir()}
    assert written == set(stems.values())


# ------------------------------------- Scenes -------------------------------------
def test_radiance_reads_a_scene_of_hostile_names(folder):
    """As many surfaces after two passes of xform as before, and the names we wrote."""
    scene = scene_of(ALL)
    write_text(folder / "scene.rad", format_rad(scene, bsdf_file={}))
    once = radiance(["xform", "scene.rad"], folder)
    (folder / "once.rad").write_bytes(once)
    twice = radiance(["xform", "-n", "p", "once.rad"], folder)
    (folder / "twice.rad").write_bytes(twice)
    (folder / "scene.oct").write_bytes(radiance(["oconv", "twice.rad"], folder))
    radiance(["getinfo", "scene.oct"], folder)
    rays = "".join(f".7 .2 {z + 0.5} 0 0 -1\n" for z in range(len(ALL))).encode()
    hit = radiance(["rtrace", "-h", "-oM", "scene.oct"], folder, input=rays)
    ours = [escaping.radiance_name(s.material) for s in scene.surfaces]
    assert hit.decode().split("\t\n")[:-1] == ours
    read = read_rad(folder / "scene.rad")
    assert [s.material for s in read.surfaces] == ours
    assert [s.name for s in read_rad(folder / "once.rad").surfaces] == [
        s.name for s in read.surfaces
    ]


def test_names_within_materials_are_escaped(folder):
    """Alternates of mirrors and parts of mixtures are written by the same name."""
    scene = Scene()
    for number, name in enumerate(name for name in NAMES if name):
        part, other = Plastic(name, GREY), Plastic(f"{name}2", GREY / 2)
        mixed = Mixture(f"{name}3", part, other, 0.5)
        mirror = Mirror(f"{name}4", GREY, part)
        used = [
            Polygon(np.add(SQUARE, [k, 0, number]), m.name, name)
            for k, m in ((0, mixed), (2, mirror))
        ]
        scene += Scene({m.name: m for m in (mixed, mirror)}, tuple(used))
    write_text(folder / "scene.rad", format_rad(scene, bsdf_file={}))
    assert radiance(["oconv", "scene.rad"], folder)
    assert len(read_rad(folder / "scene.rad").surfaces) == len(scene.surfaces)


def test_words_that_cannot_be_quoted_are_refused():
    for word in ("", "a\nb", '"a', "!cmd", "'a b\"", "x" * 512, "a\0b", "\ud800"):
        with pytest.raises(clerestory.InputError, match="a word of a scene file is"):
            escaping.radiance_word(word)


def test_rfluxmtx_runs_no_name_of_a_window(folder):
    """`rfluxmtx` puts the modifiers of receivers into a command line of a shell."""
    grey = scene_of(["grey"])
    write_text(folder / "grey.rad", format_rad(grey, bsdf_file={}))
    for number, name in enumerate(n for n in NAMES if n.strip()):
        outline = SQUARE[:, [0, 2, 1]]
        write_text(folder / "window.rad", window_text(name, [outline], basis="kq"))
        [window] = read_windows(folder / "window.rad")
        assert window.name == escaping.radiance_name(name)
        if number % 4 == 0:
            options = ["-ab", "0", "-c", "1", "-h", "-faa"]
            command = ["rfluxmtx", *options, "-", "window.rad", "grey.rad"]
            made = radiance(command, folder, input=b".7 1 .2 0 -1 0\n")
            assert len(made.split()) == 3 * 41
            assert float(made.split()[0]) >= 0


@pytest.mark.parametrize("name", [n for n in NAMES if n and len(n) < 3000][::3])
def test_packages_of_bsdfs_run_no_product_name(folder, name, monkeypatch):
    from clerestory.cli.bsdf_package import package
    from clerestory.cli.requests.bsdf import PackageBsdf

    parts = lambertian(0.5, klems("quarter")).functions
    product = Product(name=name, manufacturer=name, width=1.0, height=1.0)
    write_bsdf(
        folder / "a.xml",
        Bsdf(parts, product),
        comment=name,
    )
    package(PackageBsdf(file=folder / "a.xml", output=folder / "a.rad", xform=""))
    assert radiance(["oconv", "a.rad"], folder)
    (folder / "b.rad").write_bytes(radiance(["xform", "a.rad"], folder))
    assert len(read_rad(folder / "b.rad").surfaces) == 1


# ------------------------------------- Imports -------------------------------------
def hostile_model(folder, names):
    """A honeybee model with these names everywhere, and fewer than a second each."""
    model = json.loads(_hbjson(folder)[0])
    [room] = model["rooms"]
    model["display_name"] = names[0]
    radiance = model["properties"]["radiance"]
    [grid] = radiance["sensor_grids"][:1]
    radiance["sensor_grids"] = [grid | {"identifier": n} for n in names]
    for part, name in zip(room["faces"], names, strict=False):
        part["identifier"] = name
    shade = room["faces"][0]["geometry"]
    modifiers = [
        {
            "type": "Plastic",
            "identifier": f"{name}-shade",
            **{f"{c}_reflectance": 0.1 + number / 1000 for c in "rgb"},
        }
        for number, name in enumerate(names)
    ]
    radiance["modifiers"] = [*radiance.get("modifiers", []), *modifiers]
    model["orphaned_shades"] = [
        {
            "identifier": name,
            "geometry": shade,
            "properties": {"radiance": {"modifier": f"{name}-shade"}},
        }
        for name in names
    ]
    path = folder / "model.hbjson"
    path.write_text(json.dumps(model))
    return path


def test_imports_of_models_run_no_name(folder):
    path = hostile_model(folder, ALL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = read_hbjson(path)
    model = replace(model, views={}, windows=())
    out = folder / "out"
    weather = importlib.resources.files("pvlib") / "data" / "723170TYA.CSV"
    written = write_building_model(model, out, weather=Path(str(weather)))
    inside = set(out.rglob("*"))
    assert set(written.files) == inside
    assert len(written.files) == len(inside)
    assert all(path.parent == out for path in inside)
    assert len(read_rad(out / "scene.rad").materials) >= len(ALL)
    radiance(["xform", "out/scene.rad"], folder)
    study = tomllib.loads((out / "study.toml").read_text())
    assert len(study["sensors"]) == len(ALL)
    assert len({table["file"].casefold() for table in study["sensors"]}) == len(ALL)


# ------------------------------- Matrices and pictures -------------------------------
def test_headers_of_matrices_stay_headers(folder):
    values = np.arange(6.0).reshape(3, 1, 2)
    matrix = TransferMatrix(values, unknown_axis(1), unknown_axis(2))
    for name in ALL:
        write_matrix(folder / "a.mtx", matrix, command=f"made of {name}")
        assert np.array_equal(read_matrix(folder / "a.mtx").values, values)
        assert (folder / "a.mtx").read_bytes().count(b"\n\n") == 1
    for name in NAMES[::5]:
        write_matrix(folder / "a.mtx", matrix, command=f"made of {name}")
        shown = radiance(["rmtxop", "-fa", "a.mtx"], folder)
        assert len(shown.split(b"\n\n")[-1].split()) == 6


def test_headers_of_pictures_stay_headers(folder):
    for name in ALL:
        lines = (f"made of {name}", f"\t{name}")
        picture = Picture(np.full((2, 3, 3), 0.5, np.float32), header=lines)
        write_radiance(picture, folder / "a.hdr")
        read = read_radiance(folder / "a.hdr")
        assert read.radiance.shape == (2, 3, 3)
        assert np.allclose(read.radiance, 0.5, rtol=0.01)
    for name in NAMES[::5]:
        lines = (f"made of {name}", f"\t{name}")
        picture = Picture(np.full((2, 3, 3), 0.5, np.float32), header=lines)
        write_radiance(picture, folder / "a.hdr")
        assert b"-Y 2 +X 3" in radiance(["getinfo", "-d", "a.hdr"], folder)
        shown = radiance(["pvalue", "-h", "-H", "-d", "a.hdr"], folder)
        assert np.allclose([float(x) for x in shown.split()], 0.5, rtol=0.01)
        write_exr(picture, folder / "a.exr")
        assert len(read_exr(folder / "a.exr").header) <= 2


def test_netcdf_holds_any_name(folder):
    names = tuple(dict.fromkeys(map(escaping.printable, ALL)))
    assert len(names) == len(ALL)
    for name in ALL:
        axis = Axis("interior", 2, window=name)
        matrix = TransferMatrix(np.ones((3, 1, 2)), unknown_axis(1), axis)
        write_netcdf(folder / "a.nc", matrix)
        assert read_netcdf(folder / "a.nc").columns.window == escaping.printable(name)
    axis = Axis("sensor", len(ALL), names=tuple(ALL))
    matrix = TransferMatrix(np.ones((3, len(ALL), 1)), axis, unknown_axis(1))
    write_netcdf(folder / "a.nc", matrix)
    assert read_netcdf(folder / "a.nc").rows.names == names


def test_stored_matrices_of_different_names_are_different_files(folder):
    store = MatrixStore(folder)
    paths = [store.path(name, "0" * 64) for name in ALL]
    assert len(set(paths)) == len(ALL)
    assert all(path.parent == folder for path in paths)


# ------------------------------------ XML, HTML ------------------------------------
def test_bsdf_files_hold_any_text(folder):
    parts = lambertian(0.5, klems("quarter")).functions
    for name in NAMES:
        product = Product(
            name=name, manufacturer=name, details=(Detail("Source", name or "x", name),)
        )
        bsdf = Bsdf(parts, product)
        write_bsdf(folder / "a.xml", bsdf, comment=name)
        read = read_bsdf(folder / "a.xml").product
        shown = escaping.xml_text(name).replace("\r", "\r").strip()
        assert read.name == read.manufacturer == shown
        tree = ET.parse(folder / "a.xml")
        assert sum(1 for _ in tree.iter()) > 50


class Elements(HTMLParser):
    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        self.found.append(tag)
        assert not [name for name, _ in attrs if name.startswith("on")]


def test_pages_hold_any_text(folder):
    for name in ALL:
        comparisons = {
            "policy": content_policy(""),
            "title": name,
            "style": "",
            "limits": "",
            "shares": [["group"], [name]],
            "comparisons": [(name, [name])],
            "drawings": [{"name": name, "words": name, "address": name}],
            "statistics": [["simulation"], [name]],
        }
        page = render("comparison.html", **comparisons)
        page += element("p", name, title=name) + embedded_json("data", {"n": name})
        write_text(folder / "a.html", page)
        parser = Elements()
        parser.feed((folder / "a.html").read_text())
        assert parser.found.count("script") == 1
        assert parser.found.count("img") == 1


def test_figures_show_any_name(folder):
    """Matplotlib would read a formula between two $, and refuse what is none."""
    bsdf = lambertian(0.5, klems("quarter"))
    for name in (*NAMES[::6], r"$\frac$", "$a_$", r"\$x$"):
        figure = share_figure([bsdf], names=[name])
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Glyph")
            figure_png(figure, dpi=20)


def test_terminals_execute_no_name(capsys):
    hostile = "".join(map(chr, [*range(1, 32), 127, 155, 0x202E])) + "\udcff"
    say(f"a\x1b[2J{hostile}", *(name for name in ALL))
    shown = capsys.readouterr().out
    assert all(c.isprintable() or c in "\n\t" for c in shown)
    for name in (*ALL, "[/a]", "[red]"):
        assert terminal_text(name).replace("\n", "").replace("\t", "").isprintable()


def test_progress_bars_show_names_with_brackets():
    bars = _bars()
    bars.add_task("[/a] [red]", total=1.0, note="[/b]", left="[/c]")
    bars.make_tasks_table(bars.tasks)


# --------------------------------------- Text ---------------------------------------
def no_formulas(path):
    """Rows of a CSV file, in which spreadsheets find no formula."""
    with path.open(newline="") as stream:
        rows = list(csv.reader(stream))
    for cell in (cell for row in rows for cell in row if cell):
        number = cell.lstrip("+-").replace(".", "").isdecimal()
        assert cell[0] not in "=+-@\t\r＝＋－＠" or number, cell
    return rows


def test_tables_hold_no_formulas(folder):
    _write_csv(folder / "a.csv", [["head", "-1.5"], *([name, name] for name in ALL)])
    rows = no_formulas(folder / "a.csv")
    assert len(rows) == len(ALL) + 1
    assert rows[0] == ["head", "-1.5"]
    assert len({row[0] for row in rows[1:]}) == len(ALL)


def test_tables_over_time_hold_no_formulas(folder):
    """Names of objects of EnergyPlus, and of lighting zones."""
    names, one = np.array(ALL, object), np.zeros((len(ALL), 1))
    data = xr.Dataset(
        {
            "energy": (("energy_use", "time"), np.zeros((1, 1))),
            "operative_temperature": (("thermal_zone", "time"), one),
            "window_solar": (("solar_part", "energy_window", "time"), one[None]),
            "dimming": (("zone", "time"), one),
            "lighting_power": (("zone", "time"), one),
        },
        {
            "energy_use": ["heating"],
            "solar_part": ["incident"],
            "thermal_zone": names,
            "energy_window": names,
            "zone": names,
            "time": np.array(["2001-06-21T12:00"], "datetime64[ns]"),
        },
    )
    write_energy(Results(data), folder / "energy.csv")
    assert len(no_formulas(folder / "energy.csv")) == 2
    write_lighting(Results(data), folder / "lighting.csv")
    assert len(no_formulas(folder / "lighting.csv")) == 2


def test_schedules_return_their_groups(folder):
    names = [escaping.printable(n).strip() for n in ALL if n.strip()]
    names = list(dict.fromkeys(names))
    day = np.array(["2001-06-21T12:00"], "datetime64[s]")
    states = {name: np.array([k % 7]) for k, name in enumerate(names)}
    write_schedule(folder / "a.csv", StateSchedule(day, states))
    no_formulas(folder / "a.csv")
    read = read_schedule(folder / "a.csv").states
    assert len(read) == len(names)
    assert [int(x[0]) for x in read.values()] == [k % 7 for k in range(len(names))]


def test_results_of_hostile_grids_are_tables(folder):
    count, times = len(ALL), np.array(["2001-06-21T12:00"], "datetime64[ns]")
    data = xr.Dataset(
        {
            "illuminance": (("sensor", "time"), np.ones((count, 1))),
            "position": (("sensor", "xyz"), np.zeros((count, 3))),
            "direction": (("sensor", "xyz"), np.zeros((count, 3))),
            "useful_bands": (("band", "sensor"), np.zeros((1, count))),
        },
        {
            "sensor": np.array([f"{n}.1" for n in ALL], object),
            "grid": ("sensor", np.array(ALL, object)),
            "time": times,
            "band": ["a"],
        },
    )
    for name, *_ in _METRICS:
        data[name] = ("sensor", np.zeros(count))
    write_metrics(Results(data), folder / "metrics.csv")
    assert len(no_formulas(folder / "metrics.csv")) == count + 1
    for grid in NAMES[:20]:
        write_hourly(Results(data), folder / "hourly.csv", grid=grid)
        [head, row] = no_formulas(folder / "hourly.csv")
        assert len(head) == len(row) == 2


def test_view_grids_are_tables(folder):
    times = np.array(["2001-06-21T12:00"], "datetime64[ns]")
    for name in NAMES:
        data = xr.Dataset(
            {
                "grid_view_number": ("grid_view", [0]),
                "grid_view_position": (("grid_view", "xyz"), np.zeros((1, 3))),
                "grid_view_azimuth": ("grid_view", [0.0]),
                "grid_view_exceeded_dgp": ("grid_view", [0.4]),
                "grid_view_exceeded_dgp_error": ("grid_view", [0.0]),
                "grid_view_glare_share": (("grid_view", "dgp_limit"), [[0.1]]),
                "grid_view_glare_share_error": (("grid_view", "dgp_limit"), [[0.0]]),
                "grid_view_dgp": (("grid_view", "time"), [[0.4]]),
            },
            {
                "grid_view": np.array([f"{name} 1 0°"], object),
                "view_grid": ("grid_view", np.array([name], object)),
                "dgp_limit": [0.4],
                "time": times,
            },
        )
        write_grid_views(Results(data), folder / "views.csv", grid=name)
        write_grid_dgp(Results(data), folder / "hours.csv", grid=name)
        for table, width in (("views.csv", 11), ("hours.csv", 2)):
            head, row = no_formulas(folder / table)
            assert len(head) == len(row) == width


def test_spectra_of_eyes_are_tables(folder):
    ones = np.ones((1, len(ALL), 2))
    axes = ("photoreceptor", "eye", "time")
    times = np.datetime64("2023-06-21T10:30", "ns") + np.arange(2) * np.timedelta64(
        1, "h"
    )
    data = xr.Dataset(
        {
            "edi": (axes, ones),
            "edi_error": (axes, ones),
            "eye_illuminance": (axes[1:], ones[0]),
        },
        coords={"photoreceptor": ["melanopic"], "eye": ALL, "time": times},
    )
    write_spectra(Results(data), folder / "spectra.csv")
    no_formulas(folder / "spectra.csv")


def test_results_hold_any_name(folder):
    """In coordinates and attributes of results.nc, and in run.json."""
    _results(folder)
    sound = read_results(folder)
    count = sound.data.sizes["sensor"]
    for first in range(0, len(ALL), count):
        names = [*ALL, *ALL][first : first + count]
        data = sound.data.assign_attrs(title=names[0]).assign_coords(
            grid=("sensor", np.array(names, object)),
            sensor=np.array([f"{n}.1" for n in names], object),
        )
        save_results(Results(data, {**sound.run, "warnings": names}), folder)
        found = read_results(folder)
        plain = (name.replace("\0", "\\x00") for name in names)
        shown = [n.encode(errors="backslashreplace").decode() for n in plain]
        assert found.data["grid"].values.tolist() == shown
        assert found.title == shown[0]
        assert found.run["warnings"] == names


def test_study_files_hold_any_text(folder):
    for name in ALL:
        text = study_text({"title": name, "scene": {"files": [name, "b"]}})
        write_text(folder / "a.toml", text)
        read = tomllib.loads((folder / "a.toml").read_text())
        expected = name.encode(errors="replace").decode()
        assert read == {"title": expected, "scene": {"files": [expected, "b"]}}


def test_honeybee_results_hold_any_name(folder):
    times = np.datetime64("2001-01-01T00:30") + np.arange(24) * np.timedelta64(1, "h")
    lux = {name: np.full((1, 24), k + 1.0) for k, name in enumerate(ALL)}
    write_honeybee(folder / "out", lux, times)
    found = read_honeybee(folder / "out")
    values = [found.illuminance(name).values[0, 0] for name in found.paths]
    assert values == [k + 1 for k in range(len(ALL))]
    assert [g["name"] for g in json.loads((folder / "out/grids_info.json").read_text())]


def test_recipe_results_hold_any_name(folder):
    path = hostile_model(folder, ALL)
    model = json.loads(path.read_text())
    for grid in model["properties"]["radiance"]["sensor_grids"]:
        grid["group_identifier"] = grid["identifier"]
    path.write_text(json.dumps(model))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        chosen = read_model(path.rename(folder / "m.hbjson"))
    grids = chosen.grids
    out = folder / "out" / "recipe"
    values = {g.full_id: np.full(g.count, float(k)) for k, g in enumerate(grids)}
    grid_summary.write_metrics(out, grids, {"da": values})
    grid_summary.write_summary(out / "summary.csv", grids, {"da": values})
    light = {g.full_id: np.full((g.count, 1), 1.0) for g in grids}
    arrays = {"total": light, "direct": light}
    times = np.array(["2023-01-01T12:30"], "datetime64[s]")
    annual = AnnualLight(
        grids, times, 1, {STATIC: {"default": arrays}}, np.ones(len(times), bool)
    )
    _write_hourly(out / "hourly", annual, "total")
    write_levels(out / "en17037", chosen, annual, np.ones(1, bool))
    write_credits(out / "breeam", chosen, annual)
    write_points(out / "leed", chosen, annual)
    one, light = np.ones(1), {name: lux / 2 for name, lux in light.items()}
    write_glare(out / "glare", grids, light, one, one > 0, one > 0, 0.4)
    info = json.loads((out / "da" / "grids_info.json").read_text())
    assert len(info) == len(ALL)
    for k, grid in enumerate(info):
        assert float((out / "da" / f"{grid['full_id']}.da").read_text()) == k
        assert (out / "hourly" / f"{grid['full_id']}.ill").is_file()
    assert {f.name for f in folder.iterdir()} <= {"m.hbjson", "out", "a.epw"}
    rows = list(csv.reader((out / "summary.csv").read_text().splitlines()))
    assert not [cell for row in rows[1:] for cell in row if cell.startswith("=")]


def test_mgf_holds_any_name(folder):
    scene = scene_of([name for name in ALL if name])
    text = mgf_text(
        scene, SampleArea(np.array([[0.0, 0, 0], [1, 1, 1]]), periodic=True)
    )
    assert len(parse_mgf(text).surfaces) == len(scene.surfaces)
    write_text(folder / "a.mgf", text)
    made = radiance(["mgf2rad", "a.mgf"], folder)
    (folder / "a.rad").write_bytes(made)
    radiance(["oconv", "a.rad"], folder)
    assert len(read_rad(folder / "a.rad").surfaces) == len(scene.surfaces)


def test_figures_of_variants_hold_any_name(folder):
    """Names of variants in the table, in NetCDF and in the page."""
    names = [*NAMES, *more_names(20)]
    figure = VariantFigure("mean", names[0], "lux", "light", 300.0, 1.0)
    runs = [RunFigures(name, (figure,), {"axis": name}) for name in names]
    write_variants(runs, folder)
    with (folder / "variants.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream))
    assert len(rows) == len(names) + 1
    assert not any(cell.startswith(("=", "@")) for row in rows for cell in row)
    block = TitleBlock(*names[:3], notes="\n\n".join(names))
    write_variants_page(folder / "page.html", runs, title=names[0], title_block=block)
    page = (folder / "page.html").read_text(encoding="utf-8")
    assert "<script" not in page
    require_no_marker(folder)


def test_energyplus_input_holds_any_name(folder):
    """Names with commas, semicolons and comment marks, as IDF text and as epJSON."""
    objects = [
        InputObject("Zone", f"{number}_{object_name(name)}", {"x": 0.0})
        for number, name in enumerate(NAMES)
    ]
    write_objects(folder / "a.idf", objects, comment=NAMES[0])
    lines = (folder / "a.idf").read_text(encoding="utf-8").splitlines()
    text = "".join(line.split("!")[0] for line in lines)
    assert text.count(";") == len(NAMES)
    assert text.count(",") == 2 * len(NAMES)
    write_objects(folder / "a.epJSON", objects)
    document = json.loads((folder / "a.epJSON").read_text(encoding="utf-8"))
    assert len(document["Zone"]) == len(NAMES)


def test_scenes_for_viewers_hold_any_name(folder):
    """Names of datasets and of values in JSON; members of the archive are numbers."""
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    given = [Surfaces(name, corners, {name: np.ones(1)}) for name in NAMES]
    write_vtkjs(folder / "a.vtkjs", given)
    archive = zipfile.ZipFile(folder / "a.vtkjs")
    scene = json.loads(archive.read("index.json"))["scene"]
    assert [each["name"] for each in scene] == list(NAMES)
    members = re.compile(r"(\d+/)?(index.json|data/[0-9a-f]+)")
    assert all(map(members.fullmatch, archive.namelist()))


def _calibrated(names):
    """A fit of quantities and series of the given names."""
    unknowns = tuple(Unknown(name, normal(0.5, 0.1), 0.5) for name in names)
    times = np.datetime64("2024-06-21T12:00", "s") + np.arange(len(names))
    ones, none = np.ones(len(names)), np.zeros(len(names), int)
    rows = np.arange(len(names))
    pairs = Pairs(tuple(names), rows, times, ones, ones, ones, none, none)
    part = Part(np.ones((len(names), 1)), tuple(names))
    reference = dict.fromkeys(names, 0.5)
    model = CalibrationModel(
        unknowns,
        pairs,
        (0.0,),
        (Expansion(reference, ((part,),)),),
        None,
        {},
        SensorErrors(rows, np.zeros((len(names), 1))),
    )
    quantities = UnknownQuantities(unknowns, {}, {}, (), (), "", "", {}, {})
    fit = calibrate(model.predict, pairs.measured, unknowns, relative_error=0.1)
    profiles = ((np.array([0.4, 0.6]), np.array([1.0, 1.0])),) * len(names)
    return CalibratedStudy(fit, quantities, model, ones, ones, (), profiles, 1)


def test_calibrations_hold_any_name(folder):
    """Names of quantities and series in the table, in JSON and in the page."""
    names = [*NAMES, *more_names(6)]
    found = _calibrated(names)
    write_calibration(found, folder)
    with (folder / "calibration_pairs.csv").open(encoding="utf-8", newline="") as f:
        rows = list(csv.reader(f))
    assert len(rows) == len(names) + 1
    assert not any(cell.startswith(("=", "@")) for row in rows for cell in row)
    facts = json.loads((folder / "calibration.json").read_text(encoding="utf-8"))
    assert len(facts["quantities"]) == len(set(names))
    write_calibration_page(folder / "page.html", found, title=names[0])
    assert "<script" not in (folder / "page.html").read_text(encoding="utf-8")
    require_no_marker(folder)


# ----------------------------- Check of the class -----------------------------
# Functions that write files; each is tested above, or writes no text from outside
WRITERS = {
    "bsdf.xml_insertion.insert_blocks": "lxml escapes",
    "bsdf.xml_writer.write_bsdf": test_bsdf_files_hold_any_text,
    "cli.bsdf_generate.generate": test_radiance_reads_a_scene_of_hostile_names,
    "cli.bsdf_library.library": "numbers, and a name of the package",
    "cli.bsdf_package.package": test_packages_of_bsdfs_run_no_product_name,
    "cli.compat._picture": "bytes of standard input",
    "cli.glare._write_annual": "numbers",
    "cli.irradiance.irradiance": "numbers",
    "cli.metrics.metrics": test_tables_hold_no_formulas,
    "cli.sky.sun": "numbers",
    "energyplus.engine_run.convert_to_json": "a copy of the input, for the engine",
    "energyplus.engine_run.simulate": "JSON, for the engine",
    "energyplus.input_objects.write_objects": test_energyplus_input_holds_any_name,
    "comparison.calibration_output.write_calibration": test_calibrations_hold_any_name,
    "comparison.calibration_output.write_calibrated_study": "a path by toml_value",
    "comparison.comparison_output._write_csv": test_tables_hold_no_formulas,
    "comparison.comparison_output.write_tables": "JSON",
    "comparison.mapping.write_layout_sensors": "numbers",
    "compat.genskyvec._described": "a copy of standard input in a temporary folder",
    "compat.programs.install_programs": "names of programs, quoted for a shell",
    "compat.streams.write_matrix": "bytes that write_rows has written",
    "control.schedule.write_schedule": test_schedules_return_their_groups,
    "files.replace_file": "bytes",
    "formats.ifc_extraction.main": "JSON in a temporary folder",
    "formats.ifc_process.read_products": "a copy of the file in a temporary folder",
    "files.write_text": "any text",
    "gonio.fit_storage.write_fits": test_netcdf_holds_any_name,
    "image.camera_response.write_response": "numbers",
    "image.exr.write_exr": test_headers_of_pictures_stay_headers,
    "image.radiance_hdr.write_radiance": test_headers_of_pictures_stay_headers,
    "image.srgb_display.write_display": "pixels",
    "matrix.netcdf.write_netcdf": test_netcdf_holds_any_name,
    "matrix.radiance_format.write_rows": test_headers_of_matrices_stay_headers,
    "metrics.honeybee_writer.write_grids_info": test_recipe_results_hold_any_name,
    "metrics.honeybee_writer.write_states": test_honeybee_results_hold_any_name,
    "phases.illuminance.illuminance": "numbers",
    "radiance.generated_sky.sky_scene": "read by Clerestory alone, one line",
    "radiance.illum_table.write_illums": test_names_within_materials_are_escaped,
    "recipes.breeam_credits.write_credits": test_recipe_results_hold_any_name,
    "recipes.en17037_levels.annual_daylight_en17037": "numbers",
    "recipes.en17037_levels._write": test_recipe_results_hold_any_name,
    "recipes.grid_glare.write_glare": test_recipe_results_hold_any_name,
    "recipes.grid_summary.write_metrics": test_recipe_results_hold_any_name,
    "recipes.grid_summary.write_summary": test_recipe_results_hold_any_name,
    "recipes.grid_summary.write_values": test_recipe_results_hold_any_name,
    "recipes.leed_credits.write_points": test_recipe_results_hold_any_name,
    "recipes.leed_credits._write_sensors": test_recipe_results_hold_any_name,
    "recipes.outputs._write_hourly": test_recipe_results_hold_any_name,
    "recipes.view_outputs.point_in_time_view": "names of files by file_stems, JSON",
    "report.bsdf_view.write_view": test_pages_hold_any_text,
    "report.calibration_page.write_calibration_page": test_calibrations_hold_any_name,
    "report.comparison_page.write_comparison": test_pages_hold_any_text,
    "report.explore_page.write_explorer": test_pages_hold_any_text,
    "report.figure_file.write_figure": "pixels",
    "report.page.write_report": test_pages_hold_any_text,
    "report.pdf.write_pdf": "a page that is listed here",
    "study.annual_view_grids._hourly_file": "numbers",
    "study.design_run.optimise_study": "a table by csv_line",
    "study.design_run.with_values": "by writers that are tested here",
    "study.illuminance_by_state.results_by_state": "numbers",
    "study.method_comparison.compare_methods": test_tables_hold_no_formulas,
    "study.view_grid_outputs.write_grid_dgp": test_view_grids_are_tables,
    "study.view_grid_outputs.write_grid_views": test_view_grids_are_tables,
    "study.model_import._put": test_imports_of_models_run_no_name,
    "study.model_import._bsdf_text": test_imports_of_models_run_no_name,
    "study.model_import.write_building_model": test_imports_of_models_run_no_name,
    "study.new_study.begin_study": test_study_files_hold_any_text,
    "study.new_study._files": test_study_files_hold_any_text,
    "study.new_study._replace_blind": "a text and a path by toml_value",
    "study.new_study.write_demo": "files of the package",
    "study.outputs._write_lines": test_results_of_hostile_grids_are_tables,
    "study.outputs._write_over_time": test_tables_over_time_hold_no_formulas,
    "study.outputs.write_metrics": test_results_of_hostile_grids_are_tables,
    "study.results.save_results": test_results_hold_any_name,
    "study.study_files.write_sensors": "numbers",
    "study.spectral_table.write_spectra": test_spectra_of_eyes_are_tables,
    "study.variant_outputs.write_variants": test_figures_of_variants_hold_any_name,
    "study.variant_run.run_variants": "hashes, and names in JSON",
    "study.vtkjs.write_vtkjs": test_scenes_for_viewers_hold_any_name,
    "report.variants_page.write_variants_page": test_figures_of_variants_hold_any_name,
}
_WRITING = {"write_text", "write_bytes", "replace_file", "replace_path", "mkstemp"}


def _writes(node):
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name in _WRITING
    return False


def test_every_function_that_writes_files_is_listed():
    """Whoever adds a writer adds a test with hostile names, or the reason for none."""
    root, found = Path(clerestory.__file__).parent, set()
    for path in root.rglob("*.py"):
        module = ".".join(path.relative_to(root).with_suffix("").parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and any(map(_writes, ast.walk(node))):
                found.add(f"{module}.{node.name}")
    assert found - {"files.replace_path"} == set(WRITERS)


def test_oconv_runs_a_command_that_is_not_escaped(folder):
    """Radiance runs commands in files: without escaping, the check would fail."""
    (folder / "a.rad").write_text(f"!touch {MARKER}\n")
    subprocess.run([BIN / "oconv", "a.rad"], cwd=folder, capture_output=True)
    assert (folder / MARKER).exists()
    (folder / MARKER).unlink()
