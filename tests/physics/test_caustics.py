"""Sunlight by way of prisms, lenses and curved mirrors, against closed forms.

Each estimate is repeated by 40 sensors in one place, whose random numbers are
independent, as by 40 seeds: their scatter and their error bars must agree.
"""

import numpy as np
import pytest
from caustic_scenes import (
    SUN_DEG,
    ball,
    ball_landings,
    mirror_ball,
    mirror_light,
    prism,
    prism_light,
)

from clerestory.phases.rendering import irradiance, render, render_irradiance
from clerestory.scene.model import Plastic, Polygon, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

SEEDS, SAMPLES = 40, 8192
UPWARDS, NORTHWARDS = np.array([0.0, 0, 1]), np.array([0.0, 1, 0])
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEG / 2)))


def repeated(scene, place, normal, device, *, samples=SAMPLES):
    """Irradiance of independent sensors in one place, and their errors."""
    many = Sensors(np.tile(place, (SEEDS, 1)), np.tile(normal, (SEEDS, 1)))
    found = irradiance(scene, many, samples=samples, device=device)
    return found.irradiance[:, 0], found.error[:, 0]


def agrees(scene, place, normal, truth, device, *, samples=SAMPLES):
    """Check mean, error bars, and variance against that of BSDF sampling.

    Cosine-distributed directions find the sun with at most the probability p that is
    the irradiance over π times the radiance of the sun: 1/(p·n) is their relative
    variance.
    """
    value, error = repeated(scene, place, normal, device, samples=samples)
    scatter = value.std(ddof=1)
    assert abs(value.mean() - truth) < 4 * scatter / np.sqrt(SEEDS) + 1e-3 * truth
    assert abs(value.mean() - truth) < 0.01 * truth
    assert 0.7 < np.sqrt(np.mean(error**2)) / scatter < 1.4
    assert np.mean(np.abs(value - truth) > 3 * error) <= 0.1
    by_chance = np.pi / (truth * SUN_SR * samples)
    assert (scatter / truth) ** 2 < by_chance / 50


@pytest.mark.parametrize("where", [(0, 0), (0.85, 0.85), (-0.85, 0.5)])
def test_a_prism_deflects_the_sun(device, where):
    """Place and irradiance of the patch follow from Snell's and Fresnel's laws."""
    corners, truth = prism_light()
    low, high = corners.min(axis=0), corners.max(axis=0)
    place = (low + high) / 2 + np.array([*where, 0]) * (high - low) / 2
    agrees(prism(), place, UPWARDS, truth, device)


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
    half, pixels, part = 0.02, 48, 16
    radius, flux = ball_landings()
    truth = flux[radius < half].sum()
    view = View(
        "parallel", 0.004 * UPWARDS, -UPWARDS, NORTHWARDS, 2 * half, 2 * half
    )  # fmt: skip
    seen = render_irradiance(
        ball(), view, columns=pixels, rows=pixels, samples=1024, device=device
    )
    # Share of each pixel within the circle
    place = (np.arange(pixels * part) + 0.5) / (pixels * part) * 2 - 1
    inside = np.hypot(*np.meshgrid(place, place)) < 1
    inside = inside.reshape(pixels, part, pixels, part).mean(axis=(1, 3))
    area = (2 * half / pixels) ** 2
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
