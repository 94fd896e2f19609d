"""How many BSDF values a second one core finds, for random pairs of directions.

python benchmarks/bsdf_speed.py [-o docs/benchmarks/bsdf-speed.md]
"""

import argparse
import platform
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import tree_from
from clerestory.bsdf.scattering_function import FUNCTIONS, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.hemisphere.klems import klems

PAIRS = 1_000_000
RUNS = 5


def isotropic(halvings: int) -> ScatteringTree:
    """Return a tree of rank 3 with a grid of random values."""
    values = np.random.default_rng(1).random(1 << 3 * halvings)
    text = "{ " + " ".join(f"{v:.4f}" for v in values) + " }"
    table = parse_tree(text.encode(), rank=3)
    return ScatteringTree(table.slots, 3, table.depth)


def noisy(basis: str) -> ScatteringMatrix:
    """Return a matrix of which no two values are equal."""
    patches = klems(basis)
    values = np.random.default_rng(2).random((len(patches), len(patches)))
    return ScatteringMatrix(values, patches, patches)


def functions() -> dict[str, ScatteringFunction]:
    """Return a scattering function of every kind, without a cell that was joined."""
    full = noisy("full")
    return {
        "matrix, 145 × 145": full,
        "matrix, 77 × 77": noisy("half"),
        "tree of rank 3, 2⁵ cells along an axis": isotropic(5),
        "tree of rank 4, 2⁴": tree_from(full, 4),
        "tree of rank 4, 2⁶": tree_from(full, 6),
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
    for name, part in functions().items():
        layer = Bsdf(dict.fromkeys([("visible", f) for f in FUNCTIONS], part))
        one = speed(lambda part=part: part.evaluate(incident, leaving))
        whole = speed(lambda layer=layer: layer.evaluate(incident, leaving))
        rows.append(f"| {name} | {one / 1e6:.1f} | {whole / 1e6:.1f} |")
    today = datetime.now(UTC)
    text = (
        "# Speed of BSDF values\n\n"
        f"Made by `benchmarks/bsdf_speed.py` on {today:%d %B %Y}, one core of"
        f" {platform.machine()}, NumPy {np.__version__}. Million values a second of"
        " processor time, for random pairs of directions; `Bsdf.evaluate` also"
        " determines the function (of four) for each pair.\n\n"
        "| | one function | `Bsdf.evaluate` |\n| --- | --- | --- |\n"
        + "\n".join(rows)
        + "\n"
    )
    print(text)
    if options.output:
        options.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
