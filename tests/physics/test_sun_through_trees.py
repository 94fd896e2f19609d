"""Direct sun through a tensor tree against quadrature over window and sun."""

import numpy as np
import pytest
from physics_scenes import box

from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.engine.device import load
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.scene.sensors import Sensors

RADIUS = np.radians(0.533 / 2)
EYES = np.array([[1.0, 2.0, 0.8], [2.0, 2.5, 0.8], [3.0, 4.5, 0.8]])
SUNS_DEG = ((170, 15), (200, 22.2), (150, 35))


@pytest.fixture(scope="module")
def tree():
    """A blind whose open slats leave a bright patch straight on."""
    blind = venetian(slat_width=0.08, spacing=0.072, tilt_deg=20, reflectance=0.5)
    return generate_bsdf(
        blind, basis="tree4", halvings=4, sides="front", samples=300, geometry=False
    )


def towards(azimuth_deg, altitude_deg):
    azimuth, altitude = np.radians([azimuth_deg, altitude_deg])
    flat = np.cos(altitude)
    return np.array([np.sin(azimuth) * flat, np.cos(azimuth) * flat, np.sin(altitude)])


def over_disc(sun, count):
    """Directions that fill the sun's disc evenly: a sunflower's seeds."""
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    radius = RADIUS * np.sqrt((np.arange(count) + 0.5) / count)
    across = np.cross(sun, [0, 0, 1.0])
    across /= np.linalg.norm(across)
    along = np.cross(across, sun)
    place = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * along
    found = sun + np.tan(radius)[:, None] * place
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def quadrature(window, tree, eye, sun, cells=(600, 300), points=6):
    """∫ f(ω_sun, ω) cos θ_sun cos θ dω over the window, mean over the disc."""
    corners = window.polygons[0].vertices
    low, high = corners.min(axis=0), corners.max(axis=0)
    x, z = (
        low[i] + (np.arange(n) + 0.5) / n * (high[i] - low[i])
        for i, n in zip((0, 2), cells, strict=True)
    )
    place = np.stack(np.meshgrid(x, low[1], z, indexing="ij"), -1).reshape(-1, 3)
    line = eye - place
    distance2 = (line**2).sum(axis=1)
    leaving = line / np.sqrt(distance2)[:, None]
    frame = window.frame
    axes = np.stack([frame.right, frame.up, frame.normal], axis=-1)
    upwards = np.maximum(-leaving[:, 2], 0)
    form = (leaving @ frame.normal) * upwards / distance2
    total = 0.0
    for one in over_disc(sun, points):
        value = tree.evaluate(one @ axes, leaving @ axes)
        total += (value * form).sum() * -(one @ frame.normal) / points
    area = (high[0] - low[0]) * (high[2] - low[2])
    return total * area / len(place)


def test_direct_sun_is_the_integral_over_window_and_disc(device, tree):
    """Also where the disc lies on the edge of two cells of the tree."""
    scene, south = box(4, 5, 3, 0.0)
    suns = np.stack([towards(*each) for each in SUNS_DEG])
    found = sun_coefficients(
        scene, [south], "south", tree, suns=suns, samples=8192, device=device,
        sensors=Sensors(EYES, np.array([[0, 0, 1.0]] * len(EYES))),
    )  # fmt: skip
    expected = np.array([[quadrature(south, tree, e, s) for s in suns] for e in EYES])
    error = found.standard_error[0]
    assert np.all(error < 0.03 * expected)
    # A grid of cells misses edges of the tree's cells by 1 % at most
    assert np.all(abs(found.values[0] - expected) < 4 * error + 0.01 * expected)


def test_two_ways_to_a_sun_share_its_light(device):
    """A path that comes to the sun by chance counts little, and nothing is lost."""
    share = load(device, "next_event_estimation").power_heuristic
    import mitsuba as mi

    along, aimed = mi.Float([200.0, 1e-3, 1e30]), mi.Float([4400.0, 1e4, 1e4])
    one = (along * share(along, aimed)).numpy()
    other = (aimed * share(aimed, along)).numpy()
    assert one + other == pytest.approx(1)
    assert one == pytest.approx([200**2 / (200**2 + 4400**2), 0, 1], rel=1e-5)
