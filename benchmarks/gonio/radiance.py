"""Held-out scans, ours and Radiance's: pabopto2bsdf, then bsdf2ttree -g 6.

Radiance is that of pyradiance; its trees are read by us.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyradiance
from data_sets import data_sets
from page import head

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.gonio.fitted_measurement import export_bsdf, fit_measurement
from clerestory.gonio.lobe_fitting import (
    FitOptions,
    condensed_points,
    misplaced_flux,
)
from clerestory.gonio.measurement_files import read_measurement
from clerestory.gonio.scattering_measurement import Measurement
from clerestory.gonio.tree_export import to_tree
from goniometer import write_pabopto

HALVINGS = 6
MOST_HELD_OUT = 4
RUNS, LONG = 5, 3.0  # runs of which the median counts; of one that takes longer, one


def lines(folder):
    """Yield the page of comparisons with Radiance."""
    yield from head("Measurements to BSDFs: held-out scans, ours and Radiance's")
    yield (
        "Scans are left out one by one, at most four a data set; a tree of rank 3 of"
        " 2⁶ cells is made of the others and compared with the scan: mean error of"
        " the flux, and mean share of the light that is not where it was measured"
        " (noise of the measurement counts too), among the others \\| beyond the"
        " outermost. Processor time for all scans, one core, in turns, the median of"
        " five (of one where Radiance takes over 3 s): *ours* from values to the"
        " tree, *with files* from the files that Radiance reads to an XML file like"
        f" Radiance's. The start of Python and of its libraries, {started():.1f} s, is"
        " in neither."
    )
    yield ""
    yield (
        "| data | scans | flux, ours | Radiance | elsewhere, ours | Radiance |"
        " time, ours [s] | with files [s] | Radiance [s] | ratio | with files |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for name, measurement in data_sets(folder):
        yield row(name, measurement)


def row(name, measurement):
    """Line of the table of one data set."""
    options = FitOptions()
    our_time, whole_time, their_time = times(measurement, options=options)
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
        *(f"{time:.2f}" for time in (our_time, whole_time, their_time)),
        *(f"{their_time / time:.1f}" for time in (our_time, whole_time)),
    ]
    return f"| {' | '.join(cells)} |"


def times(measurement, *, options):
    """Processor times of our tree, of ours with files, and of Radiance's [s]."""
    our_tree(measurement, options=options)
    taken = []
    while len(taken) < RUNS:
        _, ours = our_tree(measurement, options=options)
        _, theirs = radiance_tree(measurement)
        taken.append((ours, our_file(measurement, options=options), theirs))
        if theirs > LONG:
            break
    return np.median(taken, axis=0)


def started():
    """Processor time of Python until our first tree, but for the tree itself [s]."""
    code = (
        "import numpy as np; from clerestory.gonio.tree_export import to_tree;"
        "from clerestory.gonio.fitted_measurement import fit_measurement;"
        "from clerestory.gonio.raster import Raster;"
        "from clerestory.gonio.lobes import norm;"
        f"norm(np.ones(1), np.ones(1)); Raster.of({HALVINGS})"
    )
    before = spent_by_children()
    subprocess.run([sys.executable, "-c", code], check=True)
    return spent_by_children() - before


def our_file(measurement, *, options):
    """Processor time from the files that Radiance reads to an XML file [s]."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_pabopto(measurement, folder)
        before = time.process_time()
        (read,) = read_measurement(*sorted(folder.glob("scan_*.txt")))
        fitted = fit_measurement(read, symmetry="isotropic", options=options)
        tree = export_bsdf([fitted], "tree", halvings=HALVINGS)
        write_bsdf(folder / "tree.xml", tree, digits=6)
        return time.process_time() - before


def held_out(measurement, *, options):
    """Yield errors of both programs for each scan that is left out."""
    step = max(1, len(measurement.scans) // MOST_HELD_OUT)
    for k, scan in list(enumerate(measurement.scans))[::-step]:
        scans = tuple(s for n, s in enumerate(measurement.scans) if n != k)
        rest = Measurement(scans, measurement.function)
        points = condensed_points(scan)
        for tree in (
            our_tree(rest, options=options)[0],
            radiance_tree(measurement, leave_out=(k,))[0],
        ):
            source = np.broadcast_to(scan.incident, points.direction.shape)
            values = tree.evaluate(source, points.direction)
            flux = float(tree.hemispherical(scan.incident))
            yield k, flux - scan.flux, misplaced_flux(points, values)


def our_tree(measurement, *, options):
    """Our tree of the scans, and the processor time it took [s]."""
    before = time.process_time()
    fitted = fit_measurement(measurement, symmetry="isotropic", options=options)
    tree = to_tree(fitted.interpolant, halvings=HALVINGS)
    return tree, time.process_time() - before


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
