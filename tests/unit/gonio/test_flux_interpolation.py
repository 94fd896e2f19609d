"""Total flux between scans: Fresnel's bend, a cut-off, and light that fades."""

import numpy as np
import pytest

from clerestory.gonio.angles import angle_between, from_degrees, undeviated
from clerestory.gonio.flux_interpolation import flux_surface
from clerestory.gonio.incident_mesh import arc_mesh, triangulate
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.network_assembly import connect
from goniometer import quarter_circle

FRONT = np.array([1.0, 1.0, -1.0])


def schlick(theta_deg):
    """Reflectance of glass by Schlick's approximation."""
    return 0.04 + 0.96 * (1 - np.cos(np.radians(theta_deg))) ** 5


def bars(incident):
    """Share that passes between bars along x: none beyond a profile angle of 40°."""
    tangent = np.abs(incident[..., 1]) / incident[..., 2]
    return np.maximum(1 - tangent / np.tan(np.radians(40)), 0)


def quarters(directions):
    images = [directions * [i, j, 1] for i in (1, -1) for j in (1, -1)]
    return np.unique(np.round(np.concatenate(images), 12), axis=0)


def test_flux_on_an_arc_follows_fresnel():
    theta = np.radians(np.arange(0, 81, 10.0))
    curve = flux_surface(
        arc_mesh(theta),
        schlick(np.degrees(theta)),
        symmetry="isotropic",
        quadrant=np.ones(2),
    )
    between = np.arange(5, 80, 10.0)
    found = curve.at(from_degrees(between, np.zeros(8)))
    assert found == pytest.approx(schlick(between), abs=0.01)
    assert np.isnan(curve.at(from_degrees(np.array([85.0]), np.zeros(1)))[0])


def test_a_cut_off_between_directions_is_found():
    """Straight lines between neighbours miss it by up to 0.07, see bars()."""
    mesh = triangulate(quarters(quarter_circle()))
    surface = flux_surface(
        mesh, bars(mesh.vertices), symmetry="quadrilateral", quadrant=np.ones(2)
    )
    rng = np.random.default_rng(4)
    sine = np.sqrt(rng.random(200)) * np.sin(np.radians(75))
    places = from_degrees(np.degrees(np.arcsin(sine)), rng.uniform(0, 90, 200))
    assert np.abs(surface.at(places) - bars(places)).max() < 0.02


def test_an_even_flux_stays_even():
    mesh = triangulate(quarters(quarter_circle()))
    totals = np.full(len(mesh.vertices), 0.4)
    surface = flux_surface(mesh, totals, symmetry="quadrilateral", quadrant=np.ones(2))
    assert surface.at(from_degrees(np.array([33.0]), np.array([20.0])))[0] == 0.4


def test_light_that_is_cut_off_goes_straight_on_to_its_end():
    """Bars pass a beam and scatter a little; where the beam fades it stays straight."""
    directions = quarter_circle()

    def scattered(incident):
        flux = np.array([0.8 * float(bars(incident)), 0.05])
        centre = np.array([undeviated(incident), [0, 0, 1.0]])
        keep = flux > 1e-6
        return Lobes(centre[keep], np.array([0.03, 0.6])[keep], flux[keep])

    network = connect(directions, [scattered(d) for d in directions], "quadrilateral")
    part = Interpolant(network, "quadrilateral")
    for theta, phi in ((37.0, 63.0), (54.0, 27.0), (33.0, 75.0), (25.0, 40.0)):
        incident = from_degrees(theta, phi)
        lobes = part.lobes(incident * FRONT)
        sharp = lobes.radius < 0.1
        away = angle_between(lobes.centre[sharp], undeviated(incident))
        assert np.degrees(away).max() < 2
        assert lobes.total == pytest.approx(scattered(incident).total, abs=0.02)
        assert lobes.flux[~sharp].sum() == pytest.approx(0.05, abs=0.02)
