"""Named cases of hostile input, through the command line: one line, at once."""

import ast
import json
import os
import re
import signal
import time
import warnings
from pathlib import Path

import pytest
import xarray as xr
from optics_seeds import COLUMNS, FRED, PABOPTO, SYSTEM, VIAVI
from result_seeds import SCAN, room
from result_seeds import _results as results
from scene_seeds import IES, OBJ
from scene_seeds import _gltf as gltf
from scene_seeds import _hbjson as hbjson
from weather_seeds import STATION

import clerestory
from clerestory.cli.main import main
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import read_bytes
from clerestory.formats.photometry.ies import read_ies
from clerestory.gonio.measurement_files import read_measurement

SOURCE = Path(clerestory.__file__).parent


@pytest.fixture
def folder(tmp_path, monkeypatch):
    place = tmp_path / "project"
    place.mkdir()
    room(place)
    monkeypatch.chdir(place)
    return place


@pytest.fixture
def said(capsys, folder):
    """Status and message of a command, of one line and fewer than 500 characters."""

    def run(*words):
        capsys.readouterr()
        began = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            status = main([str(word) for word in words])
        # What is refused takes no time, but the first command imports the package
        assert time.process_time() - began < 20
        lines = capsys.readouterr().err.splitlines()
        told = [line for line in lines if not line.startswith("warning: ")]
        assert len(told) == (status != 0), told
        assert all(len(line) <= 500 for line in lines)
        assert not any(line.startswith("unexpected ") for line in told)
        return status, "".join(told)

    return run


def change(name, old, new):
    text = Path(name).read_text()
    assert old in text
    Path(name).write_text(text.replace(old, new, 1))


# ------------------------------- Numbers and nesting -------------------------------
DEEP = {
    "lists": "a = " + "[" * 5000 + "]" * 5000,
    "tables": "a = " + "{b=" * 3000 + "1" + "}" * 3000,
    "dotted key": ".".join("a" * 5000) + " = 1",
    "header": "[" + ".".join("a" * 5000) + "]\nx = 1",
    "array of tables": "[[window]]\n[window." + ".".join("a" * 5000) + "]\nx = 1",
    "5000 digits": "a = " + "9" * 5000,
}


@pytest.mark.parametrize("case", DEEP)
def test_deep_nesting_and_long_numbers_of_a_study_are_refused(said, case):
    Path("study.toml").write_text(DEEP[case])
    status, text = said("run", "study.toml")
    assert status == 2
    assert text.startswith("study.toml:")


@pytest.mark.parametrize("digits", [400, 4000, 5000])
def test_a_value_of_thousands_of_digits_is_refused(said, digits):
    change("study.toml", "samples = 256", "samples = " + "9" * digits)
    assert said("run", "study.toml")[0] == 2


def test_long_numbers_and_cells_of_other_files_are_refused(said):
    change("room.rad", "\n12\n", "\n" + "9" * 5000 + "\n")
    assert said("run", "study.toml")[0] == 2
    Path("s.toml").write_text('kind = "venetian"\nspacing = ' + "9" * 4000)
    assert said("bsdf", "generate", "--system", "s.toml", "-o", "a.xml")[0] == 2
    head = '722000,"T",NC,-5.0,36.1,-79.9,273\nDate (MM/DD/YYYY),Time (HH:MM)\n'
    Path("y.csv").write_text(head + "9" * 200_000 + "\n")
    assert said("sky", "describe", "y.csv")[0] == 2


def test_nested_json_is_refused(said):
    Path("m.hbjson").write_text("[" * 900 + "]" * 900)
    assert said("import", "m.hbjson", "-o", "out")[0] == 2
    Path("m.hbjson").write_text('{"a":' * 900 + "1" + "}" * 900)
    assert said("import", "m.hbjson", "-o", "out")[0] == 2


# ------------------------------------ Geometry ------------------------------------
WINDOW = "{head}void glow g 0 0 4 1 1 1 0\ng polygon w 0 0 12 {points}\n"
WINDOWS = {
    "on a line": ("0 0 0 1 0 0 2 0 0 3 0 0", "", "no area"),
    "a point": ("0 0 1 0 0 1 0 0 1 0 0 1", "", "no area"),
    "infinite vertex": ("inf 0 1 1 0 1 1 0 2 4 0 2", "", "number"),
    "infinite axis": ("4 0 1 1 0 1 1 0 2 4 0 2", "u=inf,0,0", "direction"),
    "no axis": ("4 0 1 1 0 1 1 0 2 4 0 2", "u=nan,0,1", "direction"),
    "overflowing axis": ("4 0 1 1 0 1 1 0 2 4 0 2", "u=0,1e300,1e300", "direction"),
}


@pytest.mark.parametrize("case", WINDOWS)
def test_a_window_without_area_or_axis_is_refused(said, capsys, case):
    points, up, _ = WINDOWS[case]
    head = f"#@rfluxmtx h=kf {up}\n"
    Path("window.rad").write_text(WINDOW.format(head=head, points=points))
    status, text = said("run", "study.toml")
    assert status == 2
    assert "window.rad" in text


@pytest.mark.parametrize("metres", ["1e11", "-1e11", "1e15"])
def test_a_vertex_far_away_gives_a_result_or_a_line(said, metres):
    far = f"\ngrey polygon far 0 0 9 {metres} 0 0 {metres} 1 0 {metres} 0 1\n"
    Path("room.rad").write_text(Path("room.rad").read_text() + far)
    assert said("run", "study.toml", "--plan")[0] in (0, 2)


@pytest.mark.parametrize("sensor", ["inf 1 1 0 0 1", "1 1 1 0 0 1e300", "1 1 1 0 0 0"])
def test_a_sensor_without_place_or_direction_is_refused(said, sensor):
    Path("desk.pts").write_text(sensor + "\n")
    status, text = said("run", "study.toml")
    assert status == 2
    assert text.startswith("desk.pts:1:")


# ------------------------------------- Names -------------------------------------
@pytest.mark.parametrize("name", ["a" * 300, "é" * 200, "a" * 5000])
def test_a_name_of_more_than_255_bytes_is_written_or_refused(said, name):
    for key in ("sensors", "window"):
        room(Path())
        head = f"[[{key}]]\n"
        change("study.toml", head, f'{head}name = "{name}"\n')
        change("study.toml", 'name = "south"\n', "") if key == "window" else None
        assert said("run", "study.toml", "--plan")[0] in (0, 2)
    assert said("sky", "matrix", "two_days.wea", "-o", f"{name}.smx")[0] == 1
    assert said("run", f"{name}.toml")[0] == 2
    assert not [path for path in Path().rglob("*.lock")]


# ----------------------------- Pipes, devices, folders -----------------------------
@pytest.fixture(params=["pipe", "zero", "random", "kmsg", "folder", "missing"])
def odd_path(request, folder):
    path = folder / "odd"
    match request.param:
        case "pipe":
            os.mkfifo(path)
        case "zero" | "random":
            path = Path("/dev/zero" if request.param == "zero" else "/dev/urandom")
        case "kmsg":  # a regular file without size; reading waits for messages
            path = Path("/proc/kmsg")
        case "folder":
            path.mkdir()
    return path


COMMANDS = (
    "bsdf info {}",
    "run {}",
    "report {}",
    "sky describe {}",
    "glare {}",
    "picture info {}",
    "picture convert {} -o a.hdr",
    "picture merge {} {} -o a.hdr",
    "gonio info {}",
    "gonio fit {} -o a.nc",
    "glazing stack {}",
    "luminaire info {}",
    "metrics {}",
    "multiply {} {} -o a.mtx",
    "import {} -o out",
    "trace coefficients --scene {} --sensors desk.pts --samples 1 -o a.mtx",
    "trace coefficients --scene room.rad --sensors {} --samples 1 -o a.mtx",
    "render --scene room.rad --view {} -o a.hdr",
    "compare {} {}",
)


@pytest.fixture
def impatient():
    """A test that waits for data which never come fails after a minute."""

    def too_long(*_):
        pytest.fail("waits for a pipe or a device")

    before = signal.signal(signal.SIGALRM, too_long)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("command", COMMANDS)
def test_pipes_devices_and_folders_are_refused_at_once(said, odd_path, command):
    status, text = said(*(word.format(odd_path) for word in command.split()))
    assert status == 2
    assert str(odd_path.name) in text


def test_a_pipe_that_a_shell_passes_is_read(tmp_path):
    reading, writing = os.pipe()
    os.write(writing, b"void plastic")
    os.close(writing)
    assert read_bytes(f"/dev/fd/{reading}") == b"void plastic"
    os.close(reading)


def test_an_output_that_is_no_file_is_left_alone(said, folder):
    os.mkfifo("pipe")
    for output in ("pipe", "/dev/null", "."):
        before = Path(output).stat().st_mode
        command = f"sky matrix two_days.wea --subdivision 1 -o {output}"
        assert said(*command.split())[0] == 1
        assert Path(output).stat().st_mode == before


def test_a_file_larger_than_memory_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "huge"
    with path.open("wb") as stream:
        stream.truncate(1 << 42)
    with pytest.raises(InputError, match="cannot be read"):
        read_bytes(path)


# ---------------------------- Files outside the project ----------------------------
SECRET = (
    "root:$6$tOpSeCrEt:19000:0:99999:7:::\n31337 tOpSeCrEt 'tOpSeCrEt' \"tOpSeCrEt\n"
)
STUDY_KEYS = {
    "scene": ('"room.rad"', '"{}"'),
    "window": ('"window.rad"', '"{}"'),
    "bsdf": ('"diffuser.xml"', '"{}"'),
    "sensors": ('"desk.pts"', '"{}"'),
    "weather": ('"two_days.wea"', '"{}"'),
    "view": ("[weather]", '[[view]]\nname = "v"\nfile = "{}"\n[weather]'),
    "luminaire": (
        "[weather]",
        '[[luminaire]]\nfile = "{}"\nposition = [1, 1, 2]\n[weather]',
    ),
    "schedule": (
        "[[sensors]]",
        '[window.control]\nrule = "schedule"\nfile = "{}"\n[[sensors]]',
    ),
}
STATEMENTS = (
    "!xform {}",
    "!xform -f {} part.rad",
    "!cat {}",
    "!genprism grey p {} -l 0 0 1",
    "!gensurf grey p s t '0' 2 2 -f {}",
    "!ies2rad {}",
    "!mgf2rad {}",
    "!pkgBSDF {}",
    "void instance i 1 {} 0 0",
    "void mesh i 1 {} 0 0",
    "void brightfunc i 2 f {} 0 0",
    "void brightdata i 4 f {} . Px 0 0",
    "void BSDF i 6 0 {} 0 0 1 . 0 0",
)


def secret_of(tmp_path, suffix=""):
    path = tmp_path / f"outside{suffix}"
    path.write_text(SECRET)
    return path


@pytest.mark.parametrize("suffix", ["", ".toml", ".csv"])
@pytest.mark.parametrize("key", STUDY_KEYS)
def test_a_study_does_not_show_files_outside_its_folder(said, tmp_path, key, suffix):
    old, new = STUDY_KEYS[key]
    change("study.toml", old, new.format(secret_of(tmp_path, suffix)))
    status, text = said("run", "study.toml", "--plan")
    assert status == 2
    assert "tOpSeCrEt" not in text
    assert "31337" not in text


@pytest.mark.parametrize("line", STATEMENTS)
def test_a_scene_does_not_show_files_outside_its_folder(said, tmp_path, line):
    Path("part.rad").write_text("")
    text = line.format(secret_of(tmp_path)) + "\n"
    Path("room.rad").write_text(Path("room.rad").read_text() + text)
    status, told = said("run", "study.toml", "--plan")
    assert status in (0, 2)
    assert "tOpSeCrEt" not in told


OTHERS = {
    "glazing stack g.toml": ("g.toml", SYSTEM.replace("a.json", "{}")),
    "sky describe s.toml": ("s.toml", STATION.replace("roof.csv", "{}")),
    "import m.obj -o out": ("m.obj", OBJ.replace("m.mtl", "{}")),
    "luminaire info l.ies": ("l.ies", IES.replace("TILT=NONE", "TILT={}")),
    "compare m.toml two_days.wea": ("m.toml", SCAN.replace("nine.csv", "{}")),
}


@pytest.mark.parametrize("command", OTHERS)
def test_other_files_do_not_show_files_outside_their_folder(said, tmp_path, command):
    name, text = OTHERS[command]
    Path(name).write_text(text.replace("{}", str(secret_of(tmp_path))))
    assert "tOpSeCrEt" not in said(*command.split())[1]


def test_own_files_are_quoted(said):
    Path("desk.pts").write_text("1 1 desk 0 0 1\n")
    assert '"desk"' in said("run", "study.toml")[1]


# ------------------------------------ Sentences ------------------------------------
def test_no_message_has_an_article_before_a_value():
    """The article depends on the value: "of kind {kind}", not "a {kind}"."""
    found = []
    for file in SOURCE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.JoinedStr):
                for part in node.values[:-1]:
                    text = part.value if isinstance(part, ast.Constant) else ""
                    words = text.lower().split(" ")
                    if words[-1] == "" and words[-2:-1] in (["a"], ["an"]):
                        found.append(f"{file.relative_to(SOURCE)}:{node.lineno}")
    assert found == []


# ----------------------------- Numbers beyond measure -----------------------------
MAP = '[materials]\n"*" = { reflectance = 0.5 }\n'


@pytest.mark.parametrize("metres", ["1e16", "1e300", "-1e308"])
@pytest.mark.parametrize("name", ["m.obj", "m.gltf"])
def test_a_mesh_beyond_measure_is_refused(said, folder, metres, name):
    Path("map.toml").write_text(MAP)
    if name == "m.obj":
        Path(name).write_text(OBJ.replace("v 1 0 0", f"v {metres} 0 0", 1))
    else:
        model = json.loads(gltf(folder)[0])
        model["nodes"][0]["translation"] = [float(metres), 0, 0]
        Path(name).write_text(json.dumps(model))
    with warnings.catch_warnings(record=True) as caught:
        status, text = said("import", name, "--materials", "map.toml", "-o", "out")
    assert status == 2
    assert "1e+15 m" in text
    assert not caught


def test_a_mesh_scaled_beyond_measure_is_refused(said):
    Path("map.toml").write_text("scale = 1e300\n" + MAP)
    Path("m.obj").write_text(OBJ)
    status, text = said("import", "m.obj", "--materials", "map.toml", "-o", "out")
    assert status == 2
    assert "1e+15 m" in text


def test_a_sensor_beyond_measure_is_refused(said):
    Path("desk.pts").write_text("1 1 1 0 0 1\n1 1e16 1 0 0 1\n")
    status, text = said("run", "study.toml", "--plan")
    assert status == 2
    assert text.startswith("desk.pts:2:")


@pytest.mark.parametrize("value", ["1e16", "1e308"])
def test_a_bsdf_beyond_measure_is_refused(said, value):
    text = Path("diffuser.xml").read_text()
    Path("diffuser.xml").write_text(
        re.sub(r"(<ScatteringData>\s*)[\d.e+-]+", rf"\g<1>{value}", text)
    )
    status, text = said("bsdf", "info", "diffuser.xml")
    assert status == 2
    assert "ScatteringData" in text


def test_a_gltf_buffer_with_other_letters_is_refused(said, folder):
    Path("map.toml").write_text(MAP)
    model = json.loads(gltf(folder)[0])
    model["buffers"][0]["uri"] = model["buffers"][0]["uri"][:-4] + "é==="
    Path("m.gltf").write_text(json.dumps(model, ensure_ascii=False))
    status, text = said("import", "m.gltf", "--materials", "map.toml", "-o", "out")
    assert (status, text) == (2, "m.gltf: a buffer is not base64")


def test_deep_gltf_nodes_are_not_called_a_cycle(said, folder):
    Path("map.toml").write_text(MAP)
    model = json.loads(gltf(folder)[0])
    chain = [{"children": [k + 1]} for k in range(200)] + [{"mesh": 0}]
    for nodes, expected in ((chain, "nested"), ([{"children": [0]}], "itself")):
        model |= {"nodes": nodes, "scenes": [{"nodes": [0]}]}
        Path("m.gltf").write_text(json.dumps(model))
        status, text = said("import", "m.gltf", "--materials", "map.toml", "-o", "out")
        assert status == 2
        assert expected in text


@pytest.mark.parametrize("text", ["", "# nothing\n", "v 0 0 0\n"])
def test_an_obj_file_without_faces_is_refused(said, text):
    Path("m.obj").write_text(text)
    status, told = said("import", "m.obj", "-o", "out")
    assert status == 2
    assert told.startswith("m.obj: no faces")


def test_a_fault_of_a_sky_command_names_no_temporary_file(said):
    words = ["irradiance", "--scene", "room.rad", "--sensors", "desk.pts", "--sky"]
    status, text = said(*words, "gensky 99 21 12")
    assert status == 2
    assert text.startswith('the sky "gensky 99 21 12": gensky: the month')


TWICE = "polygon twice 0 0 18 0 0 2 1 0 2 1 1 2 0 0 2 1 0 2 1 1 2\n"


@pytest.mark.parametrize("alone", [False, True])
def test_a_polygon_that_is_filled_nowhere_is_traced(said, alone):
    """An outline that is run through twice has no inside by the even–odd rule."""
    Path("sky.rad").write_text(
        "void glow g 0 0 4 1 1 1 0\ng source dome 0 0 4 0 0 1 360\n"
    )
    own = "void plastic thin 0 0 5 .5 .5 .5 0 0\nthin " + TWICE
    Path("room.rad").write_text(own if alone else Path("room.rad").read_text() + own)
    words = "irradiance --scene room.rad --sensors desk.pts --samples 4 --sky sky.rad"
    assert said(*words.split())[0] == 0


def test_a_window_that_is_filled_nowhere_is_refused(said):
    head = "#@rfluxmtx h=kf u=Z\nvoid glow g 0 0 4 1 1 1 0\ng "
    Path("window.rad").write_text(head + TWICE)
    assert said("run", "study.toml", "--plan")[0] == 2


def test_a_pixel_beyond_measure_is_refused(said):
    head = b"#?RADIANCE\nVIEW= -vta -vh 180 -vv 180\nFORMAT=32-bit_rle_rgbe\n\n"
    head += b"-Y 40 +X 40\n"
    Path("p.hdr").write_bytes(head + b"\xff\xff\xff\xfe" * 1600)
    for command in ("picture info", "glare"):
        status, text = said(*command.split(), "p.hdr")
        assert status == 2
        assert "the pixel in row 0, column 0" in text


@pytest.mark.parametrize(
    "name", ["V_%999999999d.hdr", "V_%.99999d.hdr", "V_%0500d.hdr"]
)
def test_a_picture_set_of_endless_names_is_refused(said, name):
    status, text = said("multiply", name, "two_days.wea", "-o", "o.mtx")
    assert status == 2
    assert "V_%03d.hdr" in text


# ------------------------------------ Schedules ------------------------------------
SCHEDULES = {
    "offset": ("time,south\n2023-03-21T08:00+01:00,1\n", "s.csv:2: .*offset"),
    "Zulu": ("time,south\n2023-03-21 08:00Z,1\n", "s.csv:2: .*offset"),
    "now": ("time,south\n2023-03-21T08:00,1\nnow,0\n", "s.csv:3: 'now,0'"),
    "year": ("time,south\n99999-03-21T08:00,1\n", "s.csv:2: '99999"),
    "no line": ("time,south\n", "s.csv: no lines"),
    "state": (
        "time,south\n2023-03-21T08:00,2\n",
        "s.csv: the state .* is 2; .* 0 to 1",
    ),
    "other": ("time,north\n2023-03-21T08:00,0\n", 's.csv: no column "south"'),
    "column twice": ("time,south,south\n2023-03-21T08:00,0,1\n", "s.csv:1: several"),
}


@pytest.mark.parametrize("case", SCHEDULES)
def test_a_doubtful_schedule_is_refused(said, case):
    content, expected = SCHEDULES[case]
    Path("s.csv").write_text(content)
    control = '[window.control]\nrule = "schedule"\nfile = "s.csv"\n'
    states = "".join(
        f'[[window.state]]\nname = "{name}"\nbsdf = "diffuser.xml"\n'
        for name in ("up", "down")
    )
    change("study.toml", 'bsdf = "diffuser.xml"\n', "")
    change("study.toml", "[[sensors]]", control + states + "[[sensors]]")
    status, text = said("run", "study.toml", "--plan")
    assert status == 2
    assert re.match(expected, text)


# ------------------------------- Results and weather -------------------------------
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_metrics_of_results_that_are_not_finite_are_refused(said, value):
    Path("r").mkdir()
    results(Path("r"))
    with xr.open_dataset("r/results.nc") as data:
        data = data.load()
    data["illuminance"].values[0, :3] = value
    Path("r/results.nc").unlink()
    data.to_netcdf("r/results.nc", engine="h5netcdf")
    status, text = said("metrics", "r")
    assert status == 2
    assert "not finite" in text


def test_time_steps_of_years_are_refused(said):
    Path("s.toml").write_text(STATION)
    rows = "2022-06-21;12:00;700;120\n9999-12-31;12:05;710;118\n"
    Path("roof.csv").write_text("day;clock;GHI;DHI\n" + rows)
    status, text = said("sky", "describe", "s.toml")
    assert status == 2
    assert "time step" in text


def test_numbers_left_over_in_an_ies_file_are_reported(tmp_path):
    """A decimal comma separates numbers, so that all later ones are moved."""
    file = tmp_path / "l.ies"
    file.write_text(IES.replace("100 80 0", "100,5 80,0 0"))
    with pytest.warns(ClerestoryWarning, match="2 words after the last intensity"):
        read_ies(file)


# ---------------------------------- Goniophotometers ----------------------------------
SEEDS = {"a.csv": COLUMNS, "v.txt": VIAVI, "f.txt": FRED, "p.txt": PABOPTO}


@pytest.mark.parametrize("name", SEEDS)
def test_measurements_with_a_byte_order_mark_are_recognized(tmp_path, name):
    """As spreadsheets write them."""
    file = tmp_path / name
    file.write_bytes(SEEDS[name].replace("\n", "\r\n").encode("utf-8-sig"))
    (measured,) = read_measurement(file)
    file.write_text(SEEDS[name])
    assert len(measured.scans) == len(read_measurement(file)[0].scans) == 1


@pytest.mark.parametrize("name", SEEDS)
def test_a_measured_value_beyond_measure_is_refused(said, name):
    Path(name).write_text(SEEDS[name].replace(".4", "1e308"))
    status, text = said("gonio", "info", name)
    assert status == 2
    assert "1e308" in text


@pytest.mark.parametrize("value", [1e308, -1, 1.5])
def test_honeybee_materials_that_cannot_be_are_refused(said, folder, value):
    model = json.loads(hbjson(folder)[0])
    model["properties"]["radiance"]["modifiers"][0]["r_transmissivity"] = value
    Path("m.hbjson").write_text(json.dumps(model))
    status, text = said("import", "m.hbjson", "-o", "out")
    assert status == 2
    assert "r_transmissivity" in text


# ------------------------------------ BSDF files ------------------------------------
MGF = '<MGFblock unit="furlong">v a =\n p 0 0 0\nsph a 1\n</MGFblock>'
GEOMETRY = f'<Geometry format="MGF">{MGF}</Geometry>'
DAMAGED = {
    "data twice": ("</ScatteringData>", "</ScatteringData><ScatteringData/>", "Scatte"),
    "direction twice": (
        "<WavelengthDataDirection>",
        "<WavelengthDataDirection/><WavelengthDataDirection>",
        "2 elements WavelengthDataDirection",
    ),
    "layer twice": ("</Layer>", "</Layer><Layer/>", "2 elements Layer"),
    "definition twice": (
        "</DataDefinition>",
        "</DataDefinition><DataDefinition/>",
        "2",
    ),
    "thickness": (
        "<Material>",
        '<Material><Thickness unit="meter">-1</Thickness>',
        "-1",
    ),
    "width": ("<Material>", '<Material><Width unit="furlong">-2</Width>', "-2; 0 or"),
    "unit": ("</Material>", "</Material>" + GEOMETRY, "'furlong'; one of"),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_a_bsdf_file_that_contradicts_itself_is_refused(said, case):
    old, new, expected = DAMAGED[case]
    change("diffuser.xml", old, new)
    status, text = said("bsdf", "info", "diffuser.xml")
    assert status == 2
    assert text.startswith("diffuser.xml:")
    assert expected in text


def test_a_width_in_an_unknown_unit_is_told(said, capsys):
    change("diffuser.xml", "<Material>", '<Material><Width unit="ell">2</Width>')
    assert main(["bsdf", "info", "diffuser.xml"]) == 0
    assert "Width in the unknown unit 'ell' is ignored" in capsys.readouterr().out


# ------------------------------------ Other texts ------------------------------------
@pytest.mark.parametrize("coding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_geometry_in_utf_16_is_read_or_refused(said, coding):
    """As "Unicode text" of Windows: recognized by its byte order mark."""
    text = "m a =\n rd .5\nv a =\n p 0 0 0\nsph a 1\n"
    Path("a.mgf").write_bytes(text.encode(coding))
    Path("room.rad").write_text(Path("room.rad").read_text() + "!mgf2rad a.mgf\n")
    status, told = said("run", "study.toml", "--plan")
    if coding == "utf-16":
        assert status == 0
    else:
        assert (status, told[:5]) == (2, "a.mgf")


@pytest.mark.parametrize("name", ["m.hbjson", "g.json", "m.gltf"])
def test_a_json_member_given_twice_is_refused(said, folder, name):
    Path("map.toml").write_text(MAP)
    Path(name).write_text('{"a": {"type": "Model", "b": 1, "type": "Room"}}')
    command = "glazing stack g.json" if name == "g.json" else f"import {name} -o out"
    words = ["--materials", "map.toml"] if name == "m.gltf" else []
    status, text = said(*command.split(), *words)
    assert status == 2
    assert text.startswith(f"{name}: several members of an object are named 'type'")
