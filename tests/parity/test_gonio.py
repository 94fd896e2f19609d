"""Measured BSDFs against Radiance's pabopto2bsdf on the same files."""

import numpy as np
import pytest
from radiance import run

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.fitted_measurement import fit_measurement
from clerestory.gonio.lobe_fitting import condensed_points, misplaced_flux
from clerestory.gonio.measurement_files import read_measurement
from clerestory.gonio.scattering_measurement import Measurement
from clerestory.gonio.tree_export import to_tree
from goniometer import Goniophotometer, film, pane, rings, write_pabopto

FRONT = np.array([1.0, 1.0, -1.0])

pytestmark = pytest.mark.slow


def radiance_tree(folder, *, halvings):
    """What Radiance makes of the scans in a folder."""
    run("pabopto2bsdf scan_*.txt > layer.sir", folder=folder)
    run(f"bsdf2ttree -g {halvings} layer.sir > layer.xml", folder=folder)
    return read_bsdf(folder / "layer.xml").scattering("transmission_front")


def test_light_leaves_where_radiance_says(tmp_path):
    """Sides, azimuths and up of the files: half a circle of a lopsided film."""
    directions = rings(azimuths_deg=[-90, -30, 30, 90], step_deg=40.0, most_deg=40.0)
    measurement = Goniophotometer(points=200).measure(film, directions)
    write_pabopto(measurement, tmp_path)
    theirs = radiance_tree(tmp_path, halvings=4)
    (found,) = read_measurement(*sorted(tmp_path.glob("scan_*.txt")))
    ours = fit_measurement(found).interpolant
    assert ours.symmetry == "bilateral-x"
    for source in from_degrees(np.array([25.0, 25, 25]), np.array([30.0, 150, -90])):
        peaks = film(source).centre[:2]
        pairs = np.broadcast_to(source * FRONT, peaks.shape)
        opposite = peaks * [-1, -1, 1] if source[1] < 0 else peaks * [-1, 1, 1]
        for part in (ours, theirs):
            there, not_there = (part.evaluate(pairs, d) for d in (peaks, opposite))
            # From below nearly all light goes on; else both peaks lie on one side
            if source[1] < 0:
                assert there[0] > 2 * not_there[0]
            else:
                assert np.all(there > 3 * not_there)


def test_held_out_scans_are_met_at_least_as_well_as_by_radiance(tmp_path):
    measurement = Goniophotometer(points=600).measure(
        pane, rings(azimuths_deg=[0.0], step_deg=20.0)
    )
    scan = measurement.scans[2]
    rest = tuple(s for s in measurement.scans if s is not scan)
    write_pabopto(measurement, tmp_path, leave_out=(2,))
    theirs = radiance_tree(tmp_path, halvings=5)
    fitted = fit_measurement(Measurement(rest, measurement.function))
    ours = to_tree(fitted.interpolant, halvings=5)
    points = condensed_points(scan)
    pairs = np.broadcast_to(scan.incident * FRONT, points.direction.shape)
    one, other = (
        misplaced_flux(points, tree.evaluate(pairs, points.direction))
        for tree in (ours, theirs)
    )
    assert one <= other
