"""Cross-validation and the survey find what is wrong with a measurement."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.coverage import measure_coverage
from clerestory.gonio.cross_validation import (
    CrossValidation,
    LeftOut,
    cross_validate,
    earth_movers_distance,
)
from clerestory.gonio.lobe_fitting import FitOptions
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.scattering_measurement import Measurement, Scan
from goniometer import Goniophotometer, pane, rings


@pytest.fixture(scope="module")
def errors(pane_measurement):
    return cross_validate(pane_measurement)


def test_a_smooth_layer_is_predicted_well(errors):
    """The lobe moves with the light, so its neighbours say where it stands."""
    assert len(errors.scans) == 9
    inside = [scan for scan in errors.scans if scan.inside]
    assert len(inside) == 8
    for scan in inside[1:-1]:
        assert abs(scan.flux_error) < 0.03
        assert scan.peak_deg < 2
        assert scan.earth_mover_deg < 4
        assert scan.misplaced < 0.1


def test_outliers_are_marked(errors):
    beyond = [scan for scan in errors.scans if not scan.inside]
    assert [round(scan.theta_deg) for scan in beyond] == [80]


def test_a_wrong_scan_has_the_largest_error(pane_measurement):
    """One scan of twice the flux: its own error is by far the largest."""
    scans = list(pane_measurement.scans)
    odd = scans[4]
    scans[4] = Scan(odd.incident, odd.leaving, 0.5 * odd.values)
    errors = cross_validate(Measurement(tuple(scans), "transmission_front"))
    sizes = [abs(scan.flux_error) for scan in errors.scans]
    assert int(np.argmax(sizes)) == 4
    assert sizes[4] > 0.35


def test_smoothing_has_a_best_value(pane_measurement):
    """A very wide lobe misplaces more light than one of the usual width."""
    few = Measurement(pane_measurement.scans[::3], "transmission_front")
    usual, wide = (
        cross_validate(few, options=FitOptions(smoothing=factor))
        for factor in (1.0, 4.0)
    )
    assert usual.median("misplaced") < wide.median("misplaced")
    assert (usual.smoothing, wide.smoothing) == (1.0, 4.0)


def test_two_scans_cannot_be_validated(pane_measurement):
    few = Measurement(pane_measurement.scans[:2], "transmission_front")
    with pytest.raises(InputError, match="3 or more"):
        cross_validate(few)


def test_a_survey_says_what_is_covered(pane_measurement):
    coverage = measure_coverage(pane_measurement)
    assert coverage.implied == "isotropic"
    for report, scan in zip(coverage.scans, pane_measurement.scans, strict=True):
        assert report.flux == pytest.approx(pane(scan.incident).total, rel=0.02)
        assert 85 < report.reach_deg < 87.1
        assert report.noise == pytest.approx(0.02, rel=0.5)
        assert not report.in_plane
    assert not [doubt for doubt in coverage.doubts() if "negative" in doubt]


def test_gaps_and_negative_values_are_doubts():
    scan = Goniophotometer().scan(
        pane, from_degrees(20.0, 0.0), np.random.default_rng(1)
    )
    seen = scan.leaving[:, 1] < 0.3
    values = np.where(scan.leaving[:, 0] > 0.3, -scan.values, scan.values)
    broken = Scan(scan.incident, scan.leaving[seen], values[seen])
    doubts = " ".join(
        measure_coverage(Measurement((broken,), "transmission_front")).doubts()
    )
    for word in ("no data", "negative", "two or more"):
        assert word in doubts


def test_points_in_one_plane_are_reported():
    theta = np.linspace(-80, 80, 41)
    leaving = from_degrees(theta, np.full(41, 180.0))
    scan = Scan(from_degrees(30.0, 0.0), leaving, np.full(41, 0.2))
    coverage = measure_coverage(Measurement((scan,), "reflection_front"))
    assert coverage.scans[0].in_plane
    assert "plane of incidence" in coverage.doubts()[0]


def test_a_layer_without_the_symmetry_of_its_directions_is_reported():
    """Measured on one azimuth, but light leaves towards one side."""

    def lopsided(incident):
        lobes = pane(incident)
        centre = lobes.centre + np.array([[0, 0.4, 0], [0, 0, 0]])
        centre /= np.linalg.norm(centre, axis=1, keepdims=True)
        return type(lobes)(centre, lobes.radius, lobes.flux)

    measurement = Goniophotometer(points=800).measure(
        lopsided, rings(azimuths_deg=[0.0], step_deg=30.0)
    )
    coverage = measure_coverage(measurement)
    assert coverage.implied == "isotropic"
    assert any("differs between mirror images" in doubt for doubt in coverage.doubts())


def test_a_direction_that_is_predicted_dark_has_no_earth_movers_distance():
    """Left out, the one bright scan is predicted by dark ones: nothing to move."""
    dark = Lobes(np.array([[0, 0, 1.0]]), np.ones(1), np.zeros(1))
    bright = Lobes(np.array([[0, 0, 1.0]]), np.ones(1), np.ones(1))
    assert np.isnan(earth_movers_distance(dark, bright))


def test_medians_leave_out_what_is_not_known():
    known = LeftOut(30, 0, True, 0.5, 0.5, 1.0, 2.0, 0.1, 0.02)
    dark = LeftOut(40, 0, True, 0.5, 0.0, 1.0, float("nan"), 0.1, 0.02)
    assert CrossValidation((known, dark), 1.0).median("earth_mover_deg") == 2.0
