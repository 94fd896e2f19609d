"""Faces of panes modelled as solids or as parallel faces."""

import numpy as np
import pytest

from clerestory.scene.model import Polygon
from clerestory.scene.solid_panes import edges_of_panes, faces_behind_others
from clerestory.scene.window import window_of

THICK = 0.006


def solid(size=(2.0, THICK, 1.5), at=(0.0, 0.0, 0.0)):
    """Faces of a box, fronts outwards: front (−y), back (+y), and four edges."""
    x, y, z = size
    quads = (
        ((0, 0, 0), (x, 0, 0), (x, 0, z), (0, 0, z)),
        ((0, y, 0), (0, y, z), (x, y, z), (x, y, 0)),
        ((0, 0, 0), (0, 0, z), (0, y, z), (0, y, 0)),
        ((x, 0, 0), (x, y, 0), (x, y, z), (x, 0, z)),
        ((0, 0, 0), (0, y, 0), (x, y, 0), (x, 0, 0)),
        ((0, 0, z), (x, 0, z), (x, y, z), (0, y, z)),
    )
    return [np.array(quad, float) + np.array(at) for quad in quads]


def in_triangles(faces):
    return [face[list(corner)] for face in faces for corner in ((0, 1, 2), (0, 2, 3))]


def windows(faces):
    """Windows whose normals are +y."""
    turned = [f if _normal(f)[1] > 0 else f[::-1] for f in faces]
    return [window_of((Polygon(face, "glass"),), name="w") for face in turned]


def _normal(face):
    return np.cross(face[1] - face[0], face[2] - face[0])


def test_four_faces_of_a_box_are_edges():
    expected = [False, False, True, True, True, True]
    assert edges_of_panes(solid()).tolist() == expected
    triangles = edges_of_panes(in_triangles(solid()))
    assert triangles.tolist() == np.repeat(expected, 2).tolist()


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0])
def test_edges_are_found_in_any_direction(angle):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    tilt = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    faces = [face @ (turn @ tilt).T + 100 for face in solid()]
    assert edges_of_panes(faces).tolist() == [False] * 2 + [True] * 4


def test_faces_of_thick_boxes_and_of_a_glazed_corner_are_no_edges():
    """A box of 0.2 m is a room of glass; panes of 2 m and 0.08 m meet at a corner."""
    assert not edges_of_panes(solid(size=(2.0, 0.2, 1.5))).any()
    main = np.array([[0, 0, 0], [2, 0, 0], [2, 0, 1.5], [0, 0, 1.5]], float)
    side = np.array([[2, 0, 0], [2, 0.08, 0], [2, 0.08, 1.5], [2, 0, 1.5]], float)
    assert not edges_of_panes([main, side]).any()
    assert edges_of_panes([]).tolist() == []


def test_the_face_towards_the_room_remains():
    """The room is towards +y: of two boxes, 24 mm apart, the last back face."""
    faces = [*solid()[:2], *solid(at=(0, 0.018, 0))[:2]]
    assert faces_behind_others(windows(faces)).tolist() == [True, True, True, False]
    triangles = in_triangles(faces[2:])
    # The other diagonal on the side of the room
    triangles[2:] = [faces[3][[0, 1, 3]], faces[3][[1, 2, 3]]]
    assert faces_behind_others(windows(triangles)).tolist() == [True] * 2 + [False] * 2


@pytest.mark.parametrize(
    ("shift", "behind"),
    [((0, 0.05, 0), True), ((1.5, 0.05, 0), False), ((0, 0.2, 0), False)],
)
def test_sliding_sashes_and_distant_panes_remain(shift, behind):
    """Faces belong together if half of one is covered within 0.1 m."""
    face = solid()[1]
    found = faces_behind_others(windows([face, face + np.array(shift)]))
    assert found.tolist() == [behind, False]
