"""Meshes of incident directions, and the symmetry that directions imply."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.incident_mesh import arc_mesh, locate, triangulate
from clerestory.gonio.symmetry import deduce_symmetry, fold, images
from goniometer import half_circle, quarter_circle, rings


def around():
    return rings(azimuths_deg=range(0, 360, 36))


def test_triangles_are_delaunay_on_the_sphere():
    """No direction lies in the circle about the corners of a triangle."""
    rng = np.random.default_rng(3)
    points = from_degrees(rng.uniform(0, 85, 60), rng.uniform(0, 360, 60))
    mesh = triangulate(points)
    a, b, c = points[mesh.triangles].transpose(1, 0, 2)
    axis = np.cross(b - a, c - a)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    axis *= np.sign(np.sum(axis * a, axis=1, keepdims=True))
    inside = axis @ points.T > np.sum(axis * a, axis=1)[:, None] + 1e-9
    assert not inside.any()


def test_a_triangulation_satisfies_eulers_formula():
    mesh = triangulate(around())
    vertices, edges, triangles = 81, len(mesh.edges), len(mesh.triangles)
    assert vertices - edges + triangles == 1
    assert mesh.rim.sum() == 10


def test_a_place_leads_back_to_its_direction():
    mesh = triangulate(around())
    rng = np.random.default_rng(1)
    wanted = from_degrees(rng.uniform(0, 75, 200), rng.uniform(0, 360, 200))
    place = locate(mesh, wanted)
    assert not place.on_edge.any()
    for k, direction in enumerate(wanted):
        a, b, c = mesh.vertices[mesh.triangles[place.simplex[k]]]
        point = along(along(a, b, place.s[k]), c, place.t[k])
        assert angle_between(point, direction) < 1e-6


def along(start, end, share):
    angle = angle_between(start, end)
    mixed = np.sin((1 - share) * angle) * start + np.sin(share * angle) * end
    return mixed / np.linalg.norm(mixed)


def test_directions_beyond_the_rim_find_its_nearest_point():
    mesh = triangulate(around())
    place = locate(mesh, from_degrees(np.array([88.0]), np.array([18.0])))
    assert place.on_edge[0]
    theta = np.degrees(np.arccos(place.found[0, 2]))
    assert 78 < theta < 81


def test_an_arc_is_followed():
    mesh = arc_mesh(np.radians([0.0, 20, 50]))
    place = locate(mesh, from_degrees(np.array([10.0, 35, 70]), np.zeros(3)))
    assert place.simplex.tolist() == [0, 1, 1]
    assert place.s == pytest.approx([0.5, 0.5, 1.0])


def test_directions_in_a_plane_make_no_triangles():
    with pytest.raises(InputError, match="one plane"):
        triangulate(from_degrees(np.array([0.0, 30, 60]), np.zeros(3)))


@pytest.mark.parametrize(
    ("directions", "symmetry"),
    [
        (rings(azimuths_deg=[30]), "isotropic"),
        (quarter_circle(), "quadrilateral"),
        (half_circle(), "bilateral-x"),
        (half_circle()[:, [1, 0, 2]], "bilateral-y"),
        (around(), "none"),
        (rings(azimuths_deg=[0, 90]), "quadrilateral"),
        (rings(azimuths_deg=[90, 270]), "bilateral-x"),
    ],
)
def test_symmetry_follows_from_the_directions_measured(directions, symmetry):
    assert deduce_symmetry(directions) == symmetry


def test_quadrants_that_do_not_touch_are_refused():
    with pytest.raises(InputError, match="0–90°, 180–270°"):
        deduce_symmetry(rings(azimuths_deg=[45, 225]))


@given(
    st.sampled_from(["quadrilateral", "bilateral-x", "bilateral-y", "rotational"]),
    st.floats(0, 89),
    st.floats(0, 360),
)
@settings(max_examples=60)
def test_folding_is_one_of_the_images(symmetry, theta, phi):
    direction = from_degrees(theta, phi)
    folded, matrix = fold(direction[None], symmetry, np.array([1.0, -1.0]))
    assert any(np.allclose(matrix[0], np.diag(image)) for image in images(symmetry))
    assert np.allclose(matrix[0] @ folded[0], direction)
    if symmetry in ("quadrilateral", "bilateral-x"):
        assert folded[0, 0] >= 0
    if symmetry in ("quadrilateral", "bilateral-y", "rotational"):
        assert folded[0, 1] <= 0
