"""Short files that describe very much: each is a folder, a function and a limit.

    python tests/fuzz/expansion_cases.py CASE

reads one in this process and prints seconds, megabytes added and the message as JSON.
"""

import builtins
import json
import resource
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from clerestory.errors import ClerestoryError

POLYGON = "m polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n"
GREY = "void plastic m 0 0 5 .5 .5 .5 0 0\n"
CASES: dict[str, Callable[[Path], object]] = {}


def case(make):
    CASES[make.__name__] = make
    return make


def rad(folder, **files):
    from clerestory.radiance.rad_reader import read_rad

    for name, text in files.items():
        (folder / f"{name}.rad").write_text(text)
    return len(read_rad(folder / "a.rad").surfaces)


# -------------------------------- Radiance scenes --------------------------------
@case
def arrays_of_arrays(folder):
    """Four nested files, each an array of 10,000."""
    array = "!xform -a 10000 -t 2 0 0 {}.rad\n"
    files = {k: array.format(chr(ord(k) + 1)) for k in "bcd"}
    return rad(folder, a=GREY + array.format("b"), **files, e=POLYGON)


@case
def arrays_beyond_floating_point(folder):
    """More copies than the largest floating-point number."""
    files = {f"n{k}": f"!xform -a 9000 n{k + 1}.rad\n" for k in range(80)}
    return rad(folder, a=GREY + "!xform n0.rad\n", **files, n80=POLYGON)


@case
def many_arrays_of_nothing(folder):
    """Each line makes 100,000 placements, which are counted together."""
    return rad(folder, a=GREY + "!xform -a 100000 b.rad\n" * 1000, b="# nothing\n")


@case
def arrays_in_one_command(folder):
    array = "!xform -a 1000 -t 2 0 0 -a 1000 -t 0 2 0 -a 1000 -t 0 0 2 e.rad\n"
    return rad(folder, a=GREY + array, e=POLYGON)


@case
def arrays_in_a_pipe(folder):
    array = "!genbox m b 1 1 1" + " | xform -a 30 -t 2 0 0" * 6 + "\n"
    return rad(folder, a=GREY + array)


@case
def files_included_twice(folder):
    files = {f"n{k}": f"!cat n{k + 1}.rad\n" * 2 for k in range(40)}
    return rad(folder, a=GREY + "!cat n0.rad\n", **files, n40=POLYGON)


@case
def empty_files_included_twice(folder):
    files = {f"n{k}": f"!cat n{k + 1}.rad n{k + 1}.rad\n" for k in range(40)}
    return rad(folder, a=GREY + "!cat n0.rad\n", **files, n40="# nothing\n")


@case
def definitions_included_twice(folder):
    """Patterns depend on the placement and are defined again for each copy."""
    pattern = "void brightfunc p 2 1+Px . 0 0\np plastic m 0 0 5 .5 .5 .5 0 0\n"
    files = {f"n{k}": f"!cat n{k + 1}.rad\n" * 2 for k in range(30)}
    return rad(folder, a="!cat n0.rad\n", **files, n30=pattern + POLYGON)


@case
def option_files_doubling(folder):
    """xform -f: every line of a file names a further file of options."""
    for k in range(30):
        (folder / f"o{k}").write_text(f"-t 1 0 0 -f o{k + 1}\n" * 2)
    (folder / "o30").write_text("-t 1 0 0\n")
    return rad(folder, a=GREY + "!xform -f o0 e.rad\n", e=POLYGON)


@case
def instances_of_instances(folder):
    """Meshes of OBJ files in nested arrays."""
    (folder / "c.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    mesh = "m mesh x 1 c.obj 0 0\n"
    array = "!xform -a 5000 -t 2 0 0 {}.rad\n"
    return rad(folder, a=GREY + array.format("b"), b=array.format("c"), c=mesh * 10)


@case
def long_polygons_in_an_array(folder):
    """The vertices count, not the polygons."""
    n = 20_000
    angle = np.arange(n) * 2 * np.pi / n
    points = " ".join(
        f"{x:.5f} {y:.5f} 0" for x, y in zip(np.cos(angle), np.sin(angle), strict=True)
    )
    long = f"m polygon p 0 0 {3 * n} {points}\n"
    return rad(folder, a=GREY + "!xform -a 90000 -t 2 0 0 e.rad\n", e=long)


@case
def surfaces_of_generators(folder):
    text = GREY + "!xform -a 1000 -t 9 0 0 b.rad\n"
    return rad(folder, a=text, b="!gensurf m s 's' 't' '0' 100 100\n")


@case
def converted_scenes_in_an_array(folder):
    (folder / "c.mgf").write_text("v a =\n p 0 0 0\nsph a 1\n" * 1000)
    return rad(folder, a="!xform -a 50000 -t 9 0 0 b.rad\n", b="!mgf2rad c.mgf\n")


@case
def doubled_mixtures(folder):
    text = GREY + "void mixfunc x0 4 m m .5 . 0 0\n"
    for k in range(60):
        text += f"void mixfunc x{k + 1} 4 x{k} x{k} .5 . 0 0\n"
    return rad(folder, a=text + POLYGON.replace("m", "x60", 1))


@case
def chained_mirrors_and_mixtures(folder):
    text = GREY
    for k in range(60):
        text += f"void mirror r{k} 1 {f'x{k - 1}' if k else 'm'} 0 3 .5 .5 .5\n"
        text += f"void mixfunc x{k} 4 r{k} r{k} .5 . 0 0\n"
    return rad(folder, a=text + POLYGON.replace("m", "x59", 1))


@case
def mirrors_of_mirrors(folder):
    text = GREY + "void mirror r0 1 m 0 3 .5 .5 .5\n"
    for k in range(900):
        text += f"void mirror r{k + 1} 1 r{k} 0 3 .5 .5 .5\n"
    return rad(folder, a=text + POLYGON.replace("m", "r900", 1))


@case
def counts_of_many_digits(folder):
    return rad(folder, a=f"{GREY}!xform -i {'9' * 5000} -t 1 0 0 e.rad\n", e=POLYGON)


@case
def nested_patterns(folder):
    text = "void brightfunc p0 2 1 . 0 0\n"
    for k in range(20_000):
        text += f"p{k} brightfunc p{k + 1} 2 1+Px . 0 0\n"
    text += "p20000 plastic m 0 0 5 .5 .5 .5 0 0\n"
    return rad(folder, a=text + POLYGON)


@case
def names_defined_again(folder):
    """Each definition of a name has another value."""
    text = "".join(
        f"void plastic m 0 0 5 .{k:06d} .5 .5 0 0\n{POLYGON}" for k in range(20_000)
    )
    return rad(folder, a=text)


@case
def recursive_functions(folder):
    (folder / "f.cal").write_text(
        "f0(x) = x + 1;\n"
        + "".join(f"f{k}(x) = f{k - 1}(x) + f{k - 1}(x);\n" for k in range(1, 60))
    )
    pattern = "void brightfunc p 2 f59(Px) f.cal 0 0\np plastic m 0 0 5 .5 .5 .5 0 0\n"
    count = rad(folder, a=pattern + POLYGON)
    from clerestory.radiance.cal.syntax import parse_definitions

    parse_definitions((folder / "f.cal").read_text())
    return count


@case
def data_file_of_many_dimensions(folder):
    (folder / "t.dat").write_text("8\n" + "0 1 1000\n" * 8 + "1\n")
    pattern = "void brightdata p 11 noop t.dat . " + "Px " * 8 + "0 0\n"
    return rad(folder, a=pattern + "p plastic m 0 0 5 .5 .5 .5 0 0\n" + POLYGON)


# ---------------------------------- Other scenes ----------------------------------
def _gltf_surfaces(folder, change):
    from scene_seeds import _gltf

    from clerestory.formats.gltf import read_gltf
    from clerestory.scene.model import Plastic

    model = json.loads(_gltf(folder)[0])
    change(model)
    (folder / "a.gltf").write_text(json.dumps(model))
    grey = {"*": Plastic("m", np.full(3, 0.5))}
    return len(read_gltf(folder / "a.gltf", materials=grey).surfaces)


def _doubled_nodes(*last, roots):
    nodes = [{"children": [k + 1, k + 1]} for k in range(60)]
    return {"nodes": [*nodes, *last], "scenes": [{"nodes": roots}]}


@case
def doubled_gltf_nodes(folder):
    nodes = _doubled_nodes({"mesh": 0}, roots=[0])
    return _gltf_surfaces(folder, lambda model: model.update(nodes))


@case
def doubled_gltf_nodes_without_a_mesh(folder):
    nodes = _doubled_nodes({}, {"mesh": 0}, roots=[0, 61])
    return _gltf_surfaces(folder, lambda model: model.update(nodes))


@case
def gltf_mesh_used_often(folder):
    """One node for each use of a mesh of 100,000 triangles."""

    def change(model):
        part = model["meshes"][0]["primitives"][0]
        model["meshes"][0]["primitives"] = [part] * 10_000
        nodes = [{"mesh": 0}] * 10_000
        model |= {"nodes": nodes, "scenes": [{"nodes": [*range(10_000)]}]}

    return _gltf_surfaces(folder, change)


@case
def gltf_triangles_used_300000_times(folder):
    from scene_seeds import _gltf

    from clerestory.formats.gltf import read_gltf
    from clerestory.scene.model import Plastic

    model = json.loads(_gltf(folder)[0])
    model |= {"nodes": [{"mesh": 0}], "scenes": [{"nodes": [0] * 300_000}]}
    (folder / "a.gltf").write_text(json.dumps(model))
    grey = {"*": Plastic("m", np.full(3, 0.5))}
    return len(read_gltf(folder / "a.gltf", materials=grey).surfaces)


@case
def gltf_accessor_beyond_floating_point(folder):
    from scene_seeds import _gltf

    from clerestory.formats.gltf import read_gltf
    from clerestory.scene.model import Plastic

    model = json.loads(_gltf(folder)[0])
    for each in model["accessors"]:
        each["count"] = 10**299
    nodes = [{"children": [1] * 10_000}, {"children": [2] * 10_000}, {"mesh": 0}]
    model |= {"nodes": nodes, "scenes": [{"nodes": [0] * 1000}]}
    (folder / "a.gltf").write_text(json.dumps(model))
    grey = {"*": Plastic("m", np.full(3, 0.5))}
    return len(read_gltf(folder / "a.gltf", materials=grey).surfaces)


def mgf(text):
    from clerestory.formats.mgf import parse_mgf

    return len(parse_mgf(text).surfaces)


@case
def mgf_array_of_a_million(folder):
    return mgf("v a =\n p 0 0 0\nxf -a 1000000 -t 1 0 0\nsph a 1\nsph a 2\nxf\n")


@case
def mgf_array_of_many_dimensions(folder):
    return mgf(f"v a =\n p 0 0 0\nxf{' -a 999999999' * 50_000}\nsph a 1\nxf\n")


@case
def mgf_nested_arrays(folder):
    return mgf(
        "v a =\n p 0 0 0\n" + "xf -a 1000 -t 1 0 0\n" * 3 + "sph a 1\n" + "xf\n" * 3
    )


@case
def mgf_empty_arrays(folder):
    return mgf("v a =\n p 0 0 0\n" + "xf -a 999999 -t 1 0 0\nxf\n" * 100 + "sph a 1\n")


@case
def mgf_objects_in_objects(folder):
    """The names of all open objects precede each name of a surface."""
    return mgf("v a =\n p 0 0 0\n" + "o abcdefgh\n" * 20_000 + "sph a 1\n" * 5000)


@case
def mgf_tori_in_an_array(folder):
    return mgf("v a =\n p 0 0 0\n n 0 0 1\nxf -a 300000 -t 1 0 0\ntorus a 1 2\nxf\n")


def obj(folder, text):
    from clerestory.formats.obj import read_obj
    from clerestory.scene.model import Plastic

    (folder / "a.obj").write_text(text)
    grey = {"*": Plastic("m", np.full(3, 0.5))}
    return len(read_obj(folder / "a.obj", materials=grey).surfaces)


def _face(radius):
    n = len(radius)
    angle = np.arange(n) * 2 * np.pi / n
    points = zip(radius * np.cos(angle), radius * np.sin(angle), strict=True)
    text = "".join(f"v {x:.7f} {y:.7f} 0\n" for x, y in points)
    return text + "f " + " ".join(map(str, range(1, n + 1))) + "\n"


def _corners(names):
    return "".join(f"v {name} =\n p {k} {k * k} 0\n" for k, name in enumerate(names))


@case
def mgf_face_of_600000(folder):
    """A face of a few vertices, each of which is used often."""
    return mgf(f"{_corners('abcd')}f{' a b c d' * 150_000}\n")


@case
def mgf_faces_of_100000_in_an_array(folder):
    face = f"f{' a b c d' * 25_000}\n"
    return mgf(f"{_corners('abcd')}xf -a 10000 -t 1 0 0\n{face}xf\n")


@case
def mgf_prism_of_a_million(folder):
    return mgf(f"{_corners('abcd')}prism{' a b c d' * 250_000} 1\n")


@case
def mgf_round_face_of_250000(folder):
    from clerestory.formats.mgf import parse_mgf
    from clerestory.scene.tessellate import meshes

    rows = _face(np.ones(250_000)).splitlines()[:-1]
    text = "".join(f"v v{k} =\n p {row[2:]}\n" for k, row in enumerate(rows))
    names = " ".join(f"v{k}" for k in range(len(rows)))
    return len(list(meshes(parse_mgf(f"{text}f {names}\n", file="a.mgf"))))


@case
def obj_star_of_40000(folder):
    return obj(folder, _face(np.tile([1.0, 0.9], 20_000)))


@case
def obj_scribble_of_40000(folder):
    """A face that crosses itself everywhere."""
    return obj(folder, _face(np.random.default_rng(1).uniform(-1, 1, 40_000)))


@case
def obj_many_scribbles(folder):
    radius = np.random.default_rng(1).uniform(-1, 1, 300)
    one = _face(radius)
    faces = one.splitlines()[-1] + "\n"
    return obj(folder, one + faces * 600)


@case
def rad_scribble_of_40000(folder):
    from clerestory.radiance.rad_reader import read_rad
    from clerestory.scene.tessellate import meshes

    rows = _face(np.random.default_rng(1).uniform(-1, 1, 40_000)).splitlines()[:-1]
    points = " ".join(row[2:] for row in rows)
    (folder / "a.rad").write_text(f"{GREY}m polygon p 0 0 {3 * len(rows)} {points}\n")
    return len(list(meshes(read_rad(folder / "a.rad"))))


# --------------------------------- Other documents ---------------------------------
@case
def nested_toml(folder):
    from clerestory.study.config import read_study

    (folder / "a.toml").write_text("title = " + "[" * 100_000 + "]" * 100_000)
    return read_study(folder / "a.toml")


@case
def toml_of_long_texts(folder):
    """A text of many lines, and a fault: the line of the fault is looked for."""
    from clerestory.study.config import read_study

    text = 'title = """\n' + "line\n" * 60_000 + '"""\nwrong = 1\n'
    (folder / "a.toml").write_text(text)
    return read_study(folder / "a.toml")


@case
def toml_of_many_tables(folder):
    from clerestory.study.config import read_study

    text = "".join(f'[[sensors]]\nfile = "{k}"\n' for k in range(30_000))
    (folder / "a.toml").write_text(text)
    return read_study(folder / "a.toml")


@case
def nested_json(folder):
    from clerestory.formats.hbjson import read_hbjson

    part = '{"identifier": "a", "outdoor_shades": ['
    text = '{"identifier": "m", "type": "Model", "orphaned_faces": ['
    (folder / "a.hbjson").write_text(text + part * 20_000 + "]}" * 20_001)
    return read_hbjson(folder / "a.hbjson")


@case
def json_names_taken(folder):
    from clerestory.formats.hbjson import read_hbjson

    grid = {"identifier": "a", "sensors": [{"pos": [0, 0, 0], "dir": [0, 0, 1]}]}
    radiance = {"radiance": {"sensor_grids": [grid] * 30_000}}
    model = {"type": "Model", "identifier": "m", "properties": radiance}
    (folder / "a.hbjson").write_text(json.dumps(model))
    return len(read_hbjson(folder / "a.hbjson").grids)


@case
def nested_xml(folder):
    from clerestory.bsdf.xml_reader import read_bsdf

    (folder / "a.xml").write_text(
        "<WindowElement>" + "<a>" * 200_000 + "</a>" * 200_000
    )
    return read_bsdf(folder / "a.xml")


@case
def xml_entities(folder):
    from clerestory.bsdf.xml_reader import read_bsdf

    entities = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 12))
    head = f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a0 "text">{entities}]>'
    (folder / "a.xml").write_text(f"{head}<WindowElement>&a11;</WindowElement>")
    return read_bsdf(folder / "a.xml")


@case
def nested_trees(folder):
    from clerestory.bsdf.analytic import lambertian
    from clerestory.bsdf.xml_reader import read_bsdf
    from clerestory.bsdf.xml_writer import write_bsdf
    from clerestory.hemisphere.klems import klems

    write_bsdf(folder / "a.xml", lambertian(0.5, klems("quarter")))
    text = (folder / "a.xml").read_text().replace(">Columns<", ">TensorTree4<")
    start, end = text.index("<ScatteringData>"), text.index("</ScatteringData>")
    tree = "{" * 200_000 + "1" + "}" * 200_000
    (folder / "a.xml").write_text(f"{text[:start]}<ScatteringData>{tree}{text[end:]}")
    return read_bsdf(folder / "a.xml")


@case
def octree_of_itself(folder):
    """A mesh of many items in arrays of arrays."""
    (folder / "c.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 100_000)
    return rad(
        folder,
        a=GREY + "!xform -a 9000 -t 2 0 0 b.rad\n",
        b="m mesh x 1 c.obj 0 0\n",
    )


# -------------------------------- Large but legal --------------------------------
@case
def legal_array(folder):
    array = "!xform -n x -a 100000 -t 2 0 0 -rz .01 e.rad\n"
    return rad(folder, a=GREY + array, e=POLYGON)


@case
def legal_array_of_boxes(folder):
    array = " | xform -a 300 -t 2 0 0 -a 300 -t 0 2 0\n"
    return rad(folder, a=GREY + "!genbox m b 1 1 1" + array)


@case
def legal_array_with_its_material(folder):
    array = "!xform -a 300 -t 2 0 0 {}.rad\n"
    files = {"b": array.format("c"), "c": GREY + POLYGON}
    return rad(folder, a=array.format("b"), **files)


class Imports:
    """Processor time of the imports within a `with` block [s]."""

    def __enter__(self) -> "Imports":
        self.seconds, self.within, self.plain = 0.0, False, builtins.__import__
        builtins.__import__ = self._timed
        return self

    def __exit__(self, *_: object) -> None:
        builtins.__import__ = self.plain

    def _timed(self, *words, **more):
        if self.within:
            return self.plain(*words, **more)
        self.within, started = True, time.process_time()
        try:
            return self.plain(*words, **more)
        finally:
            self.within = False
            self.seconds += time.process_time() - started


def measured(name: str) -> dict[str, object]:
    """Read a case; return seconds, megabytes added and the result or the message.

    The seconds are processor time without that of imports.
    """
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as place, Imports() as imports:
        try:
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            started = time.process_time()
            outcome = f"read: {CASES[name](Path(place))}"
        except ClerestoryError as error:
            outcome = f"refused: {str(error).replace(place, '')}"
        took = time.process_time() - started - imports.seconds
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"seconds": took, "megabytes": (peak - before) / 1024, "outcome": outcome}


if __name__ == "__main__":
    sys.path[:0] = [str(folder) for folder in Path(__file__).parents[:2]]
    json.dump(measured(sys.argv[1]), sys.stdout)
