"""Cost of derivatives by eight materials: view matrix of a room, with and without.

    python benchmarks/derivatives.py [--samples 16384] [--write FILE]

Processor times of both traces, alternating, after one run of each that compiles.
"""

import argparse
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


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=1 << 14)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    scene, window, sensors = room()
    names, spent = list(COLOURS), {"plain": [], "derivatives": []}
    for run in range(4):
        for kind, chosen in (("plain", ()), ("derivatives", names)):
            start = process_time()
            found = cl.view_matrix(
                scene, window, sensors=sensors, samples=options.samples, seed=1,
                derivatives=chosen, device="cpu",
            )  # fmt: skip
            if run:
                spent[kind].append(process_time() - start)
    plain, more = (float(np.median(times)) for times in spent.values())
    rows = "\n".join(
        f"| d/d {name} | {100 * relative_error(found.derivative(name)):.2f} % |"
        for name in names
    )
    text = f"""# Derivatives by materials

`benchmarks/derivatives.py`. {stamp()}

View matrix of 100 sensors in a room of eight coloured diffuse materials,
{options.samples:,} paths a sensor, median processor time of three runs:
{plain:.2f} s plain, {more:.2f} s with first and second derivatives by all eight
materials, **{more / plain:.2f} times**.
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
