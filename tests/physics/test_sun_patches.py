"""Places that the sun shines on are found, and light a room as they must."""

import numpy as np
import pytest

from clerestory.phases.rendering import irradiance
from clerestory.scene.model import DistantSource, Light, Plastic, Polygon, Scene
from clerestory.scene.sensors import Sensors

HEIGHT = 3.0
SLOT = (0.1, 3.0)
SUN = np.array([0.0, 0.0, 1.0])
ANGLE_DEG, RADIANCE, REFLECTANCE = 0.533, 1e5, 0.5


def sheet(material, height, x, y):
    corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
    return Polygon(np.array([(*c, height) for c in corners]), material, material)


def under_a_slot():
    """A floor under a wide black roof with a slot, and the sun at the zenith."""
    half = np.array(SLOT) / 2
    roof = (
        ((-20, -half[0]), (-20, 20)),
        ((half[0], 20), (-20, 20)),
        ((-half[0], half[0]), (-20, -half[1])),
        ((-half[0], half[0]), (half[1], 20)),
    )
    materials = {
        "roof": Plastic("roof", np.zeros(3)),
        "floor": Plastic("floor", np.full(3, REFLECTANCE)),
        "sun": Light("sun", np.full(3, RADIANCE)),
    }
    surfaces = [sheet("roof", HEIGHT, *part) for part in roof]
    surfaces.append(sheet("floor", 0.0, (-5, 5), (-5, 5)))
    sun = DistantSource(SUN, ANGLE_DEG, "sun")
    return Scene(materials, tuple(surfaces), (sun,))


def light_of_stripe(position):
    """E = ∫ L cos θ₁ cos θ₂ / r² over the stripe, seen by a sensor that faces down."""
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(ANGLE_DEG / 2)))
    leaving = RADIANCE * solid_angle * REFLECTANCE / np.pi
    x, y = (
        (np.arange(count) + 0.5) / count * size - size / 2
        for count, size in zip((40, 600), SLOT, strict=True)
    )
    x, y = np.meshgrid(x, y)
    r2 = (x - position[0]) ** 2 + (y - position[1]) ** 2 + position[2] ** 2
    return leaving * np.mean(position[2] ** 2 / r2**2) * SLOT[0] * SLOT[1]


def test_a_stripe_of_sun_lights_the_room_beside_it(device):
    """In closed form, calmly: paths that meet it by chance leave 6 % of noise."""
    places = np.array([[1.5, 0.0, 1.0], [3.0, 1.0, 2.0], [0.5, -1.0, 2.5]])
    sensors = Sensors(places, np.tile([0.0, 0.0, -1.0], (3, 1)))
    found = irradiance(under_a_slot(), sensors, samples=4096, device=device)
    expected = np.array([light_of_stripe(place) for place in places])[:, None]
    assert np.all(found.error < 0.02 * expected)
    np.testing.assert_array_less(
        np.abs(found.irradiance - expected), 4 * found.error + 0.003 * expected
    )


@pytest.mark.parametrize("shift", [0.0, 1e4])
def test_rooms_far_from_the_origin_are_lit_alike(device, shift):
    """Patches are looked for around the sensors, not around the model's origin."""
    scene = under_a_slot()
    moved = tuple(
        Polygon(s.vertices + np.array([shift, shift, 0.0]), s.material, s.name)
        for s in scene.surfaces
    )
    scene = Scene(scene.materials, moved, scene.distant)
    place = np.array([[1.5 + shift, shift, 1.0]])
    sensors = Sensors(place, np.array([[0.0, 0.0, -1.0]]))
    found = irradiance(scene, sensors, samples=4096, device=device)
    expected = light_of_stripe(np.array([1.5, 0.0, 1.0]))
    assert found.irradiance[0, 0] == pytest.approx(expected, rel=0.03)
