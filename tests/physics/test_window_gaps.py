"""Gaps beside shades: daylight that passes there, against quadrature."""

import warnings
from dataclasses import astuple, replace

import numpy as np
import pytest
from fresnel import glazed
from physics_scenes import box, quad

from clerestory.engine.device import load
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import DistantSource, Glass, Glow, Scene
from clerestory.scene.sensors import Sensors

# Room and opening, which is as wide as the room; distance and overlap of the shade [m]
WIDTH, DEPTH, HEIGHT = 4.0, 5.0, 3.0
LOW, HIGH = 1.0, 2.4
AWAY, OVERLAP = 0.06, 0.02
SHADE = Glass("shade", np.full(3, 0.02))
PLACES = np.array([[2.0, 0.5, 2.9], [1.0, 0.3, 2.95], [2.5, 0.4, 0.1]])
NORMALS = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])


def wall(y, low, high, material="wall"):
    corners = (0, y, low), (0, y, high), (WIDTH, y, high), (WIDTH, y, low)
    return quad(*corners, material=material)


def shaded_room(away=AWAY):
    """A black room with a dark glass shade before its opening, below a uniform sky."""
    room, _ = box(WIDTH, DEPTH, HEIGHT, 0.0)
    shade = wall(away, LOW - OVERLAP, HIGH + OVERLAP, "shade")
    walls = *room.surfaces, wall(0, 0, LOW), wall(0, HIGH, HEIGHT), shade
    sky = Glow("sky", np.ones(3), 0.0)
    ends = (np.array([0.0, 0.0, side]) for side in (1, -1))
    distant = tuple(DistantSource(end, 180.0, "sky") for end in ends)
    materials = {**room.materials, "shade": SHADE, "sky": sky}
    return Scene(materials, walls, distant)


def light_of_opening(place, normal):
    """E = ∫ τ cos θ₁ cos θ₂ / r² over the opening, τ = 1 beside the shade."""
    x, z = ((np.arange(n) + 0.5) / n for n in (400, 4000))
    x, z = np.meshgrid(x * WIDTH, LOW + z * (HIGH - LOW))
    towards = np.stack([x, np.zeros_like(x), z], axis=-1) - place
    r2 = np.sum(towards**2, axis=-1)
    share = AWAY / place[1]
    met = z + share * (place[2] - z)
    covered = (met > LOW - OVERLAP) & (met < HIGH + OVERLAP)
    facing = place[1] / np.sqrt(r2)
    cosines = np.linspace(1e-3, 1, 200)
    glass = [glazed(SHADE, each)[1][0] for each in cosines]
    through = np.where(covered, np.interp(facing, cosines, glass), 1.0)
    cosine = np.maximum(towards @ normal / np.sqrt(r2), 0)
    return np.mean(through * cosine * facing / r2) * WIDTH * (HIGH - LOW)


def test_light_beside_a_shade_by_quadrature(device):
    """With 2 to 3 % of noise: paths that meet gaps by chance leave 7 to 13 %."""
    found = irradiance(
        shaded_room(), Sensors(PLACES, NORMALS), samples=4096, device=device
    )
    expected = [light_of_opening(*each) for each in zip(PLACES, NORMALS, strict=True)]
    expected = np.array(expected)[:, None]
    assert np.all(found.error < 0.04 * expected)
    np.testing.assert_array_less(
        np.abs(found.irradiance - expected), 4 * found.error + 0.002 * expected
    )


@pytest.mark.parametrize(("away", "count"), [(AWAY, 2), (0.0, 0)])
def test_strips_are_used_where_rays_pass(device, away, count):
    """Above and below a shade before its wall; none around a pane in its wall."""
    load(device)
    from clerestory.engine.lower import lower
    from clerestory.engine.pilot_paths import SurfacePoints
    from clerestory.engine.portals import window_rectangles
    from clerestory.engine.window_gaps import window_gaps

    scene, origin = shaded_room(away), np.zeros(3)
    found = window_gaps(
        lower(scene, origin=origin, illuminated=True),
        window_rectangles(scene, origin),
        SurfacePoints(PLACES, PLACES, NORMALS),
    )
    lowest = [
        min(corner[2] + each[2] for each in (0 * u, u, v))
        for corner, u, v in zip(*astuple(found), strict=True)
    ]
    edges = [LOW - OVERLAP - 0.2, HIGH + OVERLAP][:count]
    np.testing.assert_allclose(sorted(lowest), edges)


def test_panes_without_area_are_no_portals(device):
    load(device)
    from clerestory.engine.portals import window_rectangles

    scene = shaded_room()
    flat = wall(AWAY, LOW, LOW, "shade")
    more = replace(scene, surfaces=(*scene.surfaces, flat))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(window_rectangles(more, np.zeros(3))) == 1
