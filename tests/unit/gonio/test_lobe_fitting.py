"""Fits against layers whose lobes are known."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.lobe_fitting import FitOptions, fit_lobes, fit_scans
from clerestory.gonio.parallel import Workers
from clerestory.gonio.quadtree import Quadtree
from clerestory.gonio.scattering_measurement import Scan
from goniometer import Goniophotometer, film, pane


def hemisphere(count=20000):
    """Points of equal projected solid angle, π in all."""
    rng = np.random.default_rng(7)
    r, phi = np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count)
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r * r)], axis=-1)


@pytest.mark.parametrize("layer", [film, pane])
@pytest.mark.parametrize("theta_deg", [0.0, 35.0, 65.0])
def test_a_fit_is_the_layer_that_was_measured(layer, theta_deg):
    """Noise of 2 %, a gap and an aperture leave the light where it is."""
    incident = from_degrees(theta_deg, 40.0)
    scan = Goniophotometer().scan(layer, incident, np.random.default_rng(2))
    truth, lobes = layer(incident), fit_lobes(scan)
    assert lobes.total == pytest.approx(truth.total, rel=0.02)
    points = hemisphere()
    moved = np.abs(lobes.evaluate(points) - truth.evaluate(points)).mean() * np.pi / 2
    assert moved < 0.05 * truth.total
    for centre, radius in zip(truth.centre, truth.radius, strict=True):
        if radius < 0.1:
            found = lobes.climb(truth.climb(centre))
            assert angle_between(found, truth.climb(centre)) < np.radians(2)


def test_there_are_at_most_twice_as_many_lobes_as_asked_for():
    """Twice where the fit is poor."""
    scan = Goniophotometer().scan(
        film, from_degrees(40.0, 20.0), np.random.default_rng(2)
    )
    for most in (8, 50, 200):
        assert len(fit_lobes(scan, FitOptions(lobes=most))) <= 2 * most


def test_an_even_layer_stays_even():
    """A Lambertian layer of 0.6 has 0.6/π in all directions."""
    points = hemisphere(3000)
    scan = Scan(from_degrees(20.0, 0.0), points, np.full(len(points), 0.6 / np.pi))
    lobes = fit_lobes(scan)
    assert lobes.total == pytest.approx(0.6, rel=1e-3)
    change = lobes.evaluate(points) / (0.6 / np.pi) - 1
    assert np.sqrt(np.mean(change**2)) < 0.05


def test_noise_below_zero_makes_no_negative_light():
    points = hemisphere(2000)
    rng = np.random.default_rng(4)
    values = 5 * np.exp(60 * (points[:, 2] - 1)) + 0.05 * rng.normal(size=2000)
    lobes = fit_lobes(Scan(from_degrees(0.0, 0.0), points, values))
    assert values.min() < 0
    assert lobes.evaluate(hemisphere()).min() >= 0


def test_more_negative_than_positive_light_is_refused():
    points = hemisphere(500)
    values = np.where(points[:, 0] > 0.95, 1.0, -1.0)
    with pytest.raises(InputError, match="blank"):
        fit_lobes(Scan(from_degrees(0.0, 0.0), points, values))


def test_smoothing_widens_lobes():
    scan = Goniophotometer().scan(
        film, from_degrees(40.0, 20.0), np.random.default_rng(2)
    )
    peaks = [
        fit_lobes(scan, FitOptions(smoothing=s)).evaluate(film(scan.incident).centre)[1]
        for s in (1.0, 2.0, 4.0)
    ]
    assert peaks[0] > peaks[1] > peaks[2]


def test_cells_of_the_quadtree_hold_every_point_once():
    points = hemisphere(2000)
    cells = Quadtree(points, points[:, 0] ** 2).cut(100, coarsest=2)
    assert sorted(cells.order) == list(range(2000))
    assert np.diff(cells.first).sum() == 2000
    assert np.diff(cells.first).min() >= 1
    assert cells.solid_angle.sum() == pytest.approx(2 * np.pi)


def test_options_that_make_no_fit_are_refused():
    for wrong, words in (
        ({"lobes": 3}, "number of lobes is 3"),
        ({"smoothing": 0.0}, "smoothing is 0"),
        ({"smoothing": 9.0}, "smoothing is 9"),
    ):
        with pytest.raises(InputError, match=words):
            FitOptions(**wrong)


def test_a_scan_that_is_dark_beside_others_is_fitted_as_dark():
    """A film turns all light back from some directions; noise is all that is left."""
    rng = np.random.default_rng(6)
    bright = Goniophotometer(points=400).scan(film, from_degrees(20.0, 30.0), rng)
    noise = 1e-5 * rng.normal(size=len(bright.values))
    dark = Scan(from_degrees(70.0, 30.0), bright.leaving, noise)
    fits = fit_scans([bright, dark])
    assert fits[0].total > 0.5
    assert 0 < fits[1].total < 1e-6
    less = np.where(np.arange(len(noise)) == 0, 1e-3, noise - 0.1)
    taken = Scan(from_degrees(70.0, 30.0), bright.leaving, less)
    with pytest.raises(InputError, match="blank"):
        fit_scans([bright, taken])


def test_linear_algebra_runs_in_one_thread():
    (threads,) = Workers().map("threads", _threads, [(0,)])
    assert set(threads) <= {1}
    many = Workers(2).map("threads", _threads, [(k,) for k in range(16)])
    assert {threads for pools in many for threads in pools} <= {1}


def _threads(_number):
    return [pool["num_threads"] for pool in threadpool_info()]
