"""LBNL's five-phase tutorial as one command, from a cold start.

    python benchmarks/tutorial.py [--resolution 400] [--write FILE]

The tutorial's room, blind, 100 points, two views of 400 pixels and 40 hours, all steps
of the five-phase method, sensors and pictures: `clerestory run` on one study file, in a
process of its own, with nothing compiled before. The errors are those of the pictures
of all hours, from runs with other seeds at a lower resolution, which does not change
the error of a pixel.

Radiance runs the tutorial's own steps beside it, pictures at `--columns` columns. Their
times are multiplied by the ratio of the numbers of pixels. The products with the skies
and writing the pictures are left out of Radiance's time and not of ours.
"""

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duel import stamp
from rooms import SHARED, workplace

import clerestory as cl
from clerestory.bsdf.xml_writer import write_bsdf

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))

from tutorial import Effort, Tutorial
from tutorial_pair import Pair

# Beside the interpreter, whatever the PATH
PROGRAM = Path(sys.executable).parent / "clerestory"
VIEWS = ("south", "eastBlinds")

STUDY = """\
title = "LBNL's tutorial of the five-phase method"
method = "5-phase"

[scene]
files = ["materials.rad", "room.rad"]

[[window]]
name = "glazing"
file = "objects/GlazingVmtx.rad"
bsdf = "blinds/blinds.xml"
sun_bsdf = "blindsT4.xml"

[[sensors]]
name = "points"
file = "points.txt"
{views}
[weather]
file = "assets/NYC.wea"

[sky]
subdivision = 1

[sun]
picture_samples = {sun_samples}

[trace]
relative_error = 0.01
bounces = 4
seed = {seed}

[output]
csv = false
"""

VIEW = """
[[view]]
file = "views/{name}.vf"
resolution = {resolution}
samples = {samples}
pictures = "every"
"""


@dataclass(frozen=True)
class Run:
    """One run of the study.

    Attributes
    ----------
    wall, processor : [s]
    memory : most that the process held [GB]
    seconds : of each part, as the run tells them
    """

    folder: Path
    wall: float
    processor: float
    memory: float
    seconds: dict[str, float]


def tutorial(folder: Path) -> Path:
    """Copy the tutorial's files and generate the tree that it names; return where."""
    home = folder / "tutorial"
    shutil.copytree(SHARED, home)
    for path in [home, *home.rglob("*")]:
        path.chmod(0o755 if path.is_dir() else 0o644)
    blind = cl.read_rad(home / "blinds" / "blinds.rad")
    tree = cl.generate_bsdf(
        blind, basis="tree4", halvings=5, sides="front", samples=1000, geometry=False
    )
    write_bsdf(home / "blindsT4.xml", tree)
    return home


def run(home: Path, name: str, options: argparse.Namespace, seed: int = 1) -> Run:
    """Run the study in a process that has compiled nothing yet."""
    views = "".join(
        VIEW.format(name=v, resolution=options.resolution, samples=options.samples)
        for v in VIEWS
    )
    text = STUDY.format(views=views, sun_samples=options.sun_samples, seed=seed)
    study, out = home / f"{name}.toml", home / name
    study.write_text(text)
    cold = home / f"{name}_home"
    cold.mkdir()
    command = [PROGRAM, "run", study, "--out", out, "--quiet"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    subprocess.run(command, check=True, env={**os.environ, "HOME": str(cold)})
    wall = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = sum(
        getattr(after, key) - getattr(before, key) for key in ("ru_utime", "ru_stime")
    )
    seconds = json.loads((out / "run.json").read_text())["seconds"]
    return Run(out, wall, processor, after.ru_maxrss / 1e6, seconds)


def pixels(made: Run, view: str) -> np.ndarray:
    """Luminance of all pictures of a view [cd/m²]."""
    files = sorted((made.folder / "pictures").glob(f"{view}_*.hdr"))
    return np.stack([cl.read_picture(file).luminance() for file in files])


def noise(home: Path, options: argparse.Namespace) -> dict[str, float]:
    """Root mean square error of the pictures over their mean, by view."""
    small = argparse.Namespace(**{**vars(options), "resolution": options.small})
    runs = [run(home, f"small{seed}", small, seed) for seed in (1, 2, 3)]
    found = {}
    for view in VIEWS:
        values = np.stack([pixels(made, view) for made in runs])
        spread = np.sqrt(values.var(axis=0, ddof=1).mean())
        found[view] = float(spread / values.mean())
    return found


@dataclass(frozen=True)
class Peer:
    """Radiance's run of the tutorial.

    Attributes
    ----------
    points : processor time of the matrices of all points [s]
    pictures : of each view's matrices, for the resolution of ours [s]
    errors : root mean square error of pixels over their mean, by view
    """

    points: float
    pictures: dict[str, float]
    errors: dict[str, float]

    def at_error(self, wanted: dict[str, float]) -> float:
        """Return the processor time of pictures to the errors `wanted` [s]."""
        return sum(
            seconds * (self.errors[view] / wanted[view]) ** 2
            for view, seconds in self.pictures.items()
        )


def radiance(home: Path, options: argparse.Namespace) -> Peer:
    """Run Radiance's steps of the tutorial."""
    # Rays spread over the area of a pixel at full resolution
    jitter = options.columns / options.resolution
    effort = Effort(runs=2, columns=options.columns, jitter=jitter)
    made = Tutorial.copied(SHARED, home / "radiance", effort)
    pair = Pair(made, (home / "blindsT4.xml").resolve())
    steps = [
        lambda: made.view(0, direct=False),
        lambda: made.view(0, direct=True),
        lambda: made.daylight(0, direct=False),
        lambda: made.daylight(0, direct=True),
        lambda: made.sun(0, pair.octree),
    ]
    points = sum(processor_seconds(step) for step in steps)
    scale = (options.resolution / options.columns) ** 2
    pictures, errors = {}, {}
    for view in VIEWS:
        steps = [
            lambda view=view: made.pixels(view, direct=False),
            lambda view=view: made.pixels(view, direct=True),
            lambda view=view: made.sun_pixels(view, pair.octree),
        ]
        pictures[view] = scale * sum(processor_seconds(step) for step in steps)
        _, theirs, shown = pair.pictures(view)
        mean = theirs.mean[shown].mean()
        errors[view] = float(np.sqrt(theirs.variance[shown].mean()) / mean)
    return Peer(points, pictures, errors)


def processor_seconds(step: Callable[[], object]) -> float:
    """Return the processor time of the programs that a step runs [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    step()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def percentages(errors: dict[str, float]) -> str:
    """Return the errors of all views as text."""
    return ", ".join(f"{view} {value:.1%}" for view, value in errors.items())


def report(
    made: Run, errors: dict[str, float], peer: Peer, options: argparse.Namespace
) -> str:
    """Return the page."""
    pictures, equal = sum(peer.pictures.values()), peer.at_error(errors)
    rows = [f"| {name} | {took:.1f} |" for name, took in made.seconds.items()]
    lines = [
        "# LBNL's five-phase tutorial, whole",
        "",
        f"{stamp()}. Made by `benchmarks/tutorial.py`.",
        "",
        f"100 points, two views of {options.resolution} pixels, 40 hours, from a cold"
        " start: no kernel compiled, no matrix kept.",
        "",
        "| processor seconds on this machine | | error of a pixel |",
        "|---|---|---|",
        f"| `clerestory run`, all of it | {made.processor:.0f} |"
        f" {percentages(errors)} |",
        f"| Radiance, matrices of the points | {peer.points:.0f} | |",
        f"| Radiance, matrices of the pictures | {pictures:.0f} |"
        f" {percentages(peer.errors)} |",
        f"| the same to our error | {equal:.0f} | {percentages(errors)} |",
        "",
        f"**Radiance takes {(peer.points + equal) / made.processor:.0f} times as long**"
        " to the same error of the pictures. Its pictures were traced at"
        f" {options.columns} columns, and the time multiplied by the ratio of the"
        " numbers of pixels. Its products with the skies are left out, and pixels"
        " within 3° of the sun are left out of its error; both favour it. An error is"
        " the root mean square over all pixels and hours, divided by the mean. Ours is"
        " with"
        f" {options.samples} paths a pixel, {options.sun_samples} to the windows.",
        "",
        "| `clerestory run` | wall seconds |",
        "|---|---|",
        f"| all | {made.wall:.1f} |",
        *rows,
        "",
        f"Most memory: {made.memory:.1f} GB. Load of the machine when it ended:"
        f" {os.getloadavg()[0]:.1f}.",
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--resolution", type=int, default=400)
    parser.add_argument("--small", type=int, default=64, help="to measure the error")
    parser.add_argument("--samples", type=int, default=32, help="per pixel")
    parser.add_argument(
        "--sun-samples", type=int, default=20, help="per pixel, to the windows"
    )
    parser.add_argument(
        "--columns", type=int, default=32, help="of Radiance's pictures"
    )
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    home = tutorial(workplace())
    made = run(home, "whole", options)
    text = report(made, noise(home, options), radiance(home, options), options)
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
