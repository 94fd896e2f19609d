"""The models at hand: scenes without sky that both programs read.

Furniture stands on a grey floor in the open; rooms and boxes are as their authors made
them. What a model names but does not bring, stand-ins written here supply to both.
"""

import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duel import ENVIRONMENT
from rooms import room

import clerestory as cl
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.sensors import Sensors

SHARED = Path(__file__).parents[2] / "shared" / "data"

_IN_ROOMS = 512

# Stand-ins for function files of Radiance's old library that are no longer given out
WOOD = """{ Rings of wood about an axis, lighter and darker by A1. }
ring(u, v) = 1 - A1*.35*(.5 + .5*sin(14*sqrt(u*u + v*v) + 2*noise3(u, v, .3)));
xgrain = ring(Py, Pz);
ygrain = ring(Px, Pz);
zgrain = ring(Px, Py);
"""
UPHOLSTERY = """{ A coarse weave. }
upholster = .85 + .15*sin(40*Px)*sin(40*Pz);
"""
MARBLE = """{ Veins along a wavy plane. }
vein = .5 + .5*sin(6*Px + 4*noise3(Px, Py, Pz));
marble = .6 + .4*vein;
marbpat = marble;
"""


@dataclass(frozen=True)
class Model:
    """A scene without sky that both programs read.

    Attributes
    ----------
    name : for the table
    folder : where its files lie
    files : scene files
    view : the picture's
    sensors : points and directions
    shines : whether it brings its own light, so that no sky is added
    directions : of rtrace's first gather; in rooms few of them meet an opening
    """

    name: str
    folder: Path
    files: tuple[str, ...]
    view: str
    sensors: Sensors
    shines: bool = False
    directions: int = 32


def furniture(folder: Path) -> Iterator[Model]:
    """Yield the furniture of Greg Ward's collection, each piece on a floor."""
    source = SHARED / "models" / "gjward_furniture"
    shutil.copytree(source, folder, dirs_exist_ok=True)
    (folder / "woodpat.cal").write_text(WOOD)
    (folder / "marble.cal").write_text(MARBLE)
    (folder / "upholstery.cal").write_text(UPHOLSTERY)
    for file in sorted(folder.glob("*.rad")):
        yield placed(file.stem, folder, (file.name,))


def shapes(folder: Path) -> Iterator[Model]:
    """Yield what Radiance's generators make, of materials that suit it."""
    source = SHARED / "radiance" / "gen" / "ref"
    shutil.copytree(source, folder, dirs_exist_ok=True)
    bumpy = (folder / "gensurf.rad").read_text()
    (folder / "gensurf_faceted.rad").write_text(without_smoothing(bumpy))
    texts = {
        "plastic": "void plastic {0} 0 0 5 .5 .4 .3 .04 .1\n",
        "metal": "void metal {0} 0 0 5 .8 .7 .4 .9 .1\n",
        "smooth metal": "void metal {0} 0 0 5 .8 .7 .4 .9 0\n",
        "trans": "void trans {0} 0 0 7 .8 .8 .8 .04 .1 .5 .3\n",
        "glass": "void glass {0} 0 0 3 .6 .7 .8\n",
    }
    for stem, kind in (
        ("genblinds", "trans"),
        ("genbox", "metal"),
        ("genprism", "glass"),
        ("genrev", "smooth metal"),
        ("genrev", "plastic"),
        ("gensurf", "metal"),
        ("gensurf_faceted", "metal"),
        ("gensurf", "trans"),
        ("genworm", "plastic"),
    ):
        name = "mat" if stem == "genblinds" else "tmat"
        file = folder / f"{kind.replace(' ', '_')}_{name}.rad"
        file.write_text(texts[kind].format(name))
        yield placed(f"{stem}, {kind}", folder, (file.name, f"{stem}.rad"))


def without_smoothing(text: str) -> str:
    """Return a generator's scene without the textures that smooth it."""
    textures = r"(?m)^tmat texfunc Phong\n.*\n0\n(?:.+\n)+"
    return re.sub(textures, "", text).replace("Phong", "tmat")


def boxes(folder: Path) -> Iterator[Model]:
    """Yield the Cornell box of Radiance's tests, lit by its own lamp.

    Its second version names a BSDF without a file and is read by neither program.
    """
    shutil.copytree(SHARED / "radiance" / "cornell_box", folder, dirs_exist_ok=True)
    points = [[-0.2, -0.2, -0.49], [0.3, 0.1, -0.49], [0.3, 0.3, 0], [0, 0, -0.45]]
    normals = [[0, 0, 1], [0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    sensors = Sensors(np.array(points), np.array(normals, float))
    view = "-vtv -vp .49 0 0 -vd -1 0 0 -vu 0 0 1 -vh 80 -vv 80"
    yield Model("cornell", folder, ("cornell.rad",), view, sensors, shines=True)


def classroom(folder: Path) -> Iterator[Model]:
    """Yield the classrooms of IER-UNAM: a grid over the room, the darkest included."""
    source = SHARED / "models" / "ier_unam_classrooms"
    shutil.copytree(source, folder, dirs_exist_ok=True)
    shutil.copy(folder / "materiales.rad", folder / "modelo" / "materiales.rad")
    (folder / "rooms").mkdir(exist_ok=True)
    for stem, eye in (
        ("A10-1", "-vp 33 3 11.2 -vd -1 .1 -.1"),
        ("A40-1", "-vp 20 6 11.2 -vd 1 -.1 -.1"),
    ):
        shutil.copy(folder / f"{stem}.rad", folder / "rooms" / f"{stem}.rad")
        points = folder / "modelo" / "objects"
        grid, eyes = points / f"{stem}.pts", points / f"DGPu_{stem}.pts"
        every = np.loadtxt(grid if grid.is_file() else eyes)
        chosen = every[np.linspace(0, len(every) - 1, 10).astype(int)]
        sensors = Sensors(chosen[:, :3], chosen[:, 3:])
        view = f"-vtv {eye} -vu 0 0 1 -vh 70 -vv 50"
        yield Model(
            f"classroom {stem}",
            folder / "rooms",
            (f"{stem}.rad",),
            view,
            sensors,
            directions=_IN_ROOMS,
        )


def tutorial(folder: Path) -> Iterator[Model]:
    """Yield LBNL's tutorial room behind its clear glass."""
    place = room(folder)
    files = (*(str(f.relative_to(place.folder)) for f in place.files),)
    every = cl.read_sensors(place.points)
    chosen = np.linspace(0, len(every.position) - 1, 10).astype(int)
    sensors = Sensors(every.position[chosen], every.direction[chosen])
    view = "-vtv -vp .105 1.753 1.55 -vd .99668 -.05824 -.05695 -vu 0 0 1 -vh 65 -vv 45"
    yield Model(
        "tutorial room",
        place.folder,
        (*files, "objects/Glazing.rad"),
        view,
        sensors,
        directions=_IN_ROOMS,
    )


def honeybees(folder: Path) -> Iterator[Model]:
    """Yield models of honeybee as scene files; their window groups are left open.

    In the others rooms share walls drawn twice, as floor and as ceiling, and which of
    two materials in one plane a ray meets no program says; or they have no grids; or
    they are three centimetres wide.
    """
    folder.mkdir()
    home = SHARED / "models" / "hbjson_honeybee-radiance"
    for stem in ("two_rooms", "large_light_path_model"):
        model = cl.read_hbjson(home / f"{stem}.hbjson")
        (folder / f"{stem}.rad").write_text(format_rad(model.scene, bsdf_file={}))
        points = np.concatenate([g.position for g in model.grids.values()])
        normals = np.concatenate([g.direction for g in model.grids.values()])
        chosen = np.linspace(0, len(points) - 1, 10).astype(int)
        sensors = Sensors(points[chosen], normals[chosen])
        eye = " ".join(f"{x:g}" for x in points[len(points) // 2] + [0, 0, 0.5])
        view = f"-vtv -vp {eye} -vd 1 .6 -.1 -vu 0 0 1 -vh 80 -vv 60"
        yield Model(
            stem.replace("_", " "),
            folder,
            (f"{stem}.rad",),
            view,
            sensors,
            directions=_IN_ROOMS,
        )


def placed(name: str, folder: Path, files: tuple[str, ...]) -> Model:
    """Return files on a floor as large as ten of them, with sensors around."""
    box = radiance(f"getbbox -h {' '.join(files)}", folder)
    low, high = np.array(box.split(), float).reshape(3, 2).T
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low))
    z = low[2] - 1e-3 * size
    corners = [(-5, -5), (5, -5), (5, 5), (-5, 5)]
    floor = " ".join(
        f"{middle[0] + x * size:g} {middle[1] + y * size:g} {z:g}" for x, y in corners
    )
    text = "void plastic the_floor 0 0 5 .3 .3 .3 0 0\n"
    text += f"the_floor polygon f 0 0 12 {floor}\n"
    made = folder / f"floor_{name.replace(' ', '_').replace(',', '')}.rad"
    made.write_text(text)
    around = [(0.45, 0), (-0.45, 0.05), (0.05, 0.5), (0, -0.45)]
    points = [middle + size * np.array([x, y, 0]) for x, y in around]
    for i, height in enumerate((0.02, 0.1, 0.2, 0.05)):
        points[i][2] = z + height * size
    normals = [[0, 0, 1], [1, 0, 0], [0, -1, 0], [0, 1, 0]]
    sensors = Sensors(np.array(points), np.array(normals, float))
    eye = middle + size * np.array([0.9, -1.1, 0.6])
    sight = middle - eye
    view = (
        f"-vtv -vp {eye[0]:g} {eye[1]:g} {eye[2]:g}"
        f" -vd {sight[0]:g} {sight[1]:g} {sight[2]:g} -vu 0 0 1 -vh 40 -vv 40"
    )
    return Model(name, folder, (*files, made.name), view, sensors)


def radiance(command: str, folder: Path, stdin: str | None = None) -> str:
    """Run a command of Radiance."""
    done = subprocess.run(
        command, shell=True, cwd=folder, env=ENVIRONMENT, input=stdin, text=True,
        capture_output=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"{command}: {done.stderr}")
    return done.stdout
