"""How many BSDF values a second one core finds, for random pairs of directions.

python benchmarks/bsdf_speed.py [-o docs/benchmarks/bsdf-speed.md]
"""

import argparse
import platform
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from clerestory.bsdf.analytic import thin_pane
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import to_matrices, to_trees
from clerestory.bsdf.tree import ScatteringTree
from clerestory.bsdf.tree_text import parse_tree
from clerestory.bsdf.xml import read_bsdf
from clerestory.hemisphere.klems import klems

PAIRS = 1_000_000
RUNS = 7
DEMO = Path(__file__).parents[1] / "src" / "clerestory" / "demo"


def isotropic(halvings: int) -> Bsdf:
    """A tree of rank 3 with a grid of random values."""
    values = np.random.default_rng(1).random(1 << 3 * halvings)
    text = "{ " + " ".join(f"{v:.4f}" for v in values) + " }"
    table = parse_tree(text.encode(), rank=3)
    tree = ScatteringTree(table.slots, 3, table.depth)
    names = read_bsdf(DEMO / "venetian_blind.xml").functions
    return Bsdf(dict.fromkeys(names, tree))


def layers() -> dict[str, Bsdf]:
    """Return a layer of every kind."""
    blind = read_bsdf(DEMO / "venetian_blind.xml")
    noise = np.random.default_rng(2)
    pane = thin_pane(0.9, klems("full"))
    noisy = {
        key: replace(part, values=part.values + 0.01 * noise.random(part.values.shape))
        for key, part in pane.functions.items()
    }
    rough = replace(pane, functions=noisy)
    return {
        "matrix, 145 × 145": to_matrices(blind, klems("full")),
        "matrix, 77 × 77": to_matrices(blind, klems("half")),
        "tree of rank 3, 2⁵ cells along an axis": isotropic(5),
        "tree of rank 4, 2⁴": to_trees(rough, halvings=4),
        "tree of rank 4, 2⁶": to_trees(rough, halvings=6),
    }


def speed(work: Callable[[], object]) -> float:
    """Return the greatest of several speeds [pairs/s of processor time]."""
    work()
    best = 0.0
    for _ in range(RUNS):
        began = time.process_time()
        work()
        best = max(best, PAIRS / (time.process_time() - began))
    return best


def main() -> None:
    """Print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    pairs = np.random.default_rng(3).normal(size=(2, PAIRS, 3))
    incident, leaving = pairs / np.linalg.norm(pairs, axis=-1, keepdims=True)
    rows = []
    for name, layer in layers().items():
        part = layer.functions["visible", "transmission_front"]
        one = speed(lambda part=part: part.evaluate(incident, leaving))
        whole = speed(lambda layer=layer: layer.evaluate(incident, leaving))
        rows.append(f"| {name} | {one / 1e6:.1f} | {whole / 1e6:.1f} |")
    today = datetime.now(UTC)
    text = (
        "# Speed of BSDF values\n\n"
        f"Made by `benchmarks/bsdf_speed.py` on {today:%d %B %Y}, one core of"
        f" {platform.machine()}, NumPy {np.__version__}. Million values a second of"
        " processor time, for random pairs of directions; `Bsdf.evaluate` also finds"
        " out which of the four functions each pair is for.\n\n"
        "| | one function | `Bsdf.evaluate` |\n| --- | --- | --- |\n"
        + "\n".join(rows)
        + "\n"
    )
    print(text)
    if options.output:
        options.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
