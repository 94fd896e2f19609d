"""The data of the 3-D view: edges where surfaces end or turn, nothing else."""

import base64
import gzip

import numpy as np

from clerestory.report.colour import illuminance_scale
from clerestory.report.content_from_results import from_results
from clerestory.report.mesh_lines import feature_edges, weld
from clerestory.report.room_view import (
    MOST_TRIANGLES,
    framed_box,
    largest_triangles,
    room_view,
)


def test_a_box_has_twelve_edges_and_eight_corners(room):
    vertices, faces = weld(np.array(room.box((0, 0, 0), (1, 2, 3))))
    assert len(vertices) == 8
    edges = feature_edges(vertices, faces)
    assert len(edges) == 12
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    assert np.isclose(length.sum(), 4 * (1 + 2 + 3))


def test_an_open_square_has_its_rim(room):
    vertices, faces = weld(
        np.array(room.quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)))
    )
    edges = feature_edges(vertices, faces)
    assert len(edges) == 4
    assert np.array_equal(edges[:, 2], edges[:, 3])


def test_no_faces_have_no_edges():
    assert feature_edges(np.zeros((0, 3)), np.zeros((0, 3), int)).shape == (0, 4)


def test_crowded_scenes_lose_their_smallest_triangles():
    size = np.arange(1, MOST_TRIANGLES + 101) / MOST_TRIANGLES
    corners = np.zeros((len(size), 3, 3))
    corners[:, 1, 0] = corners[:, 2, 1] = size
    kept = largest_triangles(corners)
    assert np.array_equal(kept, np.arange(100, len(size)))


def test_triangles_without_area_are_left_out():
    assert len(largest_triangles(np.zeros((3, 3, 3)))) == 0


def test_the_view_frames_the_room_of_the_sensors(room):
    """The ground of 80 m around the room is not part of it."""
    content = from_results(room.analytic_results(times=room.year(days=1)))
    low, high = framed_box(content)
    assert np.allclose(low, [0, 0, 0], atol=1e-6)
    assert np.allclose(high, [room.WIDTH, room.DEPTH, room.HEIGHT], atol=1e-6)


def test_packed_triangles_are_those_of_the_scene(room):
    content = from_results(room.analytic_results(times=room.year(days=1)))
    means = np.full(81, 500.0)
    data = room_view(content, means=means, scale=illuminance_scale(means))

    def unpacked(name, kind):
        return np.frombuffer(gzip.decompress(base64.b64decode(data[name])), kind)

    vertices = unpacked("vertices", "<f4").reshape(-1, 3)
    corners = vertices[unpacked("faces", "<u4").reshape(-1, 3)]
    assert np.allclose(corners, content.room.corners, atol=1e-4)
    assert unpacked("edges", "<u4").max() < max(len(vertices), len(corners))
