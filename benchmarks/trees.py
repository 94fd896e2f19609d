"""Tensor trees of three systems: time, memory, size, and light beside the matrices.

    python benchmarks/trees.py [--halvings 5 6 7] [--systems blind …] [--write FILE]

The light that a tree scatters in all, transmission and reflection together, as a share
of what comes, is compared from each of Klems' incident patches

- with bare counts of other paths on the same cells: what is off beside the noise of
  both, which the spread of two counts tells, is what joining cells has moved;
- with a matrix of many paths on the patches themselves. Cells are cut differently from
  patches, so that bare counts on cells differ from it as well: no tree can do better.

All patches together are compared with the matrix for transmission and reflection apart.
Each tree is made in a process of its own, which tells the memory it took.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.bsdf.patch_overlap import patches_in_cells
from clerestory.bsdf.resample import to_matrices
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.film_geometry import prismatic
from clerestory.bsdfgen.morton_codes import incident_code
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.engine import device as devices
from clerestory.hemisphere.klems import klems

SYSTEMS = {
    "blind": lambda: venetian(
        slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.48
    ),
    "microlouvre": microlouvre,
    "prismatic film": prismatic,
}
PATHS = {5: 2048, 6: 512, 7: 256}

# Halvings within a block of bare counts, so that a few hundred megabytes hold them.
WITHIN = {5: 5, 6: 5, 7: 4}
NAMES = ("transmission_back", "reflection_back")
LONG = 1 << 15
SEEDS = 9, 10


def matrix(name: str) -> cl.Bsdf:
    """Return matrices of many paths, for light from the room."""
    return cl.generate_bsdf(SYSTEMS[name](), samples=LONG, sides="back", seed=1)


def tree(name: str, halvings: int, samples: int) -> dict[str, float]:
    """Make a tree and return its figures."""
    begin = time.perf_counter()
    made = cl.generate_bsdf(
        SYSTEMS[name](),
        basis="tree4",
        halvings=halvings,
        samples=samples,
        sides="back",
        seed=2,
    )
    wall = time.perf_counter() - begin
    used = resource.getrusage(resource.RUSAGE_SELF)
    trees = [made.functions["visible", n] for n in NAMES]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tree.xml"
        write_bsdf(path, made, digits=4)
        size = path.stat().st_size
    return {
        "wall": wall,
        "processor": used.ru_utime + used.ru_stime,
        "memory": used.ru_maxrss / 1024**2,
        "cells": sum(_cells(t) for t in trees),
        "size": size / 1e6,
        **_differences(name, halvings, samples, made),
    }


def _cells(part: ScatteringTree) -> int:
    # Slots that hold a value, not the way to branches
    return int(np.count_nonzero(part.slots >= 0))


def counted(name: str, halvings: int, samples: int, seed: int) -> np.ndarray:
    """Return the light in all from each incident cell, as bare counts of paths."""
    engine = devices.load("auto", "sample_area_tree")
    system = SYSTEMS[name]()
    slab = engine.lower_slab(
        system.scene, system.area.slab(), periodic=system.area.periodic
    )
    grid = engine.Grid(4, halvings, WITHIN[halvings])
    rows = np.arange(grid.incidents)
    light = np.zeros((1 << halvings, 1 << halvings))
    for block in range(grid.blocks):
        found = engine.trace_block(
            slab,
            grid,
            block,
            [(rows, 0, samples)],
            back=True,
            segments=1 << 30,
            seed=seed,
        )
        number = block * grid.incidents + rows
        for part in found:
            which = incident_code(part.cell, rank=4, levels=grid.block)
            share = np.bincount(which, part.sums[:, 0], minlength=len(rows)) / samples
            light[every_other(number), every_other(number >> 1)] += share
    return light.ravel()


def every_other(number: np.ndarray) -> np.ndarray:
    """Return the numbers that bits 0, 2, 4 … make."""
    return sum((number >> bit) & (1 << bit) for bit in range(8))


def _differences(name: str, halvings: int, samples: int, made: cl.Bsdf) -> dict:
    # Light in all, and from each patch, beside bare counts and matrices
    full = klems("full")
    weight = full.projected_solid_angles() / np.pi
    a, b = (
        np.array([part.functions["visible", n].direct_hemispherical() for n in NAMES])
        for part in (to_matrices(made, full), matrix(name))
    )
    part = patches_in_cells(full, halvings)
    counts = np.array([counted(name, halvings, samples, seed) for seed in SEEDS])
    bare = counts @ part.T / np.asarray(part.sum(axis=1)).ravel()
    spread = float(np.sqrt(bare.var(axis=0, ddof=1).mean()))
    total, bare = a.sum(axis=0), bare.mean(axis=0)
    truth = b.sum(axis=0)
    off = total - bare
    return {
        "counted": float(np.sqrt(np.mean(off**2))),
        "noise": spread * float(np.sqrt(1 + 1 / len(SEEDS))),
        "worst": float(np.abs(off).max()),
        "patches": float(np.sqrt(np.mean((total - truth) ** 2))),
        "cells_alone": float(np.sqrt(np.mean((bare - truth) ** 2))),
        "most": float(total.max()),
        "passed": float((a @ weight)[0] / (b @ weight)[0] - 1),
        "thrown": float((a @ weight)[1] / (b @ weight)[1] - 1),
    }


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--halvings", type=int, nargs="+", default=[5, 6, 7])
    parser.add_argument("--systems", nargs="+", default=list(SYSTEMS))
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    if options.one:
        name, halvings, samples = options.one
        print(json.dumps(tree(name, int(halvings), int(samples))))
        return
    lines = ["# Trees of three systems", "", f"{stamp()}; light from the room.", ""]
    lines += [
        "| system | cells an axis | paths a cell | seconds | processor seconds"
        " | memory [GB] | cells | file [MB] | all light: T | R | from a patch: off bare"
        " counts, rms | noise of both | worst | off the matrix, rms"
        " | bare counts off it | most |",
        "|" + "---|" * 16,
    ]
    for name in options.systems:
        for halvings in options.halvings:
            one = [name, str(halvings), str(PATHS[halvings])]
            done = subprocess.run(
                [sys.executable, __file__, "--one", *one],
                check=True,
                capture_output=True,
                text=True,
            )
            f = json.loads(done.stdout.splitlines()[-1])
            lines.append(
                f"| {name} | 2^{halvings} | {PATHS[halvings]} | {f['wall']:.1f}"
                f" | {f['processor']:.1f} | {f['memory']:.2f} | {f['cells']:,}"
                f" | {f['size']:.1f} | {f['passed']:+.2%} | {f['thrown']:+.2%}"
                f" | {f['counted']:.4f} | {f['noise']:.4f} | {f['worst']:.4f}"
                f" | {f['patches']:.4f} | {f['cells_alone']:.4f} | {f['most']:.4f} |"
            )
            print(lines[-1], flush=True)
            if options.write:
                options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
