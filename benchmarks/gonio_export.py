"""A measured film as a tensor tree of 2⁷ cells along four axes: time, memory, error.

    python benchmarks/gonio_export.py [--halvings 7] [--processes 1] [--samples 256]
        [--figure PNG] [--write FILE]

The virtual film of `tests/goniometer.py` is measured at 81 directions, fitted and
exported. The tree is compared with the interpolant that it was drawn from, and stands
in the window of the room of `tree_picture.py`.
"""

import argparse
import resource
import sys
import tempfile
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from duel import stamp
from matplotlib.colors import PowerNorm

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from tree_picture import HALF, HEAD, SILL, VIEW, room

import clerestory as cl
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.fitted_measurement import export_bsdf, fit_measurement
from clerestory.gonio.raster import Raster
from clerestory.hemisphere.shirley_chiu import disc_from_square
from clerestory.scene.model import BsdfSurface, Polygon, Scene
from goniometer import Goniophotometer, film, half_circle

FRONT = np.array([1.0, 1.0, -1.0])


def spent() -> float:
    """Processor time of this process and of those it started [s]."""
    uses = [resource.getrusage(who) for who in (0, resource.RUSAGE_CHILDREN)]
    return sum(use.ru_utime + use.ru_stime for use in uses)


def directions(count: int = 60, seed: int = 7) -> np.ndarray:
    """Incident directions up to 75° from the normal."""
    rng = np.random.default_rng(seed)
    sine = np.sqrt(rng.random(count)) * np.sin(np.radians(75))
    return from_degrees(np.degrees(np.arcsin(sine)), rng.uniform(0, 360, count))


def errors(interpolant, tree, halvings: int) -> np.ndarray:
    """Flux of the tree less that of the interpolant, and light that is elsewhere."""
    middle = (np.arange(1 << halvings) + 0.5) / (1 << halvings)
    a, b = (part.ravel() for part in np.meshgrid(middle, middle, indexing="ij"))
    x, y = disc_from_square(a, b)
    exits = np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=-1)
    rows = []
    for incident in directions():
        lobes = interpolant.lobes(incident * FRONT)
        truth = Raster.of(halvings).cells(lobes) * (np.pi / len(exits))
        pairs = np.broadcast_to(incident * FRONT, exits.shape)
        found = tree.evaluate(pairs, exits) * (np.pi / len(exits))
        moved = np.abs(found - truth).sum() / (2 * truth.sum())
        rows.append((abs(found.sum() - truth.sum()), moved))
    return np.array(rows).T


def picture(layer, samples: int) -> np.ndarray:
    """Luminance of the room behind the film [cd/m²]."""
    corners = [(-HALF, SILL), (-HALF, HEAD), (HALF, HEAD), (HALF, SILL)]
    pane = np.array([(x, 0.0, z) for x, z in corners])
    surface = BsdfSurface("film", layer, 0.0, np.array([0.0, 0, 1]))
    window = Scene({"film": surface}, (Polygon(pane, "film", "window"),))
    view = cl.parse_view(VIEW)
    size = dict(zip(("columns", "rows"), view.size_for(240), strict=True))
    made = cl.render(room() + window, view, **size, samples=samples, seed=1)
    return made.picture.luminance()


def draw(seen: np.ndarray, path: Path) -> None:
    """Draw the room."""
    figure, axes = plt.subplots(figsize=(6, 4.6), layout="constrained")
    norm = PowerNorm(0.45, 0, float(np.quantile(seen, 0.98)))
    figure.colorbar(axes.imshow(seen, norm=norm, cmap="gray"), label="cd/m²")
    axes.set_axis_off()
    figure.savefig(path, dpi=80)


def main() -> None:
    """Measure, fit, export, compare, look, and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--halvings", type=int, default=7)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--figure", type=Path, help="picture to write")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    start = spent()
    measurement = Goniophotometer().measure(film, half_circle())
    fitted = fit_measurement(measurement, processes=options.processes)
    fit_time, start, clock = spent() - start, spent(), time.perf_counter()
    layer = export_bsdf(
        [fitted], "tree", halvings=options.halvings, processes=options.processes
    )
    export_time, clock = spent() - start, time.perf_counter() - clock
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.xml"
        write_bsdf(path, layer, digits=6)
        size, start = path.stat().st_size / 1e6, spent()
        again = read_bsdf(path)
        read_time = spent() - start
    tree = again.functions["visible", "transmission_front"]
    flux, moved = errors(fitted.interpolant, tree, options.halvings)
    values = np.count_nonzero(tree.slots >= 0) / 1e6
    lines = [
        "# A measured film as a large tensor tree",
        "",
        f"{stamp()}; the virtual film of 81 scans, made by"
        " `benchmarks/gonio_export.py`. Errors at 60 incident directions against the"
        " interpolant on the same cells: median / largest.",
        "",
        "| | |",
        "|---|---|",
        f"| cells along each of four axes | {1 << options.halvings} |",
        f"| values in the tree | {values:.2f} million |",
        f"| size of the file | {size:.0f} MB |",
        f"| fit, processor time | {fit_time:.0f} s |",
        f"| export, processor time | {export_time:.0f} s |",
        f"| export, elapsed, {options.processes} process(es) | {clock:.0f} s |",
        f"| most memory of the first process | {most:.0f} MB |",
        f"| reading the file, processor time | {read_time:.1f} s |",
        f"| flux, share of the light | {np.median(flux):.4f} / {flux.max():.4f} |",
        f"| light elsewhere | {np.median(moved):.3f} / {moved.max():.3f} |",
    ]
    text = "\n".join(lines) + "\n"
    print(text, flush=True)
    if options.write:
        options.write.write_text(text, encoding="utf-8")
    if options.figure:
        draw(picture(again, options.samples), options.figure)


if __name__ == "__main__":
    main()
