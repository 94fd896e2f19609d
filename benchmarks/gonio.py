"""Measurements to BSDFs: known truths, held-out scans, and Radiance on the same files.

    python benchmarks/gonio.py truth
    python benchmarks/gonio.py radiance --data ../shared/data/gonio
    python benchmarks/gonio.py smoothing --data ../shared/data/gonio

Each writes its part of docs/benchmarks and the figures of docs/gonio.md. Radiance is
that of pyradiance: pabopto2bsdf, then bsdf2ttree -g 6, whose tree is read by us.
"""

import argparse
import datetime
import importlib
import io
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyradiance
from matplotlib.figure import Figure
from PIL import Image

REPOSITORY = Path(__file__).parents[1]
sys.path.insert(0, str(REPOSITORY / "tests"))

from clerestory.bsdf.xml import read_bsdf  # noqa: E402
from clerestory.bsdfgen.microlouvre import microlouvre  # noqa: E402
from clerestory.bsdfgen.prismatic import prismatic  # noqa: E402
from clerestory.engine import device  # noqa: E402
from clerestory.gonio.angles import angle_between, from_degrees  # noqa: E402
from clerestory.gonio.fit import FitOptions, condense, misplaced_light, total_flux  # noqa: E402
from clerestory.gonio.fitted import Fitted, fit_measurement  # noqa: E402
from clerestory.gonio.lobes import Lobes  # noqa: E402
from clerestory.gonio.measurement import Measurement  # noqa: E402
from clerestory.gonio.mesh import locate  # noqa: E402
from clerestory.gonio.nodes import about_normal, turned  # noqa: E402
from clerestory.gonio.read import read_measurement  # noqa: E402
from clerestory.gonio.symmetry import fold  # noqa: E402
from clerestory.gonio.tree_export import to_tree  # noqa: E402
from clerestory.gonio.validation import cross_validate  # noqa: E402
from clerestory.report.gonio_plots import between_figure, fit_figure  # noqa: E402
from goniometer import (  # noqa: E402
    Goniophotometer,
    film,
    half_circle,
    louvre,
    pane,
    quarter_circle,
    rings,
    write_pabopto,
)

FIGURES = REPOSITORY / "docs" / "figures"
FRONT = np.array([1.0, 1.0, -1.0])
HALVINGS = 6
SEED = 2311  # of the directions at which truths are compared
PATHS = 1 << 16  # from each direction, and for curves of the flux
CURVE_PATHS = 1 << 14
JUMP = 0.2  # corners of a triangle whose fluxes differ by more have an edge between
MOST_HELD_OUT = 4
_COLOURS = 96


def layers():
    """Yield name, layer and incident directions of the virtual goniophotometer."""
    traced = importlib.import_module("traced_layer")
    yield (
        "microlouvre",
        traced.TracedLayer(microlouvre(), paths=PATHS),
        quarter_circle(),
    )
    film_ = prismatic(upper_angle_deg=80, lower_angle_deg=8)
    yield (
        "prismatic film, 80° and 8°",
        traced.TracedLayer(film_, paths=PATHS),
        half_circle(),
    )
    yield (
        "prismatic film, 45°",
        traced.TracedLayer(prismatic(), paths=PATHS),
        half_circle(),
    )
    pane_ = traced.TracedLayer(traced.rough_pane(), paths=PATHS)
    yield "rough pane", pane_, quarter_circle()
    yield "formula: film", film, half_circle()
    yield "formula: louvre", louvre, quarter_circle()
    yield "formula: pane", pane, rings(azimuths_deg=[0], step_deg=5.0)


class Known(NamedTuple):
    """Errors of one layer at 60 directions that were not measured.

    Attributes
    ----------
    known : exact fluxes at the scans
    errors : of flux, of the brightest beam [°], ghosts
    turns : errors of all beams [°]
    plain : ghosts of the mean of neighbours
    straight : errors of exact fluxes, straight between neighbours
    crossed : directions in triangles with an edge of the flux
    """

    name: str
    layer: object
    measurement: Measurement
    fitted: Fitted
    known: np.ndarray
    errors: np.ndarray
    turns: np.ndarray
    plain: np.ndarray
    straight: np.ndarray
    crossed: int


def known_truths():
    """Yield the errors of each layer."""
    traced = importlib.import_module("traced_layer")
    rng = np.random.default_rng(SEED)
    sine = np.sqrt(rng.random(60)) * np.sin(np.radians(75))
    directions = from_degrees(np.degrees(np.arcsin(sine)), rng.uniform(0, 360, 60))
    for name, layer, incidents in layers():
        if isinstance(layer, traced.TracedLayer):
            lights = layer.light(incidents)
            measurement = traced.measure(incidents, lights, name=name)
            known = np.array([light.total for light in lights])
            truth = layer.light(directions)
        else:
            measurement = Goniophotometer().measure(layer, incidents)
            known = np.array([layer(d).total for d in incidents])
            truth = [traced.drawn(layer(d)) for d in directions]
        fitted = fit_measurement(measurement)
        found = list(fitted.interpolant.lobes_of(directions * FRONT))
        lights = [traced.drawn(one) for one in found]
        pairs = list(zip(lights, truth, strict=True))
        means = map(traced.drawn, plain_means(fitted.interpolant, directions))
        plain = [traced.compare(*pair)[2] for pair in zip(means, truth, strict=True)]
        straight, across = straight_lines(
            fitted.interpolant, incidents, known, directions
        )
        yield Known(
            name, layer, measurement, fitted, known,
            np.array([traced.compare(*pair) for pair in pairs]),
            np.concatenate([traced.turned_by(*pair) for pair in pairs]),
            np.array(plain),
            straight - np.array([light.total for light in truth]),
            int(np.sum(across > JUMP)),
        )  # fmt: skip


def plain_means(interpolant, directions):
    """Yield the mean of the fits at the corners about each direction."""
    network = interpolant.network
    folded, factors = folding(interpolant, directions)
    for corners, shares, factor in places(network.mesh, folded, factors):
        parts = [network.lobes[v] for v in corners]
        lobes = Lobes(
            np.concatenate([part.centre for part in parts]),
            np.concatenate([part.radius for part in parts]),
            np.concatenate([w * p.flux for w, p in zip(shares, parts, strict=True)]),
        )
        yield turned(lobes, factor)


def straight_lines(interpolant, incidents, known, directions):
    """Flux straight between the exact values about directions, and how these differ."""
    mesh = interpolant.network.mesh
    ends, _ = folding(interpolant, mesh.vertices)
    own, _ = folding(interpolant, incidents)
    values = known[angle_between(ends[:, None], own).argmin(axis=1)]
    folded, factors = folding(interpolant, directions)
    about = list(places(mesh, folded, factors))
    flux = np.array([shares @ values[corners] for corners, shares, _ in about])
    return flux, np.array([np.ptp(values[corners]) for corners, _, _ in about])


def folding(interpolant, directions):
    """Directions in the measured part, and the matrices that turn light back."""
    if interpolant.symmetry == "isotropic":
        flat = np.hypot(*directions[:, :2].T)
        azimuth = np.arctan2(directions[:, 1], directions[:, 0])
        folded = np.stack([flat, 0 * flat, directions[:, 2]], axis=-1)
        return folded, np.array([about_normal(a) for a in azimuth])
    quadrant = interpolant.network.quadrant
    folded, factor = fold(directions, interpolant.symmetry, quadrant)
    return folded, factor[:, None, :] * np.eye(3)


def places(mesh, folded, factors):
    """Yield the corners about each direction, their shares, and its matrix."""
    place = locate(mesh, folded)
    for k, factor in enumerate(factors):
        s, t = place.s[k], place.t[k]
        if place.on_edge[k]:
            yield mesh.edges[place.simplex[k]], np.array([1 - s, s]), factor
        else:
            shares = np.array([(1 - s) * (1 - t), s * (1 - t), t])
            yield mesh.triangles[place.simplex[k]], shares, factor


def data_sets(folder):
    """Yield names and measurements in one plane, for trees of rank 3."""
    layer = Goniophotometer().measure(pane, rings(azimuths_deg=[0], step_deg=10.0))
    yield "rough pane (virtual)", layer
    eds = sorted((folder / "viavi_eds10").glob("EDS10 *-0.txt"))
    yield "EDS10", read_measurement(*eds)[0]
    for name, file in (
        ("AnoBlack EC1", "AnoBlackEC1onAlum.bsdf"),
        ("NiTE on steel", "NiTE_on_steel_v1o0A_20250915.xls"),
        ("BrownVinyl", "ValidationTest_of_TIS_via_BrownVinyl.bsdf"),
    ):
        yield name, read_measurement(folder / "rt300s" / file)[0]


def radiance_tree(measurement, *, leave_out=()):
    """Tree that Radiance makes of the scans, and the processor time it took [s]."""
    home = Path(pyradiance.__file__).parent
    path = f"{home / 'bin'}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "RAYPATH": f".:{home / 'lib'}"}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_pabopto(measurement, folder, leave_out=leave_out)
        before = spent_by_children()
        command = (
            f"pabopto2bsdf scan_*.txt > a.sir && bsdf2ttree -g {HALVINGS} a.sir > a.xml"
        )
        subprocess.run(
            command,
            shell=True,
            cwd=folder,
            env=environment,
            check=True,
            capture_output=True,
        )
        took = spent_by_children() - before
        bsdf = read_bsdf(folder / "a.xml")
    return bsdf.scattering(measurement.function), took


def spent_by_children():
    """Processor time of programs that were run [s]."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def our_tree(measurement, *, options):
    """Our tree of the scans, and the processor time it took [s]."""
    before = time.process_time()
    fitted = fit_measurement(measurement, symmetry="isotropic", options=options)
    tree = to_tree(fitted.interpolant, halvings=HALVINGS)
    return tree, time.process_time() - before


def held_out(measurement, *, options):
    """Yield errors of both programs for each scan that is left out."""
    step = max(1, len(measurement.scans) // MOST_HELD_OUT)
    for k, scan in list(enumerate(measurement.scans))[::-step]:
        scans = tuple(s for n, s in enumerate(measurement.scans) if n != k)
        rest = Measurement(scans, measurement.function)
        points = condense(scan)
        for tree in (
            our_tree(rest, options=options)[0],
            radiance_tree(measurement, leave_out=(k,))[0],
        ):
            source = np.broadcast_to(scan.incident, points.direction.shape)
            values = tree.evaluate(source, points.direction)
            flux = float(tree.hemispherical(scan.incident))
            yield k, flux - total_flux(scan), misplaced_light(points, values)


def head(title):
    """Lines at the top of a page."""
    return [
        f"# {title}",
        "",
        f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}, {platform.machine()}, Python"
        f" {platform.python_version()}, POT {version('POT')}, pyradiance"
        f" {version('pyradiance')}. Made by `benchmarks/gonio.py`.",
        "",
    ]


def truth_lines():
    """Yield the page of layers that are known."""
    yield from head("Measurements to BSDFs: known truth")
    yield (
        "Virtual goniophotometer: light of generated systems traced from discs of"
        " 0.25°, seen through an aperture of 0.7° (that of trees of 2⁷ cells), 2 %"
        " noise, an arm that hides a sector, nothing beyond 87°; and sums of lobes by"
        f" formula. Errors at 60 directions that were not measured (seed {SEED}), up to"
        " 75° from the normal: median / 9th decile / largest. Flux is a share of the"
        " incident light. *Straight lines* are what exact fluxes at the same"
        f" directions say. *Crossed* ones lie between scans whose exact fluxes differ"
        f" by more than {JUMP:g}: somewhere between is an edge. A beam is light of the"
        " truth within 6° of its own middle, at least 5 % of what comes in; its error"
        " is the angle to the middle of what is found there. A ghost is light within 3°"
        " of a place more than 4° from where the truth has any, over the brightest such"
        " place of the truth; *plain mean* shows it for the mean of the neighbours."
    )
    yield ""
    yield (
        "| layer | scans | flux | over 2 % | straight lines | over 2 % | crossed |"
        " brightest beam [°] | over 2° | all beams [°] | over 2° | ghost |"
        " plain mean |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    for known in known_truths():
        flux, peak, ghost = known.errors.T
        cells = [
            f"{len(known.measurement.scans)}",
            spread(flux, 4), f"{np.sum(np.abs(flux) > 0.02)}",
            spread(known.straight, 4), f"{np.sum(np.abs(known.straight) > 0.02)}",
            f"{known.crossed}",
            spread(peak, 2), f"{np.sum(peak > 2)}",
            spread(known.turns, 2), f"{np.sum(known.turns > 2)} of {len(known.turns)}",
            spread(ghost, 2), spread(known.plain, 2),
        ]  # fmt: skip
        yield f"| {known.name} | {' | '.join(cells)} |"
        figures(known)


def figures(known):
    """Write the figures of a layer."""
    if known.name == "formula: film":
        fit = fit_figure(known.measurement, known.fitted.interpolant, 34)
        save(fit, "gonio-film-fit")
        ends = from_degrees(np.array([40.0, 50]), np.array([45.0, 67.5]))
        save(between_figure(known.fitted.interpolant, *ends), "gonio-film-between")
    if known.name.startswith("prismatic film, 45"):
        save(flux_figure(known), "gonio-film-flux")


def flux_figure(known):
    """Flux of a film in the plane across its prisms, and what scans say about it."""
    theta = np.arange(-80.0, 80.1, 1.0)
    directions = from_degrees(theta, 90.0)
    layer = replace(known.layer, paths=CURVE_PATHS)
    truth = [light.total for light in layer.light(directions)]
    ours = known.fitted.interpolant.hemispherical(directions * FRONT)
    incidents = known.measurement.incidents
    on_line = np.abs(incidents[:, 0]) < 1e-6
    at = np.degrees(np.arcsin(incidents[on_line, 1]))
    order = np.argsort(at)
    figure = Figure(figsize=(8, 4), layout="constrained")
    axes = figure.subplots()
    axes.plot(theta, truth, "k-", lw=1, label="truth, every degree")
    axes.plot(at[order], known.known[on_line][order], "C7--", label="straight lines")
    axes.plot(theta, ours, "C0-", label="interpolant of 81 scans")
    axes.plot(at, known.known[on_line], "ko", ms=4, label="scans")
    axes.set(xlabel="profile angle [°]", ylabel="share of light transmitted")
    axes.legend(fontsize="small")
    return figure


def spread(values, digits):
    """Median, ninth decile and largest of sizes."""
    sizes = np.abs(values)
    return " / ".join(f"{np.quantile(sizes, q):.{digits}f}" for q in (0.5, 0.9, 1))


def radiance_lines(folder):
    """Yield the page of comparisons with Radiance."""
    yield from head("Measurements to BSDFs: held-out scans, ours and Radiance's")
    yield (
        "Scans are left out one by one, at most four a data set; a tree of rank 3 of 2⁶"
        " cells is made of the others and compared with the scan: mean error of the"
        " flux, and mean share of the light that is not where it was measured (noise of"
        " the measurement counts too), among the others \\| beyond the outermost."
        " Processor time for all scans, one core, from files or values to the tree."
    )
    yield ""
    yield (
        "| data | scans | flux, ours | Radiance | elsewhere, ours | Radiance |"
        " time, ours [s] | Radiance [s] | ratio |"
    )
    yield "|---|---|---|---|---|---|---|---|---|"
    for name, measurement in data_sets(folder):
        yield row(name, measurement)


def main():
    """Write one page."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("part", choices=("truth", "radiance", "smoothing"))
    parser.add_argument("--data", type=Path)
    wanted = parser.parse_args()
    FIGURES.mkdir(exist_ok=True)
    device.load("cpu", "sample_area")
    lines = {
        "truth": truth_lines,
        "radiance": lambda: radiance_lines(wanted.data),
        "smoothing": lambda: smoothing_lines(wanted.data),
    }[wanted.part]()
    written = []
    for line in lines:
        print(line, flush=True)
        written.append(line)
    page = REPOSITORY / "docs" / "benchmarks" / f"gonio-{wanted.part}.md"
    page.write_text("\n".join(written) + "\n", encoding="utf-8")


def row(name, measurement):
    """Line of the table of one data set."""
    options = FitOptions()
    _, our_time = our_tree(measurement, options=options)
    _, their_time = radiance_tree(measurement)
    errors = np.array(list(held_out(measurement, options=options)))
    outermost = int(np.argmax([scan.theta_deg for scan in measurement.scans]))
    beyond = errors[::2, 0] == outermost
    ours, theirs = errors[::2], errors[1::2]

    def both(table, column, digits):
        inside = np.abs(table[~beyond, column]).mean()
        return (
            f"{inside:.{digits}f} \\| {np.abs(table[beyond, column]).mean():.{digits}f}"
        )

    cells = [
        name,
        str(len(measurement.scans)),
        both(ours, 1, 4),
        both(theirs, 1, 4),
        both(ours, 2, 3),
        both(theirs, 2, 3),
        f"{our_time:.2f}",
        f"{their_time:.2f}",
        f"{their_time / our_time:.1f}",
    ]
    return f"| {' | '.join(cells)} |"


def smoothing_lines(folder):
    """Yield the page of leave-one-out errors for several smoothing factors."""
    yield from head("Measurements to BSDFs: the smoothing factor")
    yield "Medians over the scans that are left out among the others."
    yield ""
    yield "| data | smoothing | flux | beam [°] | EMD [°] | elsewhere | own fit |"
    yield "|---|---|---|---|---|---|---|"
    for name, measurement in data_sets(folder):
        for factor in (0.6, 1.0, 1.6):
            result = cross_validate(
                measurement,
                symmetry="isotropic",
                options=FitOptions(smoothing=factor),
            )
            names = ("flux_error", "peak_deg", "earth_mover_deg", "misplaced", "fitted")
            values = [result.median(n) for n in names]
            line = " | ".join(
                f"{v:.{d}f}" for v, d in zip(values, (4, 2, 2, 3, 3), strict=True)
            )
            yield f"| {name} | {factor:g} | {line} |"
    for name, measurement in [*data_sets(folder)][1:]:
        data_figures(name.split()[0].lower(), measurement, symmetry="isotropic")
    (lenslets,) = read_measurement(folder / "rt300s" / "IMX455.bsdf")
    data_figures("imx455", lenslets)


def data_figures(key, measurement, symmetry=None):
    """Write the fit of a scan, and what lies half-way to the nearest."""
    fitted = fit_measurement(measurement, symmetry=symmetry)
    theta = np.array([scan.theta_deg for scan in measurement.scans])
    order = np.lexsort((np.arange(len(theta)), theta))
    middle = len(order) // 2
    save(fit_figure(measurement, fitted.interpolant, order[middle]), f"gonio-{key}")
    incidents = measurement.incidents
    away = angle_between(incidents, incidents[order[middle]])
    ends = incidents[np.argsort(away)[1::-1]]
    save(between_figure(fitted.interpolant, *ends), f"gonio-{key}-between")


def save(figure, name):
    """Write a figure, small: few colours are enough for it."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=62)
    few = Image.open(buffer).convert("RGB").quantize(_COLOURS)
    few.save(FIGURES / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
