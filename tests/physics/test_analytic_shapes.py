"""Round shapes have their true normals: what they mirror comes from where it should."""

import numpy as np
import pytest

from clerestory.phases.rendering import irradiance, render
from clerestory.scene.model import (
    Cone,
    Dielectric,
    DistantSource,
    Glow,
    Metal,
    Scene,
    Sphere,
)
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

NORTH = np.array([0.0, 1.0, 0.0])
MIRROR = Metal("m", np.ones(3), 1.0, 0.0)
# Offset from the origin, so that a shift that is forgotten shows
CENTRE = np.array([40.0, -25.0, 7.0])


def lit(surface, material, towards):
    """A surface under half a sky of radiance 1."""
    sky = Glow("sky", np.ones(3), 0.0)
    return Scene(
        {"m": material, "sky": sky},
        (surface,),
        (DistantSource(towards, 180.0, "sky"),),
    )


def seen(scene, towards, device, *, offset=(0, 0, 0)):
    """Radiance along one narrow view."""
    eye = CENTRE + np.array(offset) - 10 * towards
    view = View("perspective", eye, towards, np.array([0.1, 0.2, 1.0]), 1e-3, 1e-3)
    made = render(scene, view, columns=1, rows=1, samples=64, device=device)
    return made.picture.radiance[0, 0, 0]


@pytest.mark.parametrize("inward", [False, True])
@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
def test_mirrors_show_the_sky_up_to_the_exact_edge(device, kind, inward):
    """The edge of a sky behind the eye shows where the normal is at 45° to the sight.

    That is at sin 45° of the radius beside the middle; facets of 64 sides or of 1280
    triangles would have it wrong by up to 3°.
    """
    radius, sight = 0.8, np.array([-1.0, 0.0, 0.0])
    if kind == "sphere":
        shape = Sphere(CENTRE, radius, inward, "m")
    else:
        upwards = np.array([0.0, 0.0, 1.0])
        ends = CENTRE - upwards, CENTRE + upwards
        shape = Cone(*ends, radius, radius, inward, "m")
    scene = lit(shape, MIRROR, -sight)
    for share, expected in ((0.998, 1.0), (1.002, 0.0), (-0.998, 1.0), (-1.002, 0.0)):
        beside = share * radius * np.sqrt(0.5)
        found = seen(scene, sight, device, offset=(0, beside, 0))
        assert found == pytest.approx(expected, abs=1e-3), share


def test_a_glass_ball_turns_the_view_around(device):
    """A ray at height h leaves a ball deviated by 2(i - r), sin i = h, sin r = h/n."""
    scene = lit(
        Sphere(CENTRE, 1.0, False, "m"), Dielectric("m", np.ones(3), 1.5), NORTH
    )
    height = 0.6
    incidence, refraction = np.arcsin(height), np.arcsin(height / 1.5)
    turn = 2 * (incidence - refraction)
    # A sight that is bent into the north by a hair, and one that is not
    for extra, bright in ((0.01, True), (-0.01, False)):
        angle = turn - extra
        towards = np.array([-np.cos(angle), np.sin(angle), 0.0])
        across = np.array([np.sin(angle), np.cos(angle), 0.0])
        found = seen(scene, towards, device, offset=height * across)
        assert (found > 0.5) == (not bright)


def test_white_balls_in_a_white_sky_are_white(device):
    """A furnace: a mirror ball before a sky of 1 all around is not seen."""
    sky = Glow("sky", np.ones(3), 0.0)
    whole = (DistantSource(NORTH, 180.0, "sky"), DistantSource(-NORTH, 180.0, "sky"))
    ball = Sphere(CENTRE, 1.0, False, "m")
    scene = Scene({"m": MIRROR, "sky": sky}, (ball,), whole)
    places = CENTRE + np.array([[1.5, 0, 0], [0, 0, -1.01]])
    sensors = Sensors(places, np.array([[-1.0, 0, 0], [0, 0, 1]]))
    made = irradiance(scene, sensors, samples=1 << 14, device=device)
    assert np.all(made.error < 0.01)
    assert np.all(np.abs(made.irradiance - np.pi) < 4 * made.error + 1e-4)


def test_a_long_slanting_tube_is_built_without_a_word(capfd):
    """An arm of a desk lamp in inches, a mirror before a sky of 1: it is not seen."""
    base, top = np.array([0, -5.08, 2.54]), np.array([0, -16.37350513, 33.56865034])
    tube = Cone(base, top, 0.635, 0.635, False, "m", "arm")
    sky = Glow("sky", np.ones(3), 0.0)
    whole = (DistantSource(NORTH, 180.0, "sky"), DistantSource(-NORTH, 180.0, "sky"))
    scene = Scene({"m": MIRROR, "sky": sky}, (tube,), whole)
    eye = (base + top) / 2 + np.array([9.0, 0, 0])
    ahead, up = np.array([-1.0, 0, 0]), np.array([0.0, 0, 1])
    view = View("perspective", eye, ahead, up, 1.0, 1.0)
    made = render(scene, view, columns=1, rows=1, samples=16, device="cpu")
    assert made.picture.radiance == pytest.approx(1, abs=1e-4)
    assert "shear" not in "".join(capfd.readouterr())
