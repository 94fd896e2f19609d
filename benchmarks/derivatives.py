"""Cost of derivatives by eight materials: view matrix of a room, with and without.

    python benchmarks/derivatives.py [--samples 16384] [--pairs 7] [--write FILE]

Processor times of pairs of traces, in alternating order, after one that compiles.
"""

import argparse
import gc
from pathlib import Path
from time import process_time

import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.directions import Frame
from clerestory.scene.model import Plastic, Polygon, Scene

COLOURS = {
    "floor": (0.3, 0.25, 0.2),
    "ceiling": (0.8, 0.8, 0.8),
    "west": (0.6, 0.6, 0.5),
    "east": (0.6, 0.6, 0.5),
    "north": (0.5, 0.5, 0.5),
    "desk": (0.4, 0.3, 0.2),
    "shelf": (0.5, 0.3, 0.2),
    "board": (0.2, 0.3, 0.2),
}
FACES = {
    "floor": ((0, 0, 0), (3, 0, 0), (3, 4, 0), (0, 4, 0)),
    "ceiling": ((0, 0, 3), (0, 4, 3), (3, 4, 3), (3, 0, 3)),
    "west": ((0, 0, 0), (0, 4, 0), (0, 4, 3), (0, 0, 3)),
    "east": ((3, 0, 0), (3, 0, 3), (3, 4, 3), (3, 4, 0)),
    "north": ((0, 4, 0), (3, 4, 0), (3, 4, 3), (0, 4, 3)),
    "desk": ((0.5, 1, 0.7), (1.5, 1, 0.7), (1.5, 2, 0.7), (0.5, 2, 0.7)),
    "shelf": ((2.9, 1, 0.1), (2.9, 1, 2), (2.9, 3, 2), (2.9, 3, 0.1)),
    "board": ((0.1, 1, 0.5), (0.1, 3, 0.5), (0.1, 3, 2), (0.1, 1, 2)),
}
OPENING = ((0.2, 0, 0.9), (0.2, 0, 2.8), (2.8, 0, 2.8), (2.8, 0, 0.9))


def room() -> tuple[Scene, cl.Window, cl.Sensors]:
    """Return the room, its window and a grid of 100 sensors."""
    materials = {name: Plastic(name, np.array(c)) for name, c in COLOURS.items()}
    faces = tuple(
        Polygon(np.array(corners, dtype=float), name, name)
        for name, corners in FACES.items()
    )
    frame = Frame.from_normal_up(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    pane = Polygon(np.array(OPENING), "pane", "pane")
    window = cl.Window("south", (pane,), frame, cl.klems("full"))
    x, y = np.meshgrid(np.linspace(0.3, 2.7, 10), np.linspace(0.4, 3.6, 10))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(100, 0.8)])
    up = np.tile([0.0, 0.0, 1.0], (100, 1))
    return Scene(materials, faces), window, cl.Sensors(points, up)


def relative_error(matrix: cl.TransferMatrix) -> float:
    """Return the mean over the sensors of the relative error of row sums."""
    parts = matrix.components.sum(axis=(1, 3), dtype=float)
    sums = matrix.values.sum(axis=(0, 2))
    return float(np.mean(np.sqrt(np.square(parts).sum(axis=0)) / sums))


def times_of(
    samples: int, pairs: int
) -> tuple[cl.TransferMatrix, dict[str, np.ndarray]]:
    """Return the matrix with derivatives, and processor times [s] by kind of trace."""
    scene, window, sensors = room()
    kinds = {"plain": (), "derivatives": list(COLOURS)}
    spent: dict[str, list[float]] = {kind: [] for kind in kinds}
    for pair in range(pairs + 1):
        for kind in list(kinds) if pair % 2 else reversed(list(kinds)):
            gc.collect()
            start = process_time()
            made = cl.view_matrix(
                scene, window, sensors=sensors, samples=samples, seed=1,
                derivatives=kinds[kind], device="cpu",
            )  # fmt: skip
            if pair:
                spent[kind].append(process_time() - start)
            if kinds[kind]:
                found = made
    return found, {kind: np.array(times) for kind, times in spent.items()}


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=1 << 14)
    parser.add_argument("--pairs", type=int, default=7)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    names = list(COLOURS)
    found, spent = times_of(options.samples, options.pairs)
    ratios = np.sort(spent["derivatives"] / spent["plain"])
    plain, more = (float(np.median(times)) for times in spent.values())
    rows = "\n".join(
        f"| d/d {name} | {100 * relative_error(found.derivative(name)):.2f} % |"
        for name in names
    )
    text = f"""# Derivatives by materials

`benchmarks/derivatives.py`. {stamp()}

View matrix of 100 sensors in a room of eight coloured diffuse materials,
{options.samples:,} paths a sensor, medians of the processor times of
{options.pairs} interleaved pairs of traces: {plain:.2f} s plain, {more:.2f} s with
first and second derivatives by all eight materials, **{np.median(ratios):.2f} times**
({ratios[0]:.2f} to {ratios[-1]:.2f} in single pairs).
Relative standard error of row sums, mean over the sensors:

| | error |
|---|---|
| matrix | {100 * relative_error(found):.2f} % |
{rows}
"""
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
