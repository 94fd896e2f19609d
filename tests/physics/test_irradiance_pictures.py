"""Irradiance pictures show what sensors on the surfaces read."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.phases.rendering import irradiance, render_irradiance
from clerestory.scene.model import (
    DistantSource,
    Glass,
    Glow,
    Metal,
    Plastic,
    Polygon,
    Scene,
)
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

UP = np.array([0.0, 0.0, 1.0])


def square(height, material, size=2.0):
    corners = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    return Polygon(size * corners + height * UP, material)


def scene(*surfaces, **materials):
    """Surfaces under a uniform sky of radiance 2 above and 1 below."""
    made = {name: material for name, material in materials.items()}
    made |= {
        "sky": Glow("sky", np.full(3, 2.0), 0.0),
        "earth": Glow("earth", np.ones(3), 0.0),
    }
    return Scene(
        made,
        surfaces,
        (DistantSource(UP, 180.0, "sky"), DistantSource(-UP, 180.0, "earth")),
    )


def seen(room, device, *, below=False, **options):
    eye = np.array([0.0, 0.0, -3.0 if below else 3.0])
    view = View(
        "perspective", eye, UP if below else -UP, np.array([0.0, 1.0, 0.0]), 30, 30
    )
    return render_irradiance(
        room, view, columns=2, rows=2, samples=2048, device=device, **options
    )


@pytest.mark.parametrize("material", [Plastic, Metal])
@pytest.mark.parametrize("below", [False, True])
def test_a_horizontal_sensor_reads_the_sky_on_its_side(device, material, below):
    """π L whatever it is made of, on the side that is seen."""
    made = seen(
        scene(square(0, "m"), m=material("m", np.full(3, 0.7), 0.9, 0.0)),
        device,
        below=below,
    )
    assert made.picture.quantity == "irradiance"
    expected = np.pi * (1 if below else 2)
    assert np.all(made.error < 0.01)
    assert np.all(np.abs(made.picture.radiance - expected) < 5 * made.error + 1e-4)


def test_panes_are_looked_through_and_the_sky_is_not_shown(device):
    """Under a pane that passes 91.8 % at right angles, less of the sky arrives."""
    glass = Glass("g", np.ones(3))
    matt = Plastic("m", np.zeros(3))
    both = seen(scene(square(0, "m"), square(1, "g", 30.0), m=matt, g=glass), device)
    values = both.picture.radiance / (2 * np.pi)
    assert np.all((values > 0.82) & (values < 0.92))
    only = seen(scene(square(1, "g", 30.0), g=glass), device)
    assert np.all(only.picture.radiance == 0)


def test_pixels_agree_with_sensors_in_a_room(device):
    """Walls that reflect into a corner: the same light by both ways."""
    wall = Polygon(np.array([[-1.0, 1, 0], [1, 1, 0], [1, 1, 2], [-1, 1, 2]]), "m")
    room = scene(
        square(0, "m"), wall, m=Plastic("m", np.array([0.8, 0.5, 0.2]), 0.1, 0.2)
    )
    view = View(
        "perspective", np.array([0, 0.8, 1.5]), -UP, np.array([0, 1.0, 0]), 0.1, 0.1
    )
    made = render_irradiance(
        room, view, columns=1, rows=1, samples=1 << 15, bounces=3, device=device
    )
    sensor = Sensors(np.array([[0, 0.8, 1e-4]]), np.array([[0, 0, 1.0]]))
    other = irradiance(room, sensor, samples=1 << 15, bounces=3, device=device)
    error = np.hypot(made.error[0, 0], other.error[0])
    assert np.all(error < 0.005 * other.irradiance[0])
    difference = np.abs(made.picture.radiance[0, 0] - other.irradiance[0])
    assert np.all(difference < 4 * error)


def test_the_gather_itself_is_a_bounce():
    with pytest.raises(InputError, match="1 or more expected"):
        seen(scene(square(0, "m"), m=Plastic("m", np.zeros(3))), "cpu", bounces=0)
