"""Annual glare of a fisheye view by the five-phase method, from a cold start.

    python benchmarks/annual_pictures.py [--resolution 400 800] [--oracle 60]
                                         [--steps N] [--tree FILE] [--write FILE]

The demo room behind a tensor tree of a venetian blind (2^6 cells per axis, unscattered
transmission extracted), a year of Greensboro: `clerestory run` on one study file, in a
process of its own, with nothing compiled before. DGP of every daylit hour is included.
`--steps` selects some hours instead of the year, to try the script.

With `--oracle N`, luminance and DGP of N suns of the year, half of them close to the
cut-off angle of the blind, are compared with the pairwise estimator of direct sunlight,
which traces paths of its own for every pixel and sun, and with V_d of other paths.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pvlib
import xarray as xr
from duel import stamp

import clerestory as cl
from clerestory.bands import RGB
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.glare.annual_glare import annual_glare
from clerestory.image.camera import Camera
from clerestory.matrix.axis import pixel_axis, sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import FIVE_PHASE
from clerestory.phases.picture_matrices import (
    picture_view_matrices,
    reflected_view_matrices,
)
from clerestory.phases.picture_series import luminance_over_time
from clerestory.phases.shaded_windows import (
    ShadedWindow,
    ShadeState,
    receiving_matrices,
)
from clerestory.phases.sunlit import in_sunlight
from clerestory.phases.traced_matrices import daylight_matrix
from clerestory.phases.window_paths import picture_window_paths
from clerestory.scene.model import Scene
from clerestory.scene.view import View
from clerestory.scene.window import Window
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.sky.weather import Weather
from clerestory.study.new_study import write_demo

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "physics"))
from pairwise_sun import pairwise_sun

# Beside the interpreter, whatever the PATH
PROGRAM = Path(sys.executable).parent / "clerestory"
WEATHER = "723170TYA.CSV"

# Slats of the blind [m], and their tilt
WIDTH, SPACING, TILT_DEG = 0.08, 0.072, 20.0

VIEW = "rvu -vta -vh 180 -vv 180 -vp 3 3 1.2 -vd 0 -1 0 -vu 0 0 1\n"
EYE = View(
    kind="angular", horizontal=180, vertical=180,
    position=np.array([3, 3, 1.2]), direction=np.array([0, -1.0, 0]),
)  # fmt: skip

# Size of the pictures of the comparison, and blocks along an edge
COMPARED, BLOCKS = 400, 20

# Paths per pixel, and per pixel and sun of the pairwise estimator; suns traced at once
SAMPLES, PAIRS, TOGETHER = 64, 64, 4

STUDY = """\
title = "A year of glare in the demo room"
method = "5-phase"

[scene]
files = ["materials.rad", "room.rad"]

[[window]]
name = "south"
file = "window.rad"
bsdf = "blind.xml"
peak = true

[[sensors]]
name = "desks"
file = "desks.pts"

[[view]]
name = "desk"
file = "desk.vf"
resolution = {resolution}

[weather]
file = "{weather}"
{moments}
[sky]
subdivision = 4

[trace]
samples = 1000
seed = 1
"""


@dataclass(frozen=True)
class Run:
    """One run of the study.

    Attributes
    ----------
    wall, processor : [s]
    memory : most that the process held [GB]
    seconds : of each stage
    hours : number of hours for which glare was evaluated
    """

    resolution: int
    wall: float
    processor: float
    memory: float
    seconds: dict[str, float]
    hours: int


def prepare(folder: Path, tree: Path | None) -> Path:
    """Write the files of the study and return the folder."""
    home = folder / "study"
    write_demo(home)
    (home / "desk.vf").write_text(VIEW)
    if tree is not None and tree.exists():
        (home / "blind.xml").symlink_to(tree.resolve())
        return home
    blind = venetian(
        slat_width=WIDTH, spacing=SPACING, tilt_deg=TILT_DEG, reflectance=0.5
    )
    layer = generate_bsdf(
        blind, basis="tree4", halvings=6, sides="both", samples=200, geometry=False
    )
    write_bsdf(tree or home / "blind.xml", layer)
    if tree is not None:
        (home / "blind.xml").symlink_to(tree.resolve())
    return home


def moments(steps: int | None) -> str:
    """Return the key that selects some hours over the year, at varying times of day."""
    if steps is None:
        return ""
    days = np.datetime64("2023-01-03") + (np.arange(steps) * 361) // max(1, steps)
    hours = (570 + 300 * np.arange(steps) % 480) * np.timedelta64(1, "m")
    found = sorted(
        str(d.astype("M8[m]") + h)[5:] for d, h in zip(days, hours, strict=True)
    )
    return f"moments = {json.dumps(found)}\n"


def measure(home: Path, resolution: int, steps: int | None) -> Run:
    """Run the study in a process that has compiled nothing yet."""
    study, out = home / f"study{resolution}.toml", home / f"out{resolution}"
    study.write_text(
        STUDY.format(resolution=resolution, weather=WEATHER, moments=moments(steps))
    )
    cold = home / f"home{resolution}"
    cold.mkdir()
    command = [PROGRAM, "run", study, "--out", out, "--quiet"]
    start = time.perf_counter()
    # Wait for this process alone, to obtain its own peak memory
    child = subprocess.Popen(command, env={**os.environ, "HOME": str(cold)})
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise subprocess.CalledProcessError(child.returncode, command)
    wall = time.perf_counter() - start
    seconds = json.loads((out / "run.json").read_text())["seconds"]
    with xr.open_dataset(out / "results.nc") as results:
        hours = int(results.glare_dgp.notnull().sum())
    processor = used.ru_utime + used.ru_stime
    return Run(resolution, wall, processor, used.ru_maxrss / 1e6, seconds, hours)


def cut_off_deg() -> float:
    """Return the profile angle above which the slats stop direct sunlight."""
    tilt = np.radians(TILT_DEG)
    return float(
        np.degrees(np.arctan2(SPACING - WIDTH * np.sin(tilt), WIDTH * np.cos(tilt)))
    )


def chosen(weather: Weather, count: int) -> Weather:
    """Return sunny hours: half over the year, half close to the cut-off angle."""
    suns = sun_matrix(weather)
    step = np.asarray(suns.direct_normal.max(axis=0).todense()).ravel() > 100
    number = np.asarray(suns.direct_normal.argmax(axis=0)).ravel()
    sun = suns.directions[number]
    lit = np.flatnonzero(step & (sun[:, 1] < -0.05))
    profile = np.degrees(np.arctan2(sun[lit, 2], -sun[lit, 1]))
    near = lit[np.argsort(abs(profile - cut_off_deg()), kind="stable")[: count // 2]]
    others = np.setdiff1d(lit, near)
    spread = others[np.arange(count - len(near)) * len(others) // (count - len(near))]
    return weather.select(np.sort(np.concatenate([near, spread])))


def pairwise(
    scene: Scene, window: Window, layer: Bsdf, suns: np.ndarray, camera: Camera
) -> TransferMatrix:
    """Return C_ds by paths of their own for every pixel and sun."""
    parts = [
        pairwise_sun(
            scene, [window], layer, camera, suns[first : first + TOGETHER], peak=True,
            samples=PAIRS, seed=77 + first,
        )
        for first in range(0, len(suns), TOGETHER)
    ]  # fmt: skip
    values, error = (np.concatenate(each, axis=-1) for each in zip(*parts, strict=True))
    axes = pixel_axis(len(camera)), sun_axis(len(suns))
    return TransferMatrix(values, *axes, error[None], scene.bands)


def compare(home: Path, count: int) -> list[str]:
    """Return lines that compare pictures and DGP with the pairwise estimator."""
    scene = cl.read_rad(home / "materials.rad", home / "room.rad")
    window = cl.read_window(home / "window.rad")
    layer = cl.read_bsdf(home / "blind.xml")
    weather = chosen(cl.read_weather(home / WEATHER), count)
    camera = Camera(EYE, COMPARED, COMPARED)
    suns = sun_matrix(weather)
    sky, sun = (
        sky_matrix(weather, subdivision=4, include=part) for part in ("all", "sun")
    )
    T = layer.transmission_matrix(window=window.name)
    D = daylight_matrix(scene, window, subdivision=4, samples=4096, seed=2)
    black = blackened(scene)
    D_d = daylight_matrix(black, window, subdivision=4, bounces=0, samples=4096, seed=3)
    V = reflected_view_matrices(scene, [window], camera, samples=SAMPLES, seed=4)

    # Ours: V_d and C_ds from the same paths; theirs: independent estimates of both
    paths = picture_window_paths(scene, [window], camera, samples=16, seed=5)
    lit = in_sunlight(paths, window.name, layer, suns=suns.directions, peak=True)
    V_d = picture_view_matrices(
        scene, [window], camera, direct=True, samples=4 * SAMPLES, seed=6
    )
    pairs = pairwise(scene, window, layer, suns.directions, camera)
    state = ShadeState(whole=(T, D), direct=(T, D_d), bsdf=layer, peak=True)
    shaded, skies = [ShadedWindow(window, (state,))], Skies(sky, sun, suns)
    [own] = receiving_matrices(shaded, V, paths, suns.directions)
    reflected, direct = V[window.name], V_d[window.name]
    whole = replace(reflected, values=reflected.values + direct.values)
    chains = (window_chain(whole, T, D), window_chain(direct, T, D_d))
    pictures = [
        np.stack(list(luminance_over_time([parts], FIVE_PHASE, camera, skies)))
        for parts in (own, WindowMatrices(*chains, MatrixChain((pairs,))))
    ]

    # Direct light alone, and its error components
    received = lit.received(suns.direct_normal, RGB.weights[None])
    ours, ours_error = np.zeros((2, len(camera), len(suns.times)), np.float32)
    ours[:, received.steps] = received.mean(slice(None))[0]
    ours_error[:, received.steps] = received.error(slice(None))[0]
    theirs, theirs_error = (
        np.einsum("b,bps->ps", RGB.weights, each) @ suns.direct_normal.toarray()
        for each in (pairs.values, pairs.components[0])
    )
    light = [each.T for each in (ours, theirs, ours_error, theirs_error)]
    # Rows of V_d sum to one where a window is seen
    window_seen = direct.values[0].sum(axis=-1) > 0.9
    return _table(pictures, light, blocks(window_seen[None])[0], weather)


def blocks(pixels: np.ndarray) -> np.ndarray:
    """Return the means of blocks of pixels of several pictures."""
    edge = COMPARED // BLOCKS
    return pixels.reshape(-1, BLOCKS, edge, BLOCKS, edge).mean(axis=(2, 4))


def differences(ours: np.ndarray, theirs: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Return relative differences of blocks, and of whole pictures."""
    one, other = blocks(ours), blocks(theirs)
    # Blocks inside the circle that are not dark
    whole = other.mean(axis=(1, 2))
    lit = whole > 0
    known = other > 0.02 * whole[:, None, None]
    return [
        ("blocks", abs(one / np.where(known, other, 1) - 1)[known]),
        ("whole pictures", abs(one.mean(axis=(1, 2)) / whole - 1)[lit]),
    ]


def _table(
    pictures: Sequence[np.ndarray],
    light: Sequence[np.ndarray],
    window_share: np.ndarray,
    weather: Weather,
) -> list[str]:
    edge = COMPARED // BLOCKS
    dgp = [annual_glare(pixels, EYE).dgp.values for pixels in pictures]
    rows = [
        *((f"luminance of {n}", v) for n, v in differences(*pictures)),
        *((f"direct light alone of {n}", v) for n, v in differences(*light[:2])),
        ("DGP (absolute)", abs(dgp[0] - dgp[1])),
    ]
    # Deviation of direct light in units of its error, pooled over the suns of a block,
    # since two batches alone tell little of the error
    ours, theirs, *errors = map(blocks, light)
    pooled = np.sqrt(sum(np.square(each).mean(axis=0) for each in errors))
    inside = (pooled > 0) & (window_share == 0)
    z = (ours - theirs)[:, inside] / pooled[inside]
    return [
        f"Against pairs of {COMPARED}² pixels and {len(weather.times)} suns ({PAIRS}"
        f" paths each), half of them close to the cut-off angle ({cut_off_deg():.1f}°);"
        f" blocks of {edge} × {edge} pixels, relative differences, noise of both"
        " included:",
        "",
        "| quantity | mean | median | 95 % within | at most |",
        "|---|---|---|---|---|",
        *(
            f"| {name} | {v.mean():.4f} | {np.median(v):.4f} |"
            f" {np.quantile(v, 0.95):.4f} | {v.max():.4f} |"
            for name, v in rows
        ),
        "",
        "Direct light of blocks of the room's surfaces in units of the standard error"
        " of the difference, known from the batches of both: root mean square"
        f" {np.sqrt((z**2).mean()):.2f} (1 expected), mean {z.mean():.2f},"
        f" {(abs(z) > 3).mean():.2%} beyond 3.",
    ]


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--resolution", type=int, nargs="*", default=[400, 800])
    parser.add_argument("--steps", type=int, help="hours, in place of the year")
    parser.add_argument("--oracle", type=int, default=0, help="suns compared")
    parser.add_argument("--tree", type=Path, help="file of the tree, made if missing")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        home = prepare(Path(folder), options.tree)
        runs = [measure(home, size, options.steps) for size in options.resolution]
        lines = [
            "# A year of glare by the five-phase method",
            "",
            f"{stamp()}, pvlib {pvlib.__version__}. Made by"
            " `benchmarks/annual_pictures.py`.",
            "",
            "Demo room behind a tensor tree of a venetian blind (2^6 cells per axis,"
            " unscattered transmission extracted), one fisheye, a year of Greensboro,"
            " nothing compiled or cached before; DGP of every daylit hour included.",
            "",
            "| pixels | hours | wall | processor | most memory |",
            "|---|---|---|---|---|",
            *(
                f"| {run.resolution} × {run.resolution} | {run.hours:,} |"
                f" {run.wall:.0f} s | {run.processor:.0f} s | {run.memory:.2f} GB |"
                for run in runs
            ),
            "",
        ]
        if runs:
            lines += ["| stage | " + " | ".join(f"{r.resolution}² [s]" for r in runs)]
            lines[-1] += " |"
            lines += ["|---|" + "---|" * len(runs)]
            for stage in runs[0].seconds:
                each = (f"{run.seconds.get(stage, 0):.1f}" for run in runs)
                lines.append(f"| {stage} | " + " | ".join(each) + " |")
            lines.append("")
        if options.oracle:
            lines += [*compare(home, options.oracle), ""]
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    text = "\n".join(lines)
    print(text)
    print(f"(the comparison itself held at most {own:.2f} GB)")
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
