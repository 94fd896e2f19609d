"""A tensor tree of a redirecting film at full resolution: size, loading time, memory.

Transmitted light leaves in a lobe of 3° full width around a direction that is turned up
as by a prismatic film, over a diffuse floor. The tree has 2⁷ cells along each of four
axes, 268 million at full size; cells that hardly differ are one, as in genBSDF -t4 7.

    python benchmarks/large_tree.py [-o docs/benchmarks/large-tree.md]

A room behind the film is then rendered, once with the tree and once with its mean over
Klems' patches, in turns, with few and with many samples: the difference is what samples
cost; what they do not account for is spent once, on lowering and compiling.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float
from tree_picture import DISC_DEG, VIEW, disc, room, window

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.resample import to_matrices
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import float_bits
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.shirley_chiu import disc_from_square

HALVINGS = 7
FULL_UNTIL = 4  # halvings down to which no cell is joined with its neighbours
TURNED_UP = 0.45  # shift of the disc point of the lobe, along y
WIDTH = 0.022  # standard deviation of the lobe, in units of the disc's radius
PEAK, FLOOR = 0.6, 0.05  # shares of the light in the lobe and spread evenly
COLUMNS, ROWS = 48, 36  # of the picture of a room behind the film
FEW, MANY = 64, 320  # samples a pixel
TURNS = 3
DIFFERENT = 0.2  # of √((largest − smallest) / (√mean + 0.03)), as in rttree_reduce

READ = """
import re, sys, time
from pathlib import Path
import numpy as np
from clerestory.bsdf.xml_reader import read_bsdf

def memory_mb(kind):
    status = Path("/proc/self/status").read_text()
    return int(re.search(kind + r":\\s+(\\d+)", status)[1]) / 1024

Path("/proc/self/clear_refs").write_text("5")  # forget the peak so far
before = memory_mb("VmRSS")
began = time.process_time()
bsdf = read_bsdf(sys.argv[1])
took = time.process_time() - began
peak = memory_mb("VmHWM") - before
tree = bsdf.functions["visible", "transmission_front"]
pairs = np.random.default_rng(1).normal(size=(2, 1_000_000, 3))
pairs /= np.linalg.norm(pairs, axis=-1, keepdims=True)
fastest = np.inf
for _ in range(5):
    began = time.process_time()
    tree.evaluate(*pairs)
    fastest = min(fastest, time.process_time() - began)
speed = len(pairs[0]) / fastest
print(took, peak, tree.slots.nbytes / 2**20, tree.depth, speed)
"""


def film(
    point: Float[np.ndarray, "..."],
) -> Float[np.ndarray, "..."]:
    """Transmission [1/sr] at points of the four-dimensional unit cube."""
    x, y = disc_from_square(point[0], point[1])
    leave_x, leave_y = disc_from_square(point[2], point[3])
    # Light goes on and is turned up, as far as the disc allows
    up = y + TURNED_UP * (1 - x * x - y * y)
    away = ((leave_x - x) ** 2 + (leave_y - up) ** 2) / (2 * WIDTH**2)
    lobe = PEAK / (2 * np.pi * WIDTH**2)
    return np.asarray(FLOOR / np.pi + lobe * np.exp(-np.minimum(away, 80)))


def film_tree() -> ScatteringTree:
    """Return the film's tree, from the root to the smallest cells that differ."""
    bits = (np.arange(16) >> np.arange(4)[:, None]) & 1
    place = np.zeros((4, 1), dtype=np.int64)
    regions, size = [], 1
    for level in range(HALVINGS + 1):
        centre = (place + 0.5) / (1 << level)
        inner = _differs(centre, level)
        region = float_bits(film(centre))
        count = int(inner.sum())
        region[inner] = ~(size + (np.arange(count) << 4)).astype(np.int32)
        regions.append(region)
        size += count << 4
        place = (2 * place[:, inner, None] + bits[:, None]).reshape(4, -1)
        if not place.size:
            break
    return ScatteringTree(np.concatenate(regions), 4, level)


def _differs(
    centre: Float[np.ndarray, "4 cells"], level: int
) -> Bool[np.ndarray, " cells"]:
    # Whether the smallest cells within a cell differ, judged by points spread over it
    cells = centre.shape[1]
    if level < FULL_UNTIL:
        return np.ones(cells, dtype=bool)
    if level == HALVINGS:
        return np.zeros(cells, dtype=bool)
    offset = np.random.default_rng(level).uniform(-0.5, 0.5, (4, 1, 48))
    result = np.empty(cells, dtype=bool)
    for start in range(0, cells, 1 << 14):
        part = slice(start, start + (1 << 14))
        value = film(np.clip(centre[:, part, None] + offset / (1 << level), 0, 1))
        spread = value.max(axis=1) - value.min(axis=1)
        measure = np.sqrt(spread / (np.sqrt(value.mean(axis=1)) + 0.03))
        result[part] = measure > DIFFERENT
    return result


def in_scene(tree: ScatteringTree) -> str:
    """Return a table of what a room costs behind the tree and behind a matrix."""
    name = "transmission_back"
    behind_tree = Bsdf({("visible", name): tree})
    behind_matrix = to_matrices(behind_tree, klems("full"))
    light = room(disc(DISC_DEG, 6))
    scenes = {
        "Klems matrix": light + window(behind_matrix),
        "tree": light + window(behind_tree),
    }
    seconds: dict[tuple[str, int], list[float]] = {
        (layer, samples): [] for layer in scenes for samples in (FEW, MANY)
    }
    for turn in range(TURNS + 1):
        for (layer, samples), found in seconds.items():
            began = time.process_time()
            size = {"columns": COLUMNS, "rows": ROWS}
            view = cl.parse_view(VIEW)
            cl.render(scenes[layer], view, **size, samples=samples, seed=turn)
            if turn > 0:
                found.append(time.process_time() - began)
    lines = [
        "| behind | per million samples [s] | once [s] |",
        "| --- | --- | --- |",
    ]
    costs = {}
    for layer in scenes:
        few, many = (float(np.median(seconds[layer, n])) for n in (FEW, MANY))
        costs[layer] = (many - few) / (MANY - FEW) / (COLUMNS * ROWS) * 1e6
        once = few - costs[layer] * FEW * COLUMNS * ROWS / 1e6
        lines.append(f"| {layer} | {costs[layer]:.2f} | {once:.2f} |")
    ratio = costs["tree"] / costs["Klems matrix"]
    return (
        "\n## In a scene\n\nA picture of a room behind the film, under sun and sky:"
        f" processor seconds, medians of {TURNS} runs in turns. The tree costs"
        f" {ratio:.2f} times a Klems matrix.\n\n" + "\n".join(lines) + "\n"
    )


def table(tree: ScatteringTree, path: Path) -> str:
    """Return the page with what a fresh process measured."""
    done = subprocess.run(
        [sys.executable, "-c", READ, str(path)],
        capture_output=True,
        text=True,
        check=True,
    )
    took, peak, table_mb, depth, speed = map(float, done.stdout.split())
    cells = int(np.sum(tree.slots >= 0))
    rows = {
        "cells along each of four axes": f"{1 << int(depth)}",
        "values at full size": f"{16.0**HALVINGS / 1e6:.0f} million",
        "values in the tree": f"{cells / 1e6:.2f} million",
        "size of the file": f"{path.stat().st_size / 1e6:.0f} MB",
        "time to read it, on one core": f"{took:.1f} s",
        "memory of the tree": f"{table_mb:.0f} MB",
        "most memory while reading": f"{peak:.0f} MB",
        "evaluations": f"{speed / 1e6:.1f} million/s on one core",
    }
    lines = "\n".join(f"| {name} | {value} |" for name, value in rows.items())
    today = datetime.now(UTC)
    return (
        "# A large tensor tree\n\n"
        f"Made by `benchmarks/large_tree.py` on {today:%d %B %Y}: a redirecting film,"
        f" one function of rank 4.\n\n| | |\n| --- | --- |\n{lines}\n"
    )


def main() -> None:
    """Write the film to a file, and measure how it is read."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    began = time.perf_counter()
    tree = film_tree()
    took = time.perf_counter() - began
    print(f"{tree.slots.size / 1e6:.1f} million slots made in {took:.1f} s")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.xml")
        product = Product("Redirecting film")
        write_bsdf(
            path, Bsdf({("visible", "transmission_front"): tree}, product), digits=5
        )
        page = table(tree, path) + in_scene(tree)
    print(page)
    if options.output:
        options.output.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
