"""BSDFs generated from geometry against genBSDF's Python port, at equal error.

    python benchmarks/generate_bsdf.py [--runs 3] [--parts matrices …] [--write FILE]

The crash-course blind: 80 mm slats every 72 mm at 45°, reflectance 0.48, 14 slats of
1 m; both sides, transmission and reflection, five bounces. Errors are root mean
squares over all values, over their mean, against two long runs of ours: the mean
product of what is off either has no noise of theirs in it. Work is seconds of all
processors × variance, which other programs on the machine hardly disturb. genBSDF's
defaults take minutes, and run once. The page is written anew with all parts.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyradiance
from duel import ENVIRONMENT, stamp
from pyradiance.genbsdf import SamplingBox

import clerestory as cl
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_lookup import cells
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.engine import device as devices
from clerestory.hemisphere.klems import klems
from clerestory.radiance.rad_writer import format_rad

BOUNCES = 5
HALVINGS = 5
PARTS = (
    ("front", "transmittance"),
    ("front", "reflectance"),
    ("back", "transmittance"),
    ("back", "reflectance"),
)
NAMES = (
    "transmission_front",
    "reflection_front",
    "transmission_back",
    "reflection_back",
)
PARTS_OF_PAGE = ("matrices", "defaults", "trees")
LONG_SEEDS = 98, 99
TUNED = ["-ad", "1", "-lw", "1e-6"]


@dataclass(frozen=True)
class Contender:
    """One way to make the values.

    Attributes
    ----------
    name : for the table
    make : the work, for a run's number
    read : makes one array of all values of what was made; it does not count
    peer : whether it is the other program
    """

    name: str
    make: Callable[[int], Any]
    read: Callable[[Any], np.ndarray]
    peer: bool = False


def blind() -> System:
    """Return the crash-course blind as a finite sample, for both programs."""
    return venetian(
        slat_width=0.08,
        spacing=0.072,
        tilt_deg=45,
        reflectance=0.48,
        slats=14,
        length=1.0,
    )


def peer(scene: bytes, params: list[str], samples: int, **options: int):
    """Return what runs genBSDF's port, and its data by side and part."""
    area = SamplingBox(*blind().area.bounds.T.ravel().tolist())
    made = pyradiance.generate_bsdf(
        scene,
        params=params,
        nsamp=samples,
        nproc=os.cpu_count(),
        dim=area,
        **options,
    )
    return [getattr(getattr(made, side), part).decode() for side, part in PARTS]


def read_peer_matrices(texts: list[str]) -> np.ndarray:
    """Return its matrices [1/sr]."""
    found = []
    for text in texts:
        rows = [np.array(line.split(), float) for line in text.splitlines()]
        found.append(np.array([row for row in rows if len(row)]))
    return np.array(found) / klems("full").projected_solid_angles()[:, None]


def ours(samples: int, seed: int, **options: Any) -> cl.Bsdf:
    """Return our BSDF of the blind."""
    options = {"bounces": BOUNCES, "geometry": False, **options}
    return cl.generate_bsdf(blind(), samples=samples, seed=seed, **options)


def read_matrices(made: cl.Bsdf) -> np.ndarray:
    """Return our matrices [1/sr]."""
    return np.array([made.functions["visible", name].values for name in NAMES])


def expanded(tree: ScatteringTree) -> np.ndarray:
    """Return the values of all finest cells."""
    wide = 1 << HALVINGS
    grid = np.empty((wide,) * 4, dtype=np.float32)
    for level, place, value in cells(tree.slots, 4):
        edge = wide >> level
        for corner, one in zip((place * edge).T, value, strict=True):
            grid[tuple(slice(c, c + edge) for c in corner)] = one
    return grid


def read_peer_trees(texts: list[str]) -> np.ndarray:
    """Return its values at the back on the finest cells [1/sr]."""
    tables = [parse_tree(text.encode(), rank=4) for text in texts[2:]]
    return np.array([expanded(ScatteringTree(t.slots, 4, t.depth)) for t in tables])


def read_trees(made: cl.Bsdf) -> np.ndarray:
    """Return our values at the back on the finest cells [1/sr]."""
    return np.array([expanded(made.functions["visible", n]) for n in NAMES[2:]])


def long_trees(samples: int, seed: int) -> np.ndarray:
    """Return bare counts of a long run on the finest cells, none of them joined."""
    engine = devices.load("auto", "sample_area_tree")
    system = blind()
    slab = engine.lower_slab(system.scene, system.area.slab(), periodic=False)
    grid = engine.Grid(4, HALVINGS, HALVINGS)
    rows = np.arange(grid.incidents)
    found = engine.trace_block(
        slab, grid, 0, [(rows, 0, samples)], back=True, segments=BOUNCES + 1, seed=seed
    )
    value = np.zeros((2, grid.cells))
    for part, scores in zip(value, found, strict=True):
        part[scores.cell] = scores.sums[:, 0] / (samples * np.pi / 4**HALVINGS)
    bits = value.reshape(2, *(2,) * (4 * HALVINGS))
    order = [
        1 + 4 * level + (3 - dimension)
        for dimension in range(4)
        for level in range(HALVINGS)
    ]
    return bits.transpose(0, *order).reshape(2, *(1 << HALVINGS,) * 4)


def processor_seconds() -> float:
    """Return what this process and its children have used so far [s]."""
    used = [
        resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    ]
    return sum(u.ru_utime + u.ru_stime for u in used)


def duel(
    title: str,
    contenders: list[Contender],
    truth: tuple[np.ndarray, np.ndarray],
    runs: int,
) -> str:
    """Run all in turns and return a Markdown table; a first run does not count."""
    wall: dict[str, list[float]] = {c.name: [] for c in contenders}
    used: dict[str, list[float]] = {c.name: [] for c in contenders}
    square: dict[str, list[float]] = {c.name: [] for c in contenders}
    for contender in contenders:
        if not contender.peer:
            contender.make(0)
    for run in range(1, runs + 1):
        for contender in contenders:
            begin, before = time.perf_counter(), processor_seconds()
            made = contender.make(run)
            used[contender.name].append(processor_seconds() - before)
            wall[contender.name].append(time.perf_counter() - begin)
            values = contender.read(made)
            error = np.mean((values - truth[0]) * (values - truth[1]))
            error /= truth[0].mean() * truth[1].mean()
            square[contender.name].append(float(error))
    work = {n: np.median(used[n]) * np.mean(square[n]) for n in used}
    peers = [c.name for c in contenders if c.peer]
    heads = " | ".join(f"× {name}" for name in peers)
    how = "one run of each" if runs == 1 else f"medians of {runs} runs in turns"
    lines = [f"## {title}", "", f"{stamp()}; {how}.", ""]
    lines += [f"| | seconds | processor seconds | error | {heads} |"]
    lines += ["|---|---|---|---|" + "---|" * len(peers)]
    for name in used:
        ratios = " | ".join(f"{work[p] / work[name]:.1f}" for p in peers)
        lines.append(
            f"| {name} | {np.median(wall[name]):.2f} | {np.median(used[name]):.2f}"
            f" | {np.sqrt(np.mean(square[name])):.4f} | {ratios} |"
        )
    return "\n".join(lines)


def matrices(scene: bytes, runs: int, *, defaults: bool) -> str:
    """Compare matrices."""

    def theirs(name: str, params: list[str], samples: int) -> Contender:
        def make(_: int) -> list[str]:
            return peer(scene, params, samples)

        return Contender(f"genBSDF's port, {name}", make, read_peer_matrices, peer=True)

    def of(count: int, name: str = "", **options: Any) -> Contender:
        def make(seed: int) -> cl.Bsdf:
            return ours(count, seed, **options)

        return Contender(f"{count:,} paths a patch{name}", make, read_matrices)

    def command(seed: int) -> Path:
        # Start, read, trace, write: all that a user waits for
        words = "slat_width=0.08,spacing=0.072,tilt_deg=45,reflectance=0.48"
        path = Path(tempfile.gettempdir()) / "clerestory_blind.xml"
        program = str(Path(sys.executable).with_name("clerestory"))
        line = [program, "bsdf", "generate", "--venetian"]
        line += [f"{words},slats=14,length=1", "--samples", "2048", "--seed", str(seed)]
        line += ["--bounces", str(BOUNCES), "--no-geometry", "--quiet", "-o", str(path)]
        subprocess.run(line, check=True)
        return path

    def read(path: Path) -> np.ndarray:
        return read_matrices(cl.read_bsdf(path))

    tuned = theirs("tuned (-ad 1 -lw 1e-6, 8000 samples)", TUNED, 8000)
    one, other = (read_matrices(ours(1 << 17, seed)) for seed in LONG_SEEDS)
    if defaults:
        found = [tuned, theirs("its defaults (-ad 700) at 500 samples", [], 500)]
        found += [of(count) for count in (2048, 8192, 32768)]
        found.append(of(8192, ", reciprocal", reciprocal=True))
        return duel("The same beside its defaults", found, (one, other), runs)
    found = [tuned, *(of(count) for count in (2048, 8192, 32768))]
    found.append(of(2048, ", without its mirror", symmetry=False))
    found.append(of(8192, ", without its mirror", symmetry=False))
    found.append(Contender("2,048 paths a patch, new process to file", command, read))
    return duel("Klems matrices of a blind, both sides", found, (one, other), runs)


def trees(scene: bytes, runs: int) -> str:
    """Compare trees of one side."""
    options = {"tensortree": 4, "ttlog2": HALVINGS, "front": False}

    def theirs(samples: int) -> Contender:
        def make(_: int) -> list[str]:
            return peer(scene, TUNED, samples, **options)

        name = f"genBSDF's port, -t4 {HALVINGS}, tuned, {samples:,} samples"
        return Contender(name, make, read_peer_trees, peer=True)

    def of(count: int) -> Contender:
        def make(seed: int) -> cl.Bsdf:
            more = {"basis": "tree4", "halvings": HALVINGS, "sides": "back"}
            return ours(count, seed, **more)

        return Contender(f"{count:,} paths a cell", make, read_trees)

    # One path a cell costs what is fixed
    ours_at = (1, 250, 500, 1000, 2000, 4000)
    found = [theirs(n) for n in (500, 2000)] + [of(n) for n in ours_at]
    title = f"Tensor trees of 2^{HALVINGS} cells an axis, light from the back"
    one, other = (long_trees(20_000, seed) for seed in LONG_SEEDS)
    return duel(title, found, (one, other), runs)


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--parts", nargs="+", choices=PARTS_OF_PAGE, default=None)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    os.environ.update(ENVIRONMENT)
    scene = format_rad(blind().scene, bsdf_file={}).encode()
    page = "# BSDFs from geometry beside genBSDF\n"
    for part in options.parts or PARTS_OF_PAGE:
        if part == "trees":
            table = trees(scene, options.runs)
        else:
            slow = part == "defaults"
            table = matrices(scene, 1 if slow else options.runs, defaults=slow)
        print(table, flush=True)
        page += "\n" + table + "\n"
    if options.write:
        options.write.write_text(page)


if __name__ == "__main__":
    main()
