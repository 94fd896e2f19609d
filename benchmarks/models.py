"""Every model at hand, ours over Radiance's: sensors under five skies and a picture.

    python benchmarks/models.py [--only WORD] [--write FILE]

Furniture stands on a grey floor in the open; the classroom and the boxes are as their
authors made them. Radiance runs without interpolation of indirect light (-aa 0), its
rays cut as late as they may; both count two bounces. Sensors are compared by the sum
and by the worst of them in units of the joint error, pictures by their mean luminance.
What a model names but does not bring, stand-ins written here supply to both programs.
"""

import argparse
import shutil
import subprocess
import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duel import ENVIRONMENT, stamp

import clerestory as cl
from clerestory.phases.render import irradiance
from clerestory.scene.sensors import Sensors

SHARED = Path(__file__).parents[2] / "shared" / "data"

BOUNCES = 2
SKIES = {
    "sunny": "gensky -ang 50 -30 +s",
    "clear": "gensky -ang 25 60 -s",
    "between": "gensky -ang 40 20 +i",
    "overcast": "gensky -ang 35 10 -c",
    "perez": "gendaylit -ang 45 40 -W 500 150",
}
DOME = (
    "\nskyfunc glow dome 0 0 4 1 1 1 0\ndome source sky 0 0 4 0 0 1 180\n"
    "dome source ground 0 0 4 0 0 -1 180\n"
)

# Repetitions of a sensor, and directions of its first gather
_AGAIN, _DIRECTIONS = 64, 32

# Paths of a sensor of ours
_SAMPLES = 1 << 15

# Stand-ins for function files of Radiance's old library that are no longer given out
WOOD = """{ Rings of wood about an axis, lighter and darker by A1. }
ring(u, v) = 1 - A1*.35*(.5 + .5*sin(14*sqrt(u*u + v*v) + 2*noise3(u, v, .3)));
xgrain = ring(Py, Pz);
ygrain = ring(Px, Pz);
zgrain = ring(Px, Py);
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
    """

    name: str
    folder: Path
    files: tuple[str, ...]
    view: str
    sensors: Sensors
    shines: bool = False


def furniture(folder: Path) -> Iterator[Model]:
    """Yield the furniture of Greg Ward's collection, each piece on a floor."""
    source = SHARED / "models" / "gjward_furniture"
    shutil.copytree(source, folder, dirs_exist_ok=True)
    (folder / "woodpat.cal").write_text(WOOD)
    (folder / "marble.cal").write_text(MARBLE)
    for file in sorted(folder.glob("*.rad")):
        yield placed(file.stem, folder, (file.name,))


def shapes(folder: Path) -> Iterator[Model]:
    """Yield what Radiance's generators make, of materials that suit it."""
    source = SHARED / "radiance" / "gen" / "ref"
    shutil.copytree(source, folder, dirs_exist_ok=True)
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
        ("gensurf", "trans"),
        ("genworm", "plastic"),
    ):
        name = "mat" if stem == "genblinds" else "tmat"
        file = folder / f"{kind.replace(' ', '_')}_{name}.rad"
        file.write_text(texts[kind].format(name))
        yield placed(f"{stem}, {kind}", folder, (file.name, f"{stem}.rad"))


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
            f"classroom {stem}", folder / "rooms", (f"{stem}.rad",), view, sensors
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


def octree(model: Model, sky: str) -> list[str]:
    """Compile a model under a sky; return its files."""
    files = [*model.files]
    if sky:
        (model.folder / "the_sky.rad").write_text(f"!{SKIES[sky]}\n{DOME}")
        files.append("the_sky.rad")
    radiance(f"oconv {' '.join(files)} > model.oct", model.folder)
    return files


def radiance(command: str, folder: Path, stdin: str | None = None) -> str:
    """Run a command of Radiance."""
    done = subprocess.run(
        command, shell=True, cwd=folder, env=ENVIRONMENT, input=stdin, text=True,
        capture_output=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"{command}: {done.stderr}")
    return done.stdout


_EXACT = "-aa 0 -as 0 -st 0 -lw 1e-8 -lr 8 -ds .05 -dj 1 -dc 1 -dt 0 -dr 3"


def sensors(model: Model, sky: str) -> tuple[float, float, float, float]:
    """Return ours over theirs, its error, and the worst sensor: in errors, relative."""
    files = octree(model, sky)
    point = np.concatenate([model.sensors.position, model.sensors.direction], axis=1)
    rays = np.repeat(point, _AGAIN, axis=0)
    # Single samples of highlights, which it takes of weak rays, overrate metals
    shine = 5000 if "metal" in model.name else 32
    text = radiance(
        f"rtrace -h -w -I -ab {BOUNCES} -ad {_DIRECTIONS} -ss {shine} {_EXACT}"
        " model.oct",
        model.folder,
        "\n".join(" ".join(f"{x:.9g}" for x in ray) for ray in rays),
    )
    seen = np.array(text.split(), float).reshape(-1, _AGAIN, 3)
    weights = np.array([0.265, 0.67, 0.065])
    theirs = seen.mean(axis=1) @ weights
    spread = (seen @ weights).std(axis=1, ddof=1) / _AGAIN**0.5
    ours = irradiance(
        cl.read_rad(*(model.folder / f for f in files)),
        model.sensors,
        samples=_SAMPLES,
        bounces=BOUNCES,
        seed=1,
        device="cpu",
    )
    own = ours.irradiance @ weights
    error = np.hypot(ours.error @ weights, spread)
    off = np.abs(own - theirs)
    worst = np.max(off / np.maximum(error, 1e-9))
    far = np.max(off / theirs)
    total = theirs.sum()
    return own.sum() / total, np.sqrt((error**2).sum()) / total, worst, far


def picture(model: Model, sky: str, side: int) -> tuple[float, float]:
    """Return the mean luminance of ours over theirs, and its error."""
    files = octree(model, sky)
    view = cl.parse_view(model.view)
    columns, rows = view.size_for(side)
    halves = []
    for run in range(2):
        # Another size takes other samples
        size = side + run
        radiance(
            f"rpict {model.view} -x {size} -y {size} -ab {BOUNCES} -ad 48 -ss 16"
            f" {_EXACT} -ps 1 -pt 0 -pj 1 model.oct > theirs_{run}.hdr",
            model.folder,
        )
        made = cl.read_picture(model.folder / f"theirs_{run}.hdr")
        halves.append(float(made.luminance().mean(dtype=float)))
    ours = cl.render(
        cl.read_rad(*(model.folder / f for f in files)), view, columns=columns,
        rows=rows, samples=512, bounces=BOUNCES, seed=1, device="cpu",
    )  # fmt: skip
    own = float(ours.picture.luminance().mean(dtype=float))
    theirs = float(np.mean(halves))
    return own / theirs, abs(halves[0] - halves[1]) / 2 / theirs


def table(models: list[Model], side: int) -> list[str]:
    """Return a Markdown table, one row a model."""
    lines = [
        "### Every model at hand, ours over Radiance's",
        "",
        stamp(),
        "",
        f"| model | {' | '.join(SKIES)} | worst sensor | picture |",
        "|---" * (len(SKIES) + 3) + "|",
    ]
    for model in models:
        cells, worst = [], []
        for sky in SKIES:
            if model.shines and cells:
                cells.append("")
                continue
            try:
                share, error, sigma, far = sensors(model, "" if model.shines else sky)
            except cl.ClerestoryError as refused:
                cells.append(f"refused: {refused}")
                break
            cells.append(f"{share:.4f} ± {error:.4f}")
            worst.append((far, sigma))
        if len(cells) < len(SKIES):
            lines.append(f"| {model.name} | {cells[-1]} |")
            print(lines[-1], flush=True)
            continue
        far, sigma = max(worst)
        share, error = picture(model, "" if model.shines else "sunny", side)
        cells += [f"{far:.1%}, {sigma:.1f} σ", f"{share:.4f} ± {error:.4f}"]
        lines.append(f"| {model.name} | {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    return lines


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="models whose name holds this word")
    parser.add_argument("--side", type=int, default=48, help="pixels of a picture")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as place:
        models = []
        for group in (boxes, shapes, furniture, classroom):
            folder = Path(place, group.__name__)
            models += [m for m in group(folder) if options.only in m.name]
        lines = table(models, options.side)
    if options.write:
        options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
