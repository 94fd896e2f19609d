"""Sunlight by way of prisms, lenses and curved mirrors, against closed forms.

Each estimate is repeated by 40 sensors in one place, whose random numbers are
independent, as by 40 seeds: their scatter and their error bars must agree.
"""

import numpy as np
import pytest
from caustic_scenes import (
    FOCUS,
    ball,
    ball_landings,
    focus_shares,
    focus_view,
    mirror_ball,
    mirror_light,
    prism,
    prism_light,
)
from repeated_estimates import SAMPLES, agrees

from clerestory.phases.rendering import irradiance, render, render_irradiance
from clerestory.scene.model import Plastic, Polygon, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

UPWARDS, NORTHWARDS = np.array([0.0, 0, 1]), np.array([0.0, 1, 0])


@pytest.mark.parametrize("where", [(0, 0), (0.85, 0.85), (-0.85, 0.5)])
def test_a_prism_deflects_the_sun(device, where):
    """Place and irradiance of the patch follow from Snell's and Fresnel's laws."""
    corners, truth = prism_light()
    low, high = corners.min(axis=0), corners.max(axis=0)
    place = (low + high) / 2 + np.array([*where, 0]) * (high - low) / 2
    agrees(prism(), place, UPWARDS, truth, device)


def test_the_size_of_the_scene_does_not_change_a_prism(device):
    """Black ground of 40 km below it: light still enters the prism at its surface."""
    corners, truth = prism_light()
    edge = 20000.0
    ground = [
        [-edge, -edge, -1],
        [edge, -edge, -1],
        [edge, edge, -1],
        [-edge, edge, -1],
    ]
    black = Plastic("ground", np.zeros(3))
    scene = prism() + Scene(
        {"ground": black}, (Polygon(np.array(ground), "ground", "ground"),)
    )
    agrees(scene, corners.mean(axis=0), UPWARDS, truth, device)


def test_a_prism_lights_nothing_beside_its_patch(device):
    """Beyond the penumbra, the floor is dark up to light reflected in the prism."""
    corners, truth = prism_light()
    low, high = corners.min(axis=0), corners.max(axis=0)
    side = np.array([[1.1, 0, 0], [-1.1, 0, 0], [0, 1.1, 0], [0, -1.1, 0]])
    places = (low + high) / 2 + side * (high - low) / 2
    sensors = Sensors(places, np.tile(UPWARDS, (4, 1)))
    found = irradiance(prism(), sensors, samples=65536, device=device)
    assert np.all(found.irradiance < 0.01 * truth + 4 * found.error)
    assert np.all(found.error < 0.3 * truth)


def test_a_picture_shows_the_patch_behind_a_prism(device):
    """Each pixel shows the radiance E·ρ/π of a matt floor."""
    corners, light = prism_light()
    low, high = corners.min(axis=0), corners.max(axis=0)
    dark, matt = prism(), Plastic("floor", np.full(3, 0.4))
    floor = np.array([[-5.0, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]])
    surfaces = *dark.surfaces, Polygon(floor, "floor", "floor")
    scene = Scene(dark.materials | {"floor": matt}, surfaces, dark.distant)
    middle, size = (low + high) / 2 + 0.3 * UPWARDS, 0.8 * (high - low)
    view = View("parallel", middle, -UPWARDS, NORTHWARDS, size[0], size[1])
    seen = render(scene, view, columns=16, rows=16, samples=512, device=device)
    radiance, error = seen.picture.radiance[..., 0], seen.error[..., 0]
    truth = light * 0.4 / np.pi
    assert abs(radiance.mean() - truth) < 0.01 * truth
    assert np.sqrt(np.mean(error**2)) < 0.2 * truth
    z = (radiance - truth) / error
    assert 0.7 < np.sqrt(np.mean(z**2)) < 1.4


@pytest.mark.parametrize("incidence_deg", [10, 40])
def test_a_mirror_ball_spreads_the_sun(device, incidence_deg):
    """Irradiance falls with the distance from the focal lines behind the surface."""
    place, normal, truth = mirror_light(1.0, incidence_deg)
    agrees(mirror_ball(), place, normal, truth, device, samples=4 * SAMPLES)


def test_a_ball_lens_focuses_the_sun(device):
    """Flux in the caustic on the floor, by quadrature over the ball's cross-section."""
    pixels = 48
    radius, flux = ball_landings()
    truth = flux[radius < FOCUS].sum()
    seen = render_irradiance(
        ball(), focus_view(), columns=pixels, rows=pixels, samples=1024, device=device
    )
    inside, area = focus_shares(pixels), (2 * FOCUS / pixels) ** 2
    found = np.sum(seen.picture.radiance[..., 0] * inside) * area
    error = np.sqrt(np.sum((seen.error[..., 0] * inside) ** 2)) * area
    assert abs(found - truth) < 0.01 * truth
    assert error < 0.01 * truth


def test_results_with_caustics_are_reproducible(device):
    """The same seed gives the same bits."""
    corners, _ = prism_light()
    place = corners.mean(axis=0)
    one, other = (
        irradiance(prism(), Sensors(place[None], UPWARDS[None]), samples=64, seed=5)
        for _ in range(2)
    )
    assert np.array_equal(one.irradiance, other.irradiance)
