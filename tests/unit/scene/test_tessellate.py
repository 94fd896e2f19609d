"""Meshes hold every surface, in its material and facing its way."""

import numpy as np
import pytest

from clerestory.scene.model import Plastic, Polygon, Scene, Sphere
from clerestory.scene.tessellate import meshes


def plastic(name):
    return Plastic(name, np.full(3, 0.5))


def polygon(contour, material="grey"):
    flat = np.array(contour, dtype=float)
    return Polygon(np.column_stack([flat, np.zeros(len(flat))]), material, "p")


SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]
ARROW = [(0, 0), (2, 0), (0.5, 0.5), (0, 2)]
BOW_TIE = [(0, 0), (2, 2), (2, 0), (0, 3)]
TRIANGLE = [(0, 0), (1, 0), (0, 1)]
HEXAGON = [(2, 0), (1, 1.5), (-1, 1.5), (-2, 0), (-1, -1.5), (1, -1.5)]


def area_by_surface(mesh):
    corner = mesh.vertices[mesh.faces]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2] / 2
    return np.bincount(mesh.surface, area), np.bincount(mesh.surface, np.abs(area))


def test_each_polygon_keeps_its_area_and_front():
    contours = [SQUARE, ARROW, TRIANGLE, HEXAGON, SQUARE[::-1]]
    expected = [4, 1, 0.5, 9, -4]
    scene = Scene({"grey": plastic("grey")}, tuple(polygon(c) for c in contours))
    [mesh] = meshes(scene)
    signed, absolute = area_by_surface(mesh)
    np.testing.assert_allclose(signed, expected)
    np.testing.assert_allclose(absolute, np.abs(expected))


def test_a_quadrilateral_that_crosses_itself_is_not_taken_for_convex():
    """Its loops meet at x = 1.2, with areas 1.2·3/2 and 0.8·2/2."""
    [mesh] = meshes(Scene({"grey": plastic("grey")}, (polygon(BOW_TIE),)))
    assert area_by_surface(mesh)[1][0] == pytest.approx(1.8 + 0.8)


def test_a_pentagram_is_not_taken_for_convex():
    """By parity its points are filled and the pentagon between them is open."""
    angle = np.radians(90 + 144 * np.arange(5))
    [mesh] = meshes(
        Scene(
            {"grey": plastic("grey")},
            (polygon(np.column_stack([np.cos(angle), np.sin(angle)])),),
        )
    )
    inner = np.sin(np.radians(18)) / np.sin(np.radians(54))
    outline = 5 * inner * np.sin(np.radians(36))
    pentagon = 2.5 * inner**2 * np.sin(np.radians(72))
    assert area_by_surface(mesh)[1][0] == pytest.approx(outline - pentagon)


@pytest.mark.parametrize("turns", [1, -1])
def test_regular_polygons_become_fans(turns):
    angle = turns * 2 * np.pi * np.arange(12) / 12
    contour = np.column_stack([np.cos(angle), np.sin(angle)])
    [mesh] = meshes(Scene({"grey": plastic("grey")}, (polygon(contour),)))
    assert len(mesh.faces) == 10
    assert area_by_surface(mesh)[0][0] == pytest.approx(turns * 3)


def test_materials_get_a_mesh_each_in_their_order():
    materials = {name: plastic(name) for name in ("a", "b", "unused")}
    surfaces = (polygon(SQUARE, "b"), polygon(TRIANGLE, "a"), polygon(TRIANGLE, "b"))
    first, second = meshes(Scene(materials, surfaces))
    assert (first.material.name, second.material.name) == ("a", "b")
    assert first.surface.tolist() == [1]
    assert sorted(second.surface.tolist()) == [0, 0, 2]


def test_curved_surfaces_stand_beside_polygons():
    ball = Sphere(np.zeros(3), 1.0, False, "grey")
    [mesh] = meshes(Scene({"grey": plastic("grey")}, (ball, polygon(SQUARE))))
    assert np.bincount(mesh.surface).tolist() == [1280, 2]
    assert mesh.faces.max() == len(mesh.vertices) - 1


def test_a_scene_without_surfaces_has_no_meshes():
    assert meshes(Scene({"grey": plastic("grey")})) == ()
