"""Figure of the package structure: which package imports which.

    python scripts/draw_layers.py

writes docs/figures/layers.svg from the import statements of the source. Packages stand
in the order of the layers that tests/test_stack.py enforces, the lowest first; a number
is the count of files of the row's package that import the column's. All numbers lie
below the diagonal: data flow upwards through the layers, imports point downwards.
"""

import ast
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from jaxtyping import Int
from matplotlib import pyplot as plt
from matplotlib.patches import Rectangle

REPOSITORY = Path(__file__).parents[1]
sys.path.insert(0, str(REPOSITORY / "tests"))

from test_stack import STACK, imported_packages, python_files

FIGURE = REPOSITORY / "docs" / "figures" / "layers.svg"


def import_counts(names: list[str]) -> Int[np.ndarray, "package package"]:
    """Count the files of each package that import each other package."""
    counts = np.zeros((len(names), len(names)), int)
    for row, name in enumerate(names):
        for file in python_files(name):
            for used in set(imported_packages(file)) - {name}:
                counts[row, names.index(used)] += 1
    return counts


def subject(name: str) -> str:
    """First line of a package's docstring."""
    files = python_files(name)
    file = next((f for f in files if f.name == "__init__.py"), files[0])
    text = ast.get_docstring(ast.parse(file.read_text("utf-8"))) or ""
    return text.split("\n")[0]


def draw(file: Path = FIGURE) -> None:
    """Draw the matrix of imports."""
    names = [name for line in STACK for name in line]
    counts = import_counts(names)
    size = len(names)
    mpl.rcParams |= {"svg.hashsalt": "layers", "svg.fonttype": "none"}
    figure, axes = plt.subplots(figsize=(12.5, 7.8))
    for row, column in zip(*np.nonzero(counts), strict=True):
        shade = 0.25 + 0.75 * min(1.0, counts[row, column] / 25)
        place = (column - 0.5, row - 0.5)
        axes.add_patch(Rectangle(place, 1, 1, color="#2b6a99", alpha=shade, lw=0))
        colour = "white" if shade > 0.5 else "black"
        text = str(counts[row, column])
        axes.text(column, row, text, ha="center", va="center", color=colour, size=8)
    for place in range(size):
        square = (place - 0.5, place - 0.5)
        axes.add_patch(Rectangle(square, 1, 1, color="#b0b0b0", lw=0))
        axes.text(size + 0.2, place, subject(names[place]), va="center", size=8)

    # A line between layers
    place = 0
    for line in STACK:
        axes.axhline(place - 0.5, color="0.75", lw=0.6)
        axes.axvline(place - 0.5, ymax=1, color="0.75", lw=0.6)
        place += len(line)
    axes.set(xlim=(-0.5, size - 0.5), ylim=(size - 0.5, -0.5), aspect="equal")
    axes.set_xticks(range(size), names, rotation=90, size=9)
    axes.set_yticks(range(size), names, size=9)
    axes.tick_params(length=0, top=True, bottom=False, labeltop=True, labelbottom=False)
    axes.spines[:].set_visible(False)
    figure.savefig(file, bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


if __name__ == "__main__":
    draw()
