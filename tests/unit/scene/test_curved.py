"""Curved surfaces keep their sizes as triangles."""

import numpy as np
import pytest

from clerestory.scene.model import Cone, Ring, Sphere
from clerestory.scene.tessellate import curved_triangles


def area_vectors(triangles):
    corner = triangles.vertices[triangles.faces]
    return np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2


def middles(triangles):
    return triangles.vertices[triangles.faces].mean(axis=1)


def directions(count):
    v = np.random.default_rng(2).normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


@pytest.mark.parametrize("inward", [False, True])
def test_a_sphere_keeps_its_area_and_its_side(inward):
    ball = Sphere(np.array([1.0, -2, 3]), 0.7, inward, "grey")
    made = curved_triangles(ball)
    area = area_vectors(made)
    assert np.linalg.norm(area, axis=1).sum() == pytest.approx(4 * np.pi * 0.49)
    np.testing.assert_allclose(area.sum(axis=0), 0, atol=1e-12)
    outward = ((middles(made) - ball.centre) * area).sum(axis=1)
    assert np.all(outward < 0 if inward else outward > 0)
    distance = np.linalg.norm(made.vertices - ball.centre, axis=1)
    assert np.abs(distance / 0.7 - 1).max() < 0.005
    assert np.linalg.norm(middles(made) - ball.centre, axis=1).min() > 0.7 * 0.995


def test_a_sphere_looks_equally_large_from_everywhere():
    area = area_vectors(curved_triangles(Sphere(np.zeros(3), 1.0, False, "grey")))
    seen = np.clip(area @ directions(50).T, 0, None).sum(axis=0)
    np.testing.assert_allclose(seen, np.pi, rtol=0.002)
    assert seen.mean() == pytest.approx(np.pi, rel=5e-4)


@pytest.mark.parametrize("inward", [False, True])
@pytest.mark.parametrize("radii", [(0.3, 0.3), (0.5, 0.2), (0.0, 0.4), (0.4, 0.0)])
def test_a_cone_keeps_its_side_area_within_the_stated_accuracy(radii, inward):
    base, axis = np.array([1.0, 2, 3]), np.array([0.4, -1.2, 0.9])
    made = curved_triangles(Cone(base, base + axis, *radii, inward, "grey"))
    area = area_vectors(made)
    slant = np.hypot(np.linalg.norm(axis), radii[0] - radii[1])
    expected = np.pi * (radii[0] + radii[1]) * slant
    assert np.linalg.norm(area, axis=1).sum() == pytest.approx(expected, rel=5e-4)
    along = axis / np.linalg.norm(axis)
    away = middles(made) - base
    away = away - np.outer(away @ along, along)
    outward = (away * area).sum(axis=1)
    assert np.all(outward < 0 if inward else outward > 0)


def test_mouths_of_tubes_and_rings_have_exact_areas():
    axis = np.array([0.0, 0.6, 0.8])
    tube = curved_triangles(Cone(np.zeros(3), axis, 0.5, 0.5, True, "grey"))
    lid = curved_triangles(Ring(np.zeros(3), -axis, 0.2, 0.5, "grey"))
    area = area_vectors(lid)
    expected = np.pi * (0.25 - 0.04)
    assert np.linalg.norm(area, axis=1).sum() == pytest.approx(expected)
    np.testing.assert_allclose(area.sum(axis=0), -expected * axis, atol=1e-12)

    # The lid's rim is the tube's mouth, vertex by vertex
    rim, mouth = lid.vertices[:64], tube.vertices[:64]
    gap = np.linalg.norm(rim[:, None] - mouth, axis=2).min(axis=1)
    assert gap.max() < 1e-12


def test_a_disc_has_no_triangles_without_area():
    area = area_vectors(
        curved_triangles(Ring(np.zeros(3), np.array([0, 0, 2.0]), 0, 1, "g"))
    )
    assert np.linalg.norm(area, axis=1).min() > 0
    assert area.sum(axis=0)[2] == pytest.approx(np.pi)
