"""Readers of the package, each with small sound files of its format.

A reader is named by module and function; the module is imported when its files are
fuzzed. Files with binary contents are written by the package itself.
"""

import base64
import importlib
import importlib.resources
import json
import shutil
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import clerestory as cl

DATA = Path(__file__).parents[1] / "data"
DEMO = Path(cl.__file__).parent / "demo"


@dataclass(frozen=True)
class Reader:
    """A function that reads a file from outside.

    Attributes
    ----------
    function : "module:name" below `clerestory`
    file : name of the file to read
    texts : sound files
    make : function of a folder that returns further sound files
    beside : other files in the folder, by name
    use : function of the reading function and the path; default: a plain call
    """

    function: str
    file: str
    texts: tuple[str, ...] = ()
    make: Callable[[Path], list[bytes]] | None = None
    beside: dict[str, str] = field(default_factory=dict)
    use: Callable[[Callable[..., Any], Path], object] | None = None

    def seeds(self, folder: Path) -> list[bytes]:
        """Write the files beside, and return the sound files."""
        for name, text in self.beside.items():
            (folder / name).write_text(text)
        made = self.make(folder) if self.make else []
        return [text.encode() for text in self.texts] + made

    def read(self, path: Path) -> object:
        """Read a file."""
        module, name = self.function.split(":")
        function = getattr(importlib.import_module(f"clerestory.{module}"), name)
        return self.use(function, path) if self.use else function(path)


# ------------------------------------ Scenes ------------------------------------
ROOM = """# A room with everything
void plastic grey 0 0 5 .5 .5 .5 0 0
void brightfunc spots 4 spot x.cal -s 2 0 1 .5
spots metal shiny
0
0
5 .8 .8 .8 .9 .1
void colordata map 9 noop noop noop t.dat t.dat t.dat . 1 0 0 0
void glass pane 0 0 4 .9 .9 .9 1.52
void trans cloth 0 0 7 .5 .5 .5 .05 .1 .5 .2
void mixfunc mixed 4 grey pane .5 . 0 0
void glow sky 0 0 4 1 1 1 0
sky source dome 0 0 4 0 0 1 180
grey polygon floor
0
0
12 0 0 0 4 0 0 4 5 0 0 5 0
shiny sphere ball 0 0 4 1 1 1 .2
cloth cone c 0 0 8 0 0 0 0 0 1 .2 .1
grey cylinder tube 0 0 7 0 0 0 0 0 1 .1
pane ring r 0 0 8 0 0 1 0 0 1 0 .5
void alias steel shiny
!genbox grey crate 1 1 1 -r .1 | xform -t 2 2 0 -a 3 -t 0 0 1.1
!xform -rz 30 -s 2 part.rad
!genblinds grey blind .05 1 1 8 30
!gensurf grey wave 'sin(s)' 't' 's*t' 3 3 -s
"""
PART = "void plastic wood 0 0 5 .3 .2 .1 0 0\nwood polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n"
CAL = """{ spots }
spot(a) = if(mod(Px, a) - .5, noise3(Px, Py, Pz), A1 * sqrt(abs(Py)));
tri(n) = if(n - 1, n + tri(n - 1), 1);
t : select(2, 1, 2, 3);
"""
TABLE = "2\n0 1 3\n0 2 2\n1 2 3 4 5 6\n"
VIEW = "rvu -vth -vp 1 2 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180 -vo 0 -va 0\n"
WINDOW = (
    "#@rfluxmtx h=kf u=Z\nvoid glow g 0 0 4 1 1 1 0\n"
    "g polygon w 0 0 12 0 0 0 0 0 2 2 0 2 2 0 0\n"
)
OBJ = (
    "mtllib m.mtl\no box\ng south wall\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0\n"
    "vn 0 0 1\nvt 0 0\nusemtl red\nf 1 2 3\nf 1//1 3//1 4//1\nf -4/1/1 -3/1/1 -1/1/1\n"
    "s off\nf 1 2 3 \\\n 4\n"
)
MATERIALS = (
    'scale = 1.0\nup = "z"\n[materials]\nred = { reflectance = [0.5, 0.1, 0.1] }\n'
    'pane = { transmissivity = 0.8, index = 1.52 }\n"*" = { reflectance = 0.5 }\n'
)
MGF = (
    "# comment\nc red =\n\tcxy .5 .3\nm one =\n\tsides 1\n\tc red\n\trd .5\n"
    "\trs .02 .1\n"
    "m two = one\n\tts .3 0\nv a =\n\tp 0 0 0\n\tn 0 0 1\nv b =\n\tp 1 0 0\nv c =\n"
    "\tp 1 1 0\no thing\nm one\nf a b c\nxf -a 3 -t 0 0 1 -rz 20\nsph a 1\ncyl a 1 b\n"
    "xf\nm two\nprism a b c 2\nring a 0 1\ntorus a .1 .5\nfh a b c - a c b\no\n"
)


def _gltf(_: Path) -> list[bytes]:
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], "<f4").tobytes()
    faces = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 1)], "<u2").tobytes()
    data = points + faces
    model: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"children": [1], "translation": [1, 0, 0], "name": "a"},
            {"mesh": 0, "rotation": [0, 0, 0, 1], "scale": [1, 2, 1]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "materials": [{"name": "Red", "pbrMetallicRoughness": {}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 9, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 18},
        ],
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(model).encode()
    text += b" " * (-len(text) % 4)
    blob = data + b"\0" * (-len(data) % 4)
    glb = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob))
    glb += struct.pack("<I4s", len(text), b"JSON") + text
    glb += struct.pack("<I4s", len(blob), b"BIN\0") + blob
    inside = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    model["buffers"] = [{"byteLength": len(data), "uri": inside}]
    return [json.dumps(model).encode(), json.dumps(model, indent=1).encode(), glb]


def _face(name: str, points: list[list[float]], **more: object) -> dict[str, object]:
    return {
        "type": "Face",
        "identifier": name,
        "face_type": "Wall",
        "geometry": {"type": "Face3D", "boundary": points},
        "boundary_condition": {"type": "Outdoors"},
        "properties": {"radiance": {}},
    } | more


def _hbjson(_: Path) -> list[bytes]:
    aperture = {
        "type": "Aperture",
        "identifier": "south_window",
        "geometry": {"boundary": [[1, 0, 1], [3, 0, 1], [3, 0, 2], [1, 0, 2]]},
        "boundary_condition": {"type": "Outdoors"},
        "properties": {"radiance": {"modifier": "pane"}},
    }
    south = [[0, 0, 0], [4, 0, 0], [4, 0, 3], [0, 0, 3]]
    floor = [[0, 0, 0], [0, 5, 0], [4, 5, 0], [4, 0, 0]]
    faces = [
        _face("floor", floor, face_type="Floor"),
        _face("south", south, apertures=[aperture]),
    ]
    pane = {
        "type": "Glass",
        "identifier": "pane",
        "r_transmissivity": 0.8,
        "g_transmissivity": 0.9,
        "b_transmissivity": 0.7,
        "refraction_index": None,
    }
    grid = {
        "type": "SensorGrid",
        "identifier": "grid",
        "sensors": [{"pos": [1, 1, 0.8], "dir": [0, 0, 1]}],
    }
    view = {
        "type": "View",
        "identifier": "eye",
        "view_type": "h",
        "position": [1, 1, 1],
        "direction": [0, -1, 0],
        "h_size": 180,
        "v_size": 180,
    }
    radiance = {"modifiers": [pane], "modifier_sets": [], "sensor_grids": [grid]}
    model = {
        "type": "Model",
        "identifier": "room",
        "units": "Meters",
        "rooms": [{"identifier": "room", "faces": faces, "properties": {}}],
        "properties": {"radiance": radiance | {"views": [view]}},
    }
    return [json.dumps(model).encode(), json.dumps(model, indent=1).encode()]


# ---------------------------------- Luminaires ----------------------------------
IES = (
    "IESNA:LM-63-2002\n[TEST] 1\n[LUMCAT] X1\n[MORE] and more\nTILT=NONE\n"
    "1 1000 1 3 2 1 2 -.2 -.2 0\n1 1 10\n0 45 90\n0 90\n100 80 0\n90 70 0\n"
)
TILTED = IES.replace("TILT=NONE", "TILT=INCLUDE\n1\n3\n0 45 90\n1 .9 .8")


def _ldt() -> str:
    head = ["Maker", "1", "1", "4", "90", "3", "45", "report", "name", "number", "file"]
    head += ["date", "200", "100", "50", "200", "100", "0", "0", "0", "0", "100", "90"]
    head += ["1", "0", "1", "2", "LED", "1000", "warm", "80", "20"]
    numbers = [f"{0.5 + k / 100}" for k in range(10)] + ["0", "90", "180", "270"]
    return "\n".join([*head, *numbers, "0", "45", "90", *(["100", "80", "10"])]) + "\n"


# ------------------------------------- BSDF -------------------------------------
def _bsdfs(folder: Path) -> list[bytes]:
    analytic = importlib.import_module("clerestory.bsdf.analytic")
    klems = importlib.import_module("clerestory.hemisphere.klems")
    resample = importlib.import_module("clerestory.bsdf.resample")
    writer = importlib.import_module("clerestory.bsdf.xml_writer")
    limits = np.array([0.0, 30, 90])
    rings = klems.from_rings("Few", limits_deg=limits, count=np.array([1, 4]))
    pane = analytic.thin_pane(0.9, rings)
    writer.write_bsdf(folder / "matrix.xml", pane)
    writer.write_bsdf(folder / "tree.xml", resample.to_trees(pane, halvings=2))
    made = [(folder / name).read_bytes() for name in ("matrix.xml", "tree.xml")]
    rows = made[0].replace(b">Columns<", b">Rows<")
    return [*made, rows, (DATA / "five_patches.xml").read_bytes()]


# ------------------------------------ Weather ------------------------------------
def _epw() -> str:
    head = (
        "LOCATION,Testville,-,DEU,made,000000,50.0,8.5,1.0,110.0\n"
        "DESIGN CONDITIONS,0\nTYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\n"
        "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\nCOMMENTS 1,made\nCOMMENTS 2,\n"
        "DATA PERIODS,1,1,Data,Sunday, 3/21, 3/21\n"
    )
    rows = [
        f"1999,3,21,{hour},60,?9,9.0,4.5,70,101000,0,0,300,250,300,120,0,0,0,0"
        for hour in range(1, 25)
    ]
    return head + "\n".join(rows) + "\n"


WEA = (
    "place Testville_DEU\nlatitude 50.0\nlongitude -8.5\ntime_zone -15\n"
    "site_elevation 110\nweather_data_file_units 1\n3 21 11.5 300 120\n"
    "3 21 12.5 310 121\n"
)
TMY3 = (
    '722000,"TESTVILLE",NC,-5.0,36.100,-79.950,273\n'
    "Date (MM/DD/YYYY),Time (HH:MM),DNI (W/m^2),DHI (W/m^2),Dew-point (C)\n"
    "03/21/1999,01:00,0,0,4.0\n03/21/1999,02:00,0,0,4.0\n03/21/1999,12:00,500,100,4\n"
)
STATION = """file = "roof.csv"
stands_for = "end"
separator = ";"
[site]
latitude_deg = 50.0
longitude_deg = 8.5
utc_offset_hours = 1
place = "roof"
[columns]
time = ["day", "clock"]
global_horizontal = "GHI"
diffuse_horizontal = "DHI"
"""
ROOF = "day;clock;GHI;DHI\n2022-06-21;12:00;700;120\n2022-06-21;12:05;710;118\n"


def _surfrad() -> str:
    rows = []
    for minute in range(5):
        numbers = [2016, 160, 6, 8, 18, minute, 18.0, 30.5, 900.0, 0]
        numbers += [200.0, 0, 800.0, 0, 100.0, 0, *([300.0, 0] * 16)]
        rows.append(" ".join(map(str, numbers)))
    return (
        " San Luis Valley\n   37.70 105.92 2317 m version 1\n" + "\n".join(rows) + "\n"
    )


def _through_station(function: Callable[..., object], path: Path) -> object:
    # The data file is damaged, the station file that names it is sound
    return function(path.with_name("station.toml"))


# ------------------------------------ Pictures ------------------------------------
def _picture() -> object:
    picture = importlib.import_module("clerestory.image.picture")
    view = importlib.import_module("clerestory.scene.view")
    values = np.random.default_rng(0).uniform(0, 20, (20, 20, 3)).astype(np.float32)
    return picture.Picture(
        values, view=view.View(kind="angular", horizontal=180, vertical=180)
    )


def _hdr(folder: Path) -> list[bytes]:
    cl.write_picture(_picture(), folder / "seed.hdr")
    data = (folder / "seed.hdr").read_bytes()
    head = data[: data.index(b"-Y 20")] + b"-Y 20 +X 20\n"
    rng = np.random.default_rng(1)
    flat = rng.integers(1, 255, (400, 4), dtype=np.uint8)
    flat[:, 3] = rng.integers(120, 140, 400)
    return [data, head + flat.tobytes(), data.replace(b"rle_rgbe", b"rle_xyze")]


def _exr(folder: Path) -> list[bytes]:
    cl.write_picture(_picture(), folder / "seed.exr")
    return [(folder / "seed.exr").read_bytes()]


def _jpeg(folder: Path) -> list[bytes]:
    image = importlib.import_module("PIL.Image").new("RGB", (16, 16), (90, 80, 70))
    exif = image.getexif()
    exif.get_ifd(0x8769).update({0x829A: 0.01, 0x829D: 4.0, 0x8827: 100})
    image.save(folder / "seed.jpg", exif=exif)
    image.save(folder / "seed.png")
    return [(folder / "seed.jpg").read_bytes(), (folder / "seed.png").read_bytes()]


# ------------------------------------ Matrices ------------------------------------
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


# --------------------------------- Goniophotometers ---------------------------------
POINTS = "0 0 .5\n10 90 .4\n20 180 .3\n30 200 .2\n40 270 .1\n"
PABOPTO = (
    '#sample_name "glass"\n#format: theta phi BRDF\n#upphi 90\n#incident_angle 30 20\n'
    + POINTS
)
COLUMNS = "theta_i,phi_i,theta_s,phi_s,brdf\n" + "".join(
    "30,20," + line.replace(" ", ",") + "\n" for line in POINTS.splitlines()
)
VIAVI = "!!EDS 30-200   RPC\n!!BSDF Data\n30 200\n" + POINTS
FRED = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n30 200\n" + POINTS
ASTM = "TITLE glass\nVARS theta_i,phi_i,theta_s,phi_s,BRDF\n.5,.3,0,0,.5\n"
ASTM += ".5,.3,.2,1,.4\n.5,.3,.3,2,.4\n.5,.3,.4,3,.4\n"
TABULAR = (
    "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\n"
    "ScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 1\n30\n"
    "ScatterAzimuth 3\n0 90 180\nScatterRadial 3\n0 10 30\n\nMonochrome\n"
    "DataBegin\nTIS 0.1\n5 4 3\n5 2 1\n5 0.5 0.2\nDataEnd\n"
)

# ------------------------------------- Glazing -------------------------------------
OPTICS_FILE = (
    "{ Units, Wavelength Units } SI Microns\n{ Thickness } 6.0\n{ Conductivity } 1.0\n"
    "{ IR Transmittance } TIR= 0.01\n{ Emissivity, front back } Emis= 0.84 0.03\n"
    "{ Product Name: Test coated glass }\n{ NFRC ID: 77 }\n{ Type: Coated }\n"
    "{ Coated Side: Back }\n300.0 0.10 0.20 0.30\n2500.0 0.50 0.30 0.40\n"
)
PRODUCT = {
    "name": "Test glass",
    "nfrc_id": 7,
    "type": "glazing",
    "subtype": "monolithic",
    "coated_side": "Neither",
    "manufacturer_name": "Nobody",
    "measured_data": {
        "thickness": 4.0,
        "conductivity": 1.0,
        "emissivity_front": 0.84,
        "emissivity_back": 0.2,
        "tir_front": 0.0,
    },
    "spectral_data": {
        "spectral_data": [
            {"T": 0.8, "Rf": 0.1, "Rb": 0.15, "wavelength": 0.3},
            {"T": 0.6, "Rf": 0.2, "Rb": 0.25, "wavelength": 2.5},
        ]
    },
}
GEOMETRY = {"slat_width": 16.0, "slat_spacing": 12.0, "slat_tilt": 45.0}
GEOMETRY |= {"slat_curvature": 10.0, "number_of_segments": 5, "tilt_angle": 45.0}
SHADE = {
    "name": "shade",
    "type": "shading",
    "composition": [{"child_product": PRODUCT, "extra_data": {"geometry": GEOMETRY}}],
}
SYSTEM = """name = "Double glazing with an inner blind"
[[layer]]
file = "a.json"
flipped = false
[[gap]]
thickness_mm = 12.7
gases = { argon = 0.9, air = 0.1 }
[[layer]]
file = "a.json"
[[gap]]
thickness_mm = 50
[[layer]]
venetian = { material = "a.json", width_mm = 25, spacing_mm = 20, tilt_deg = 45 }
"""
BLIND = 'kind = "venetian"\nslat_width = 0.08\nspacing = 0.072\ntilt_deg = 45\n'
BLIND += "rise = 0.002\n"

# --------------------------------- Studies, results ---------------------------------
SCAN = """utc_offset_hours = -6
[layout.room]
columns = ["north", "south"]
column_axis = "y"
column_at = [3.0, 1.0]
row_at = [0.5, 1.5]
height = 0.75
factor = 1000
grid = "lux"
[[scan]]
file = "nine.csv"
at = 2024-06-26T09:00:00
layout = "room"
row_minutes = 2
backwards = true
"""
LOGGER = """utc_offset_hours = -6
[[logger]]
file = "log.csv"
time = "when"
columns = {"lux.1" = "A"}
"""
LOG = "when,A\n2024-06-26T08:30,100\n2024-06-26T08:35,110\n"


def _measured(function: Callable[..., object], path: Path) -> object:
    series = importlib.import_module("clerestory.comparison.series").Series
    places = [(0.5, 1, 0.75), (0.5, 3, 0.75), (1.5, 1, 0.75), (1.5, 3, 0.75)]
    hours = np.array(["2024-06-26T08:30", "2024-06-26T09:30"], "datetime64[s]")
    near = series(
        tuple(f"lux.{i}" for i in range(1, 5)),
        hours,
        np.ones((4, 2)),
        60.0,
        -6.0,
        position=np.array(places),
    )
    return function(path, near=near)


def _plain(function: Callable[..., object], path: Path) -> object:
    return function(path, utc_offset_hours=1.0)


def _study(folder: Path) -> list[bytes]:
    for file in DEMO.iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    weather = folder / "723170TYA.CSV"
    shutil.copy(importlib.resources.files("pvlib") / "data" / weather.name, weather)
    return [(DEMO / "study.toml").read_bytes()]


def _statements(function: Callable[..., object], path: Path) -> object:
    return function(path.read_text("latin-1"), file=path.name)


def _options(function: Callable[..., object], path: Path) -> object:
    return function(path.read_text("latin-1"))


READERS = {
    "rad": Reader(
        "radiance.rad_reader:read_rad",
        "room.rad",
        (ROOM,),
        beside={"part.rad": PART, "x.cal": CAL, "t.dat": TABLE},
    ),
    "cal": Reader(
        "radiance.cal.syntax:parse_definitions", "x.cal", (CAL,), use=_statements
    ),
    "data": Reader("radiance.data_array:read_data_array", "t.dat", (TABLE,)),
    "view": Reader("radiance.view_text:read_view", "eye.vf", (VIEW,)),
    "window": Reader("radiance.window_reader:read_windows", "w.rad", (WINDOW,)),
    "sensors": Reader(
        "scene.sensors:read_sensors", "desk.pts", ("1 1 .8 0 0 1\n2 1 .8 0 0 1\n",)
    ),
    "obj": Reader(
        "formats.obj:read_obj", "m.obj", (OBJ,), use=lambda f, p: _mesh(f, p)
    ),
    "gltf": Reader(
        "formats.gltf:read_gltf", "m.gltf", make=_gltf, use=lambda f, p: _mesh(f, p)
    ),
    "material map": Reader(
        "radiance.material_map:read_material_map", "m.toml", (MATERIALS,)
    ),
    "mgf": Reader("formats.mgf:parse_mgf", "m.mgf", (MGF,), use=_statements),
    "hbjson": Reader("formats.hbjson:read_hbjson", "m.hbjson", make=_hbjson),
    "ies": Reader("formats.photometry.read:read_luminaire", "l.ies", (IES, TILTED)),
    "eulumdat": Reader("formats.photometry.read:read_luminaire", "l.ldt", (_ldt(),)),
    "bsdf": Reader("bsdf.xml_reader:read_bsdf", "b.xml", make=_bsdfs),
    "epw": Reader("sky.weather_formats:read_weather", "y.epw", (_epw(),)),
    "wea": Reader("sky.weather_formats:read_weather", "y.wea", (WEA,)),
    "tmy3": Reader("sky.weather_formats:read_weather", "y.csv", (TMY3,)),
    "surfrad": Reader("sky.weather_formats:read_weather", "y.dat", (_surfrad(),)),
    "station": Reader(
        "sky.weather_formats:read_weather",
        "s.toml",
        (STATION,),
        beside={"roof.csv": ROOF},
    ),
    "station data": Reader(
        "sky.weather_formats:read_weather",
        "roof.csv",
        (ROOF,),
        beside={"station.toml": STATION},
        use=_through_station,
    ),
    "hdr": Reader("image.picture_files:read_picture", "p.hdr", make=_hdr),
    "exr": Reader("image.picture_files:read_picture", "p.exr", make=_exr),
    "photograph": Reader("image.photograph:read_photograph", "p.jpg", make=_jpeg),
    "exposure": Reader(
        "image.photograph:read_exposure", "p.jpg", make=lambda f: _jpeg(f)[:1]
    ),
    "response": Reader(
        "image.camera_response:read_response", "r.rsp", ("2 .5 .5 0\n" * 3,)
    ),
    "matrix": Reader("matrix.radiance_format:read_matrix", "m.mtx", make=_matrices),
    "netcdf": Reader("matrix.netcdf:read_netcdf", "m.nc", make=_netcdf),
    "pabopto": Reader("gonio.measurement_files:read_measurement", "a.txt", (PABOPTO,)),
    "columns": Reader("gonio.measurement_files:read_measurement", "a.csv", (COLUMNS,)),
    "viavi": Reader("gonio.measurement_files:read_measurement", "a.txt", (VIAVI,)),
    "fred": Reader("gonio.measurement_files:read_measurement", "a.txt", (FRED,)),
    "astm": Reader("gonio.measurement_files:read_measurement", "a.astm", (ASTM,)),
    "zemax": Reader("gonio.measurement_files:read_measurement", "a.bsdf", (TABULAR,)),
    "optics file": Reader("glazing.layer_files:read_layer", "a.dat", (OPTICS_FILE,)),
    "igsdb": Reader(
        "glazing.layer_files:read_layer",
        "a.json",
        (json.dumps(PRODUCT), json.dumps(SHADE)),
    ),
    "glazing system": Reader(
        "glazing.glazing_system:read_system",
        "g.toml",
        (SYSTEM,),
        beside={"a.json": json.dumps(PRODUCT)},
    ),
    "parametric system": Reader(
        "bsdfgen.system_catalogue:read_system", "s.toml", (BLIND,)
    ),
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
    "measured series": Reader(
        "comparison.logger_files:read_plain",
        "log.csv",
        ("time,lux.1\n2024-06-26T08:30,100\n2024-06-26T08:35,110\n",),
        use=_plain,
    ),
    "study": Reader("study.config:read_study", "study.toml", make=_study),
}


def _mesh(function: Callable[..., object], path: Path) -> object:
    plastic = importlib.import_module("clerestory.scene.model").Plastic
    return function(path, materials={"*": plastic("grey", np.full(3, 0.5))})
