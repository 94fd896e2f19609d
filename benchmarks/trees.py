"""Tensor trees of three systems: time, memory, size, and light beside the matrices.

    python benchmarks/trees.py [--halvings 5 6 7] [--systems blind …] [--write FILE]

The light that a tree scatters in all is compared with that of a matrix of many paths,
and from each of Klems' incident patches with bare counts of paths on the same cells,
of another seed: transmission and reflection together, as shares of the light that
arrives. Patches themselves are cut differently from cells: what a matrix has from one
patch and a tree from the cells that touch it differs more, the less the finer the
tree. Each tree is made in a process of its own, which tells the memory it took.
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
from clerestory.bsdf.overlap import patches_in_cells
from clerestory.bsdf.resample import to_matrices
from clerestory.bsdf.tree import ScatteringTree
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.branches import incident_part
from clerestory.bsdfgen.microlouvre import microlouvre
from clerestory.bsdfgen.prismatic import prismatic
from clerestory.bsdfgen.slats import venetian
from clerestory.engine import device as devices
from clerestory.hemisphere.klems import klems

SYSTEMS = {
    "blind": lambda: venetian(
        slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.48
    ),
    "microlouvre": microlouvre,
    "prismatic film": prismatic,
}
PATHS = {5: 4096, 6: 1024, 7: 256}

# Halvings within a block of bare counts, so that a few hundred megabytes hold them.
WITHIN = {5: 5, 6: 5, 7: 4}
NAMES = ("transmission_back", "reflection_back")
LONG = 1 << 15


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


def counted(name: str, halvings: int, samples: int) -> np.ndarray:
    """Return the light in all from each incident cell, as bare counts of paths."""
    engine = devices.load("auto", "sample_area_tree")
    system = SYSTEMS[name]()
    slab = engine.lower_slab(
        system.scene, system.area.slab(), periodic=system.area.periodic
    )
    grid = engine.Grid(4, halvings, WITHIN[halvings])
    rows = np.arange(grid.incidents)
    which = incident_part(np.arange(grid.cells), rank=4, levels=grid.block)
    light = np.empty((1 << halvings, 1 << halvings))
    for block in range(grid.blocks):
        sums = engine.trace_block(
            slab,
            grid,
            block,
            [(rows, 0, samples)],
            back=True,
            segments=1 << 30,
            seed=9,
        )
        share = np.bincount(which, sums[..., 0].sum(axis=0)) / samples
        number = block * grid.incidents + rows
        light[every_other(number), every_other(number >> 1)] = share
    return light.ravel()


def every_other(number: np.ndarray) -> np.ndarray:
    """Return the numbers that bits 0, 2, 4 … make."""
    return sum((number >> bit) & (1 << bit) for bit in range(8))


def _differences(name: str, halvings: int, samples: int, made: cl.Bsdf) -> dict:
    # Light in all, and from each patch, beside bare counts and matrices
    full = klems("full")
    weight = full.projected_solid_angles() / np.pi
    of_tree, of_matrix = to_matrices(made, full), matrix(name)
    a, b = (
        np.array([part.functions["visible", n].direct_hemispherical() for n in NAMES])
        for part in (of_tree, of_matrix)
    )
    part = patches_in_cells(full, halvings)
    bare = (
        part @ counted(name, halvings, samples) / np.asarray(part.sum(axis=1)).ravel()
    )
    total = a.sum(axis=0)
    return {
        "counted": float(np.abs(total - bare).max()),
        "patches": float(np.abs(total - b.sum(axis=0)).max()),
        "most": float(total.max()),
        "diffuse": float(
            np.abs((a @ weight) / np.maximum(b @ weight, 1e-12) - 1).max()
        ),
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
        " | memory [GB] | cells | file [MB] | light per patch, off bare counts"
        " | off the matrix | most | diffuse T, R, off the matrix |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
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
                f" | {f['size']:.1f} | {f['counted']:.4f} | {f['patches']:.4f}"
                f" | {f['most']:.4f} | {f['diffuse']:.2%} |"
            )
            print(lines[-1], flush=True)
    text = "\n".join(lines) + "\n"
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
