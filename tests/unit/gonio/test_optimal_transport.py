"""Plans and displacement: light is kept, lobes travel, nothing is seen twice."""

import numpy as np
import pytest

from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.cross_validation import earth_movers_distance
from clerestory.gonio.displacement_interpolation import (
    displace,
    edge_particles,
    triangle_particles,
)
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_motion import with_unmatched_lobes
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.network_assembly import connect, join, refine_plans
from clerestory.gonio.optimal_transport import plan_transport


def cluster(theta_deg, flux, *, seed=0, count=12):
    """A sharp peak made of several lobes, as fits are."""
    rng = np.random.default_rng(seed)
    theta = theta_deg + rng.normal(size=count)
    phi = rng.normal(size=count) / max(np.sin(np.radians(theta_deg)), 0.1)
    share = rng.random(count)
    return Lobes(
        from_degrees(theta, phi),
        np.full(count, 0.03),
        flux * share / share.sum(),
    )


def together(*parts):
    return Lobes(
        np.concatenate([p.centre for p in parts]),
        np.concatenate([p.radius for p in parts]),
        np.concatenate([p.flux for p in parts]),
    )


def test_a_plan_sends_and_receives_all_light():
    one, other = cluster(20, 0.5), together(cluster(30, 0.3, seed=1), cluster(70, 0.1))
    plan = plan_transport(one, other, angle=np.radians(10))
    sent = np.bincount(plan.source, plan.sent, len(one)) + plan.fading
    came = np.bincount(plan.target, plan.received, len(other)) + plan.rising
    assert sent == pytest.approx(one.flux)
    assert came == pytest.approx(other.flux)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_flux_along_an_edge_is_the_weighted_mean(share):
    one, other = cluster(20, 0.5), cluster(30, 0.2, seed=1)
    edge = edge_particles(plan_transport(one, other, angle=np.radians(10)))
    between = displace(edge, (one, other, other), s=share, t=0.0)
    assert between.total == pytest.approx(0.5 - 0.3 * share)


def test_a_peak_that_dims_travels_as_one():
    """Half-way from 20° to 30° stands one peak at 25°, though most light is lost."""
    one, other = cluster(20, 0.5), cluster(30, 0.05, seed=1)
    edge = edge_particles(plan_transport(one, other, angle=np.radians(10)))
    between = displace(edge, (one, other, other), s=0.5, t=0.0)
    middle = from_degrees(25.0, 0.0)
    away = angle_between(between.centre, middle)
    assert between.flux[away > np.radians(6)].sum() < 0.01 * between.total
    assert angle_between(between.strongest(), middle) < np.radians(1.5)


def test_light_that_changes_between_far_peaks_makes_no_peak_between_them():
    """60 : 40 becomes 40 : 60; balanced transport would send a fifth across."""
    one = together(cluster(10, 0.6), cluster(70, 0.4, seed=1))
    other = together(cluster(12, 0.4, seed=2), cluster(72, 0.6, seed=3))
    edge = edge_particles(plan_transport(one, other, angle=np.radians(5)))
    between = displace(edge, (one, other, other), s=0.5, t=0.0)
    theta = np.degrees(np.arccos(between.centre[:, 2]))
    assert between.flux[(theta > 20) & (theta < 60)].sum() < 1e-6
    assert between.flux[theta < 20].sum() == pytest.approx(0.5, abs=1e-6)


def test_a_peak_without_partner_fades_in_its_place():
    one = together(cluster(10, 0.4), cluster(70, 0.3, seed=1))
    other = cluster(12, 0.4, seed=2)
    edge = edge_particles(plan_transport(one, other, angle=np.radians(5)))
    between = displace(edge, (one, other, other), s=0.5, t=0.0)
    theta = np.degrees(np.arccos(between.centre[:, 2]))
    assert between.flux[theta > 60].sum() == pytest.approx(0.15, rel=1e-6)
    assert np.abs(theta[theta > 60] - 70).max() < 5


def corners():
    return cluster(20, 0.5), cluster(30, 0.3, seed=1), cluster(26, 0.4, seed=2)


def triangle(lobes):
    a, b, c = lobes
    plans = (
        plan_transport(x, y, angle=np.radians(10)) for x, y in ((a, b), (a, c), (b, c))
    )
    return triangle_particles(*plans)


@pytest.mark.parametrize(("s", "t", "corner"), [(0, 0, 0), (1, 0, 1), (0.4, 1, 2)])
def test_corners_of_a_triangle_are_the_fits(s, t, corner):
    lobes = corners()
    found = displace(triangle(lobes), lobes, s=s, t=t)
    assert found.total == pytest.approx(lobes[corner].total, rel=1e-9)
    points = lobes[corner].centre
    truth = lobes[corner].evaluate(points)
    assert found.evaluate(points) == pytest.approx(truth, rel=0.05)


def test_flux_within_a_triangle_is_the_weighted_mean():
    lobes = corners()
    found = displace(triangle(lobes), lobes, s=0.25, t=0.5)
    truth = 0.5 * (0.75 * 0.5 + 0.25 * 0.3) + 0.5 * 0.4
    assert found.total == pytest.approx(truth, rel=1e-9)


def test_edges_of_a_triangle_are_the_edges_of_its_neighbours():
    """At s = 0 a triangle shows the plan from A to C alone."""
    lobes = corners()
    a, _, c = lobes
    within = displace(triangle(lobes), lobes, s=0.0, t=0.5)
    edge = edge_particles(plan_transport(a, c, angle=np.radians(10)))
    along = displace(edge, (a, c, c), s=0.5, t=0.0)
    points = along.centre[:: max(1, len(along) // 20)]
    assert within.evaluate(points) == pytest.approx(along.evaluate(points), rel=0.05)


def test_earth_movers_distance_of_a_shifted_lobe_is_the_shift():
    one = Lobes(
        from_degrees(np.array([20.0]), np.zeros(1)), np.ones(1) / 10, np.ones(1)
    )
    for shift in (10.0, 30.0):
        other = Lobes(
            from_degrees(np.array([20.0 + shift]), np.zeros(1)),
            np.ones(1) / 10,
            np.full(1, 0.3),
        )
        assert np.degrees(earth_movers_distance(one, other)) == pytest.approx(
            shift, abs=1.5
        )
    assert earth_movers_distance(one, one) == pytest.approx(0.0, abs=1e-9)


def test_light_that_one_corner_alone_has_is_there_in_its_triangles():
    """A beam that only one scan shows is whole at that scan, from every side."""
    sources = from_degrees(
        np.array([0.0, 20, 20, 20, 20]), np.array([0.0, 0, 90, 180, 270])
    )
    one = cluster(20, 0.4)
    for shown in range(len(sources)):
        fits = [
            together(one, cluster(60, 0.3, seed=4)) if k == shown else one
            for k in range(len(sources))
        ]
        network = with_unmatched_lobes(connect(sources, fits, "none"), mean_motion=0.0)
        for number, corners in enumerate(network.mesh.triangles):
            flux = triangle_particles(*network.plans_of(number)).flux.sum(axis=0)
            truth = [fits[v].total for v in corners]
            assert flux == pytest.approx([*truth, truth[2]], rel=1e-6)


def test_a_beam_that_is_shifted_in_the_disc_is_met_everywhere():
    """A grating adds a constant to the tangential components of direction."""

    def shifted(incident):
        disc = np.array([0.25, -0.1]) - incident[:2]
        centre = np.array([[*disc, np.sqrt(1 - disc @ disc)]])
        return Lobes(centre, np.full(1, 0.03), np.full(1, 0.5))

    theta, phi = np.meshgrid([15.0, 30, 45], 45.0 * np.arange(8))
    sources = from_degrees(theta.ravel(), phi.ravel())
    fits = [shifted(source) for source in sources]
    grating = Interpolant(connect(sources, fits, "none"), "none")
    for theta, phi in ((5.0, 20.0), (22.0, 70.0), (37.0, 200.0), (43.0, 300.0)):
        source = from_degrees(theta, phi)
        found = grating.lobes(source)
        middle = found.flux @ found.centre / found.total
        assert middle[:2] == pytest.approx(shifted(source).centre[0, :2], abs=1e-6)


def orders(incident, *, period=0.4):
    """Beams of a grating: orders of diffraction side by side, of uneven brightness."""
    disc = period * np.arange(-2, 3)[:, None] * [1.0, 0.0] - incident[:2]
    flux = np.array([0.1, 0.2, 0.3, 0.2, 0.1])
    inside = np.hypot(*disc.T) < 0.98
    disc, flux = disc[inside], flux[inside]
    height = np.sqrt(1 - np.sum(disc**2, axis=1))
    centre = np.concatenate([disc, height[:, None]], axis=1)
    return Lobes(centre, np.full(len(disc), 0.03), flux)


def misled(network, sources):
    """Light that a plan sends into another order than its own."""
    light = 0.0
    for (a, b), plan in zip(network.mesh.edges, network.plans, strict=True):
        start, end = network.lobes[a].centre, network.lobes[b].centre
        move = end[plan.target] - start[plan.source]
        astray = np.hypot(*(move + sources[b] - sources[a])[:, :2].T) > 0.01
        light += float(np.minimum(plan.sent, plan.received)[astray].sum())
    return light


def test_beams_that_turn_past_their_neighbours_keep_their_order():
    """Every beam of a grating moves in the disc as the incident light does.

    Along the longest edges that is more than half the distance between orders, and
    the nearest is another order; the shorter edges say so.
    """
    theta, phi = np.meshgrid([10.0, 20.0, 30.0], 22.5 * np.arange(16))
    sources = np.concatenate(
        [from_degrees(theta.ravel(), phi.ravel()), [[0.0, 0.0, 1.0]]]
    )
    plain = join(sources, [orders(source) for source in sources], "none")
    assert misled(plain, sources) > 1.0
    assert misled(refine_plans(plain), sources) < 1e-3
