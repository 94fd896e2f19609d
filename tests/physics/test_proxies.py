"""BSDFs with a thickness are proxies for geometry: Radiance's BSDF material.

A layer of Lambertian transmittance lies just below a black sheet that it hides, both
far wider than they are high above a sensor. Indirect rays that meet the layer's front
are scattered and leave beyond the sheet. Direct rays, view rays and rays from behind
pass the layer: they meet the sheet.
"""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import quad, sensor, window

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.rendering import irradiance
from clerestory.phases.sky_views import sun_view_coefficients
from clerestory.scene.model import BsdfSurface, DistantSource, Light, Plastic, Scene
from clerestory.scene.ray_bundles import RayBundles

TRANSMITTANCE = 0.4
LAYER, SHEET, WINDOW = 2.0, 2.05, 2.5
FAR = 300.0
UPWARDS = sensor((0, 0, 1), (0, 0, 1))


def ceiling(height, material="layer"):
    """A square that faces down."""
    a = FAR
    corners = (-a, -a, height), (-a, a, height), (a, a, height), (a, -a, height)
    return quad(*corners, material=material)


def scene(thickness, *, sheet=True, distant=()):
    patches = klems("quarter")
    even = np.full((len(patches), len(patches)), TRANSMITTANCE / np.pi)
    sides = "transmission_front", "transmission_back"
    found = ScatteringMatrix(even, patches, patches)
    bsdf, zero = Bsdf({("visible", side): found for side in sides}), np.zeros(3)
    up = np.array([0.0, 1.0, 0.0])
    materials = {
        "layer": BsdfSurface(
            "layer", bsdf, thickness, up, front=zero, back=zero, transmission=zero
        ),
        "black": Plastic("black", zero),
        "even": Light("even", np.ones(3)),
        "bright": Light("bright", np.full(3, 1e4)),
    }
    sheets = (ceiling(SHEET, "black"),) if sheet else ()
    return Scene(materials, (ceiling(LAYER), *sheets), distant=distant)


def sky(kind="even", angle_deg=180.0):
    return DistantSource(np.array([0.0, 0.0, 1.0]), angle_deg, kind, kind)


def view(place, device, **kwargs):
    above = window(ceiling(WINDOW), up=(0, 1, 0))
    return cl.view_matrix(place, above, samples=1 << 14, device=device, **kwargs)


@pytest.mark.parametrize("thickness", [0.1, -0.1])
def test_sensors_see_windows_through_the_front_of_a_proxy(device, thickness):
    """A positive thickness hides the sheet behind, a negative one does not."""
    matrix = view(scene(thickness), device, sensors=UPWARDS)
    expected = TRANSMITTANCE * np.pi if thickness > 0 else 0
    assert matrix.values[0].sum() == pytest.approx(expected, rel=0.03)


def test_sensors_see_the_sky_through_the_front_of_a_proxy(device):
    """The same in daylight coefficients and in the irradiance of an instant."""
    matrix = cl.daylight_coefficients(
        scene(0.1), sensors=UPWARDS, subdivision=1, samples=1 << 14, device=device
    )
    assert matrix.values[0].sum() == pytest.approx(TRANSMITTANCE * np.pi, rel=0.03)
    lit = irradiance(
        scene(0.1, distant=(sky(),)), UPWARDS, samples=1 << 14, device=device
    )
    assert lit.irradiance[0] == pytest.approx(TRANSMITTANCE * np.pi, rel=0.03)


def test_a_window_without_geometry_is_counted_once(device):
    """Light that a proxy scatters does not pass it straight as well."""
    matrix = view(scene(0.1, sheet=False), device, sensors=UPWARDS)
    assert matrix.values[0].sum() == pytest.approx(TRANSMITTANCE * np.pi, rel=0.03)


@pytest.mark.parametrize("direct", [False, True])
def test_view_rays_pass_a_proxy(device, direct):
    """A camera sees the window itself through the layer, or the sheet before it."""
    eye = cl.parse_view("-vtv -vp 0 0 1 -vd 0 0 1 -vu 0 1 0 -vh 40 -vv 40")
    for sheet, expected in ((False, 1.0), (True, 0.0)):
        found = picture_view_matrices(
            scene(0.1, sheet=sheet), [window(ceiling(WINDOW), up=(0, 1, 0))],
            Camera(eye, 4, 4), direct=direct, samples=64, device=device,
        )  # fmt: skip
        assert found["south"].values[0].sum(axis=1) == pytest.approx(expected)


def test_direct_sun_meets_the_geometry_and_scattered_sun_the_proxy(device):
    """The sun straight from above reaches the sensor where there is no sheet."""
    irradiance_of_sun = 1e4 * np.pi * np.sin(np.radians(0.533 / 2)) ** 2
    for sheet, straight in ((False, 1), (True, 0)):
        place = scene(0.1, sheet=sheet, distant=(sky("bright", 0.533),))
        found = irradiance(place, UPWARDS, samples=1 << 14, bounces=1, device=device)
        expected = irradiance_of_sun * (straight + TRANSMITTANCE)
        assert found.irradiance[0] == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize(("distance", "lit"), [(0.45, 0), (0.55, 1)])
def test_scattered_sunlight_enters_behind_the_geometry_of_a_proxy(
    device, distance, lit
):
    """From 0.1 m above the layer, the sun at 45° clears a wall 0.5 m higher, at 0.5 m.

    From the layer itself, the wall would shade up to 0.6 m. A view ray passes the layer
    and meets nothing.
    """
    x, top = distance, LAYER + 0.6
    wall = quad((x, -9, LAYER), (x, 9, LAYER), (x, 9, top), (x, -9, top))
    place = scene(0.1, sheet=False)
    walls = replace(wall, material="black")
    place = replace(place, surfaces=(*place.surfaces, walls))
    up, suns = np.array([[[0, 0, 1.0]]]), np.array([[1, 0, 1]]) / np.sqrt(2)
    for indirect in (True, False):
        found = sun_view_coefficients(
            place, RayBundles(up, up), suns=suns, indirect=indirect, samples=1024,
            device=device,
        )  # fmt: skip
        expected = indirect * lit * TRANSMITTANCE / np.pi / np.sqrt(2)
        assert found.values[0, 0, 0] == pytest.approx(expected, rel=1e-3)
