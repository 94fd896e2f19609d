"""Warnings of light that has no sampling technique."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.engine.unsampled_light import warn_of_unsampled_light
from clerestory.errors import ClerestoryWarning
from clerestory.scene.model import (
    Dielectric,
    DistantSource,
    Glass,
    Glow,
    Light,
    Metal,
    Mixture,
    Plastic,
    Polygon,
    Scene,
    Sphere,
    Textured,
    TriangleMesh,
)
from clerestory.scene.pattern import Product

POLISHED = Metal("m", np.full(3, 0.9), specularity=1.0)
BRUSHED = Metal("m", np.full(3, 0.9), specularity=1.0, roughness=0.02)
FINE = replace(BRUSHED, roughness=0.005)
BENT = Textured("m", POLISHED, Product(()))
GLASS = Glass("m", np.full(3, 0.9))
MATT = Plastic("m", np.full(3, 0.5))
UP = np.array([0.0, 0, 1])
SUN = DistantSource(UP, 0.5, "sun")
SKY = DistantSource(UP, 180.0, "sun")


def triangle(material="m"):
    """A small flat surface."""
    return Polygon(np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]]), material)


def fan(count):
    """Triangles of as many orientations."""
    angle = np.linspace(0, 3, count + 1)
    x, y = np.cos(angle), np.sin(angle)
    rim = np.column_stack([x, y, np.zeros(count + 1)])
    vertices = np.concatenate([rim, rim + UP])
    low = np.arange(count)
    faces = np.column_stack([low, low + 1, low + count + 1])
    return TriangleMesh(vertices, faces, "m")


def scene_of(surface, material, *sources):
    """A scene of one surface."""
    light = Light("sun", np.ones(3))
    return Scene({"m": material, "sun": light}, (surface,), sources)


CASES = {
    "1 curved smooth surfaces": (Sphere(UP, 0.2, False, "m"), POLISHED),
    "1 refracting surfaces": (triangle(), Dielectric("m", np.ones(3), 1.5)),
    "1 smooth surfaces of perturbed normals": (triangle(), BENT),
    "1 surfaces of narrow highlights": (triangle(), FINE),
    "1 smooth surfaces beyond the 256 largest planes": (fan(300), POLISHED),
}


LAMP = Scene({"lamp": Light("lamp", np.ones(3))}, (triangle("lamp"),))


@pytest.mark.parametrize("text", CASES)
def test_lamps_without_a_technique_are_named(text):
    surface, material = CASES[text]
    with pytest.warns(ClerestoryWarning, match=f"luminaires by way of {text} .*chance"):
        warn_of_unsampled_light(scene_of(surface, material) + LAMP)


@pytest.mark.parametrize("text", list(CASES)[:4])
def test_the_sun_needs_no_warning(text):
    """Particles find the sun by way of every single surface."""
    surface, material = CASES[text]
    warn_of_unsampled_light(scene_of(surface, material, SUN))


def test_a_mixture_is_checked_by_its_parts():
    mixed = Mixture("m", MATT, BENT, 0.5)
    with pytest.warns(ClerestoryWarning, match="perturbed normals"):
        warn_of_unsampled_light(scene_of(triangle(), mixed) + LAMP)


def test_small_lamps_are_named():
    lamp = triangle("lamp")
    scene = Scene(
        {"m": POLISHED, "lamp": Light("lamp", np.ones(3))},
        (Sphere(UP, 0.2, False, "m"), lamp),
    )
    with pytest.warns(ClerestoryWarning, match="small luminaires by way of 1 curved"):
        warn_of_unsampled_light(scene)


def test_narrow_highlights_of_lamps_are_named():
    with pytest.warns(ClerestoryWarning, match="by way of 1 surfaces of narrow"):
        warn_of_unsampled_light(scene_of(triangle(), BRUSHED) + LAMP)


@pytest.mark.parametrize("material", [POLISHED, GLASS, MATT, BRUSHED])
def test_flat_surfaces_need_no_warning(material):
    warn_of_unsampled_light(scene_of(triangle(), material, SUN))


@pytest.mark.parametrize("material", [GLASS, MATT])
def test_faint_repeated_reflections_need_no_warning(material):
    warn_of_unsampled_light(scene_of(fan(200), material, SUN))


@pytest.mark.parametrize("count", [5, 200])
def test_mirrors_of_many_orientations_are_named(count):
    """Their images by several reflections are too many."""
    scene = scene_of(fan(count), POLISHED, SUN)
    tilted = Polygon(np.array([[0.0, 0, 2], [1, 0, 2.3], [0, 1, 2.5]]), "m")
    scene = replace(scene, surfaces=(*scene.surfaces, tilted))
    with pytest.warns(ClerestoryWarning, match="mirror each other many times"):
        warn_of_unsampled_light(scene)


def test_parallel_mirrors_need_no_warning():
    """All images of a lamp down to a faint one are sampled."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    mirrors = [Polygon(corners + height * UP, "m") for height in (0, 3)]
    shine = {"m": POLISHED, "lamp": Light("lamp", np.ones(3))}
    warn_of_unsampled_light(Scene(shine, (*mirrors, triangle("lamp"))))


def test_wide_sources_need_no_warning():
    """BSDF sampling finds the sky, and glows that are not sampled."""
    ball = Sphere(UP, 0.2, False, "m")
    warn_of_unsampled_light(scene_of(ball, POLISHED, SKY))
    faint = Scene(
        {"m": POLISHED, "glow": Glow("glow", np.ones(3))}, (ball, triangle("glow"))
    )
    warn_of_unsampled_light(faint)
