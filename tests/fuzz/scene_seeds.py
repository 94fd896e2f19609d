"""Scenes, models of other programs and luminaires."""

import base64
import importlib
import json
import os
import struct
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from honeybee_models import honeybee_model, office
from reader import Reader, Use

from ifc_models import ifc_room

ROOM = """# A room with everything
void plastic grey 0 0 5 .5 .5 .5 0 0
void brightfunc spots 4 spot x.cal -s 2 0 1 .5
spots metal shiny
0
0
5 .8 .8 .8 .9 .1
void spectrum oak 0 0 6 400 700 .1 .3 .4 .5
oak specfunc dark 2 wave x.cal 0 2 400 700
dark plastic wood 0 0 5 .9 .9 .9 0 0
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
void plastic2 brushed 4 0 Nz 1 . 0 6 .5 .5 .5 .1 .2 .05
void alias steel shiny
void BRTDfunc roos 10 .1 .1 .1 Rdot*.6 .6 .6 0 0 0 . 0 9 .1 .1 .1 .1 .1 .1 0 0 0
roos ring coated 0 0 8 0 0 2 0 0 1 0 .5
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
wave(nm) = nm / 1000;
"""
TABLE = "2\n0 1 3\n0 2 2\n1 2 3 4 5 6\n"
VIEW = "rvu -vth -vp 1 2 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180 -vo 0 -va 0\n"
RECEIVERS = """#@rfluxmtx h=u u=Y
void glow ground 0 0 4 1 1 1 0
ground source below 0 0 4 0 0 -1 180
#@rfluxmtx h=r1 u=+Y o=sky.mtx
void glow sky 0 0 4 1 1 1 0
sky source above 0 0 4 0 0 1 180
"""
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


def _ifc(_: Path) -> list[bytes]:
    numbers = {"VisibleLightTransmittance": 0.7, "GlazingAreaFraction": 0.8}
    rooms = (ifc_room(window=kind, numbers=numbers) for kind in ("style", "opening"))
    return [room.encode() for room in rooms]


def _hbjson(_: Path) -> list[bytes]:
    room = office("room")
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
    model = honeybee_model(room, sensor_grids=[grid], views=[view])
    return [json.dumps(model).encode(), json.dumps(model, indent=1).encode()]


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


# ----------------------------- Commands, compiled files -----------------------------
COMMANDS = """void plastic grey 0 0 5 .5 .5 .5 0 0
!genprism grey roof corners.txt -l 0 0 1.5 -r .1
!genprism grey wall 4 0 0 1 0 1 1 0 1 -l 0 0 -2 -c
!gensurf grey wave 's*2' t 'hill(s,t)' 4 4 -e 'hill(a,b)=a*b' -f x.cal
!genrev grey vase 't' '.2+.1*t' 8
!genworm grey rail 't' 't^2' '0' '.1' 5
!genblinds grey blind .05 1 1 4 30 -r .2
!gensky 9 21 12:30 +s -a 48 -o -11 -m -15 -g .2 -t 2.5
!gendaylit 3 21 9.5EST -W 500 150 -a 42 -o 71 -m 75
!ies2rad -m .9 -o lamp l.ies | xform -t 0 0 3
!mgf2rad m.mgf
void BSDF layer 6 0 b.xml 0 0 1 . 0 0
layer polygon sheet 0 0 9 0 0 0 1 0 0 0 0 1
!pkgBSDF b.xml
!xform -n copy -f places.txt part.rad
"""
PLACES = "# two places\n-t 1 0 0 -rz 30\n!xform -s 2 -mx\n"


def _through(name: str) -> Use:
    # A scene, sound itself, that names the damaged file
    return lambda function, path: function(path.with_name(name))


def _compiled(folder: Path, *commands: str) -> list[bytes]:
    # Files that Radiance's own programs write
    home = Path(importlib.import_module("pyradiance").__file__).parent
    paths = {"PATH": f"{home / 'bin'}:{os.environ['PATH']}"}
    made = []
    for command in commands:
        words = {"shell": True, "check": True, "capture_output": True, "cwd": folder}
        ran = subprocess.run(command, env=os.environ | paths, **words)
        made.append(ran.stdout)
    return made


def _commands(folder: Path) -> list[bytes]:
    layer = importlib.import_module("optics_seeds").layer_with_geometry()
    importlib.import_module("clerestory.bsdf.xml_writer").write_bsdf(
        folder / "b.xml", layer
    )
    return [COMMANDS.encode()]


def _octrees(folder: Path) -> list[bytes]:
    (folder / "parts.rad").write_text(
        PART + "void alias oak wood\noak sphere s 0 0 4 0 0 1 .2\n"
    )
    return _compiled(folder, "oconv -f parts.rad", "oconv parts.rad")


def _meshes(folder: Path) -> list[bytes]:
    (folder / "mats.rad").write_text("void plastic red 0 0 5 .5 .1 .1 0 0\n")
    square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    (folder / "m.obj").write_text(square + "usemtl red\nf 1 2 3\nf 1 3 4\n")
    return _compiled(folder, "obj2mesh -a mats.rad m.obj m.rtm && cat m.rtm")


def _mesh(function: Callable[..., object], path: Path) -> object:
    plastic = importlib.import_module("clerestory.scene.model").Plastic
    return function(path, materials={"*": plastic("grey", np.full(3, 0.5))})


def _coloured(function: Callable[..., object], path: Path) -> object:
    return function(path.with_name("m.obj"), materials={}, colours=True)


def _statements(function: Callable[..., object], path: Path) -> object:
    return function(path.read_text("latin-1"), file=path.name)


def _text(function: Callable[..., object], path: Path) -> object:
    return function(path.read_text("latin-1"))


BESIDE = {"part.rad": PART, "x.cal": CAL, "t.dat": TABLE}
FILES = BESIDE | {
    "corners.txt": "0 0 1 0 1 1\n",
    "l.ies": IES,
    "m.mgf": MGF,
    "places.txt": PLACES,
}
TEXTURED = OBJ.replace("usemtl red", "usemtl red\nusemtl blue")
MTL = "newmtl red\nKd .5 .1 .1\nNs 10\nillum 2\nd 1\nnewmtl blue\nKd .1 .1 .5\n"

READERS = {
    "rad": Reader("radiance.rad_reader:read_rad", "room.rad", (ROOM,), beside=BESIDE),
    "commands": Reader(
        "radiance.rad_reader:read_rad", "c.rad", make=_commands, beside=FILES
    ),
    "xform options": Reader(
        "radiance.rad_reader:read_rad",
        "places.txt",
        (PLACES,),
        beside={"p.rad": "!xform -f places.txt part.rad\n", "part.rad": PART},
        use=_through("p.rad"),
    ),
    "prism corners": Reader(
        "radiance.rad_reader:read_rad",
        "corners.txt",
        ("0 0 1 0 1 1\n",),
        beside={"p.rad": "!genprism void roof corners.txt -l 0 0 1\n"},
        use=_through("p.rad"),
    ),
    "octree": Reader(
        "radiance.rad_reader:read_rad",
        "f.oct",
        make=_octrees,
        beside={"o.rad": "void instance it\n1 f.oct\n0\n0\n"},
        use=_through("o.rad"),
    ),
    "compiled mesh": Reader(
        "radiance.rad_reader:read_rad",
        "m.rtm",
        make=_meshes,
        beside={"o.rad": "void mesh it\n1 m.rtm\n0\n0\n"},
        use=_through("o.rad"),
    ),
    "cal": Reader(
        "radiance.cal.syntax:parse_definitions", "x.cal", (CAL,), use=_statements
    ),
    "data": Reader("radiance.data_array:read_data_array", "t.dat", (TABLE,)),
    "view": Reader("radiance.view_text:read_view", "eye.vf", (VIEW,)),
    "view options": Reader(
        "radiance.view_text:parse_view", "eye.txt", (VIEW[4:],), use=_text
    ),
    "window": Reader("radiance.window_reader:read_windows", "w.rad", (WINDOW,)),
    "one window": Reader("radiance.window_reader:read_window", "w.rad", (WINDOW,)),
    "receivers": Reader(
        "radiance.receiver_reader:read_receivers", "r.rad", (WINDOW, RECEIVERS)
    ),
    "octree as a scene": Reader("radiance.rad_reader:read_rad", "f.oct", make=_octrees),
    "spectrum": Reader(
        "spectral.spectrum_file:read_spectrum",
        "paint.csv",
        ("nm,reflectance\n400,0.2\n500;0.4 # green\n700 0.6\n",),
    ),
    "measured spectra": Reader(
        "sky.measured_spectra:read_measured_spectra",
        "sky.csv",
        ("time,400,500,700\n2026-06-20T12:00,2,3,1\n2026-06-20T13:00,2,1,4 # red\n",),
    ),
    "sensors": Reader(
        "scene.sensors:read_sensors", "desk.pts", ("1 1 .8 0 0 1\n2 1 .8 0 0 1\n",)
    ),
    "obj": Reader(
        "formats.obj:read_obj",
        "m.obj",
        (OBJ, TEXTURED),
        beside={"m.mtl": MTL},
        use=_mesh,
    ),
    "mtl": Reader(
        "formats.obj:read_obj",
        "m.mtl",
        (MTL,),
        beside={"m.obj": TEXTURED},
        use=_coloured,
    ),
    "gltf": Reader("formats.gltf:read_gltf", "m.gltf", make=_gltf, use=_mesh),
    "material map": Reader(
        "radiance.material_map:read_material_map", "m.toml", (MATERIALS,)
    ),
    "mgf": Reader("formats.mgf:parse_mgf", "m.mgf", (MGF,), use=_statements),
    "hbjson": Reader("formats.hbjson:read_hbjson", "m.hbjson", make=_hbjson),
    "ifc": Reader("formats.ifc:read_ifc", "m.ifc", make=_ifc, cost=25),
    "ies": Reader("formats.photometry.read:read_luminaire", "l.ies", (IES, TILTED)),
    "ies tilt": Reader(
        "formats.photometry.read:read_luminaire",
        "t.tlt",
        ("1\n3\n0 45 90\n1 .9 .8\n",),
        beside={"l.ies": IES.replace("TILT=NONE", "TILT=t.tlt")},
        use=_through("l.ies"),
    ),
    "eulumdat": Reader("formats.photometry.read:read_luminaire", "l.ldt", (_ldt(),)),
}
