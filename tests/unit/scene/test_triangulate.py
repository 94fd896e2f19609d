"""Polygons are filled by the even–odd rule, whatever their contour does."""

import numpy as np
import pytest

from clerestory.scene.triangulate import triangulate

SIZES = range(5, 40, 3)


def crossings_are_odd(contour, points):
    """Even–odd by counting the edges that a ray to +x crosses; written for the test."""
    inside = np.zeros(len(points), dtype=bool)
    for a, b in zip(contour, np.roll(contour, -1, axis=0), strict=True):
        spans = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            x = a[0] + (points[:, 1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        inside ^= spans & (points[:, 0] < x)
    return inside


def coverage(triangles, points):
    """How many triangles hold each point."""
    count = np.zeros(len(points), dtype=int)
    for a, b, c in triangles:
        sides = [
            (q[0] - p[0]) * (points[:, 1] - p[1])
            - (q[1] - p[1]) * (points[:, 0] - p[0])
            for p, q in ((a, b), (b, c), (c, a))
        ]
        count += np.all(np.array(sides) > 0, axis=0) | np.all(
            np.array(sides) < 0, axis=0
        )
    return count


def clear_of_edges(contour, points):
    """Points that rounding cannot push over an edge."""
    clear = np.ones(len(points), dtype=bool)
    for a, b in zip(contour, np.roll(contour, -1, axis=0), strict=True):
        length = np.dot(b - a, b - a)
        t = (
            np.clip((points - a) @ (b - a) / length, 0, 1)
            if length
            else 0 * points[:, 0]
        )
        clear &= np.linalg.norm(points - a - t[:, None] * (b - a), axis=1) > 1e-6
    return clear


def random_plane(rng):
    """A rotation and a shift that lift the plane z = 0 anywhere."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn, rng.normal(size=3) * 20


def check_filling(contour, rng):
    turn, shift = random_plane(rng)
    lifted = np.column_stack([contour, np.zeros(len(contour))]) @ turn + shift
    made = triangulate(lifted)
    flat = (made.vertices - shift) @ turn.T
    assert np.abs(flat[:, 2]).max() < 1e-9

    low, high = contour.min(axis=0), contour.max(axis=0)
    points = low + rng.random((400, 2)) * (high - low)
    points = points[clear_of_edges(contour, points)]
    found = coverage(flat[made.faces][:, :, :2], points)
    np.testing.assert_array_equal(found, crossings_are_odd(contour, points))

    # All fronts point where the contour's area vector points
    corner = made.vertices[made.faces]
    normals = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.cross(lifted - lifted[0], np.roll(lifted, -1, axis=0) - lifted[0]).sum(
        axis=0
    )
    assert np.all(normals @ area > 0)


def star(rng, corners, *, centre=(0.0, 0.0), radius=1.0):
    """A simple contour around a centre."""
    angle = np.sort(rng.random(corners)) * 2 * np.pi
    distance = radius * (0.4 + 0.6 * rng.random(corners))
    return np.array(centre) + distance[:, None] * np.column_stack(
        [np.cos(angle), np.sin(angle)]
    )


@pytest.mark.parametrize("corners", SIZES)
def test_simple_contours_are_filled(corners):
    rng = np.random.default_rng(corners)
    check_filling(star(rng, corners)[:: rng.choice([-1, 1])], rng)


@pytest.mark.parametrize("corners", SIZES)
def test_contours_that_cross_themselves_are_filled_by_parity(corners):
    rng = np.random.default_rng(100 + corners)
    check_filling(rng.random((corners, 2)), rng)


@pytest.mark.parametrize("seed", range(12))
def test_holes_on_seams_stay_open_however_they_are_wound(seed):
    rng = np.random.default_rng(seed)
    contour = [np.array([[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]], dtype=float)]
    for x, y in [(2, 2), (6, 2), (2, 6), (6, 6)][: rng.integers(1, 5)]:
        hole = star(rng, int(rng.integers(4, 9)), centre=(x, y), radius=1.4)
        hole = np.concatenate([hole, hole[:1]])[:: rng.choice([-1, 1])]
        contour += [hole, np.zeros((1, 2))]
    check_filling(np.concatenate(contour), rng)


def test_an_island_in_a_hole_is_filled():
    rng = np.random.default_rng(3)
    rings = [
        np.array([[-r, -r], [r, -r], [r, r], [-r, r], [-r, -r]]) for r in (4.0, 3, 2, 1)
    ]
    back = [np.array([[-r, -r]]) for r in (3.0, 2, 1)][:1]
    contour = np.concatenate(
        [rings[0], rings[1], rings[2], rings[3], rings[2][:1], *back]
    )
    check_filling(contour, rng)


def test_overlapping_squares_leave_their_overlap_open():
    one = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]], dtype=float)
    two = one + np.ones(2)
    contour = np.concatenate([one, two, one[:1]])
    check_filling(contour, np.random.default_rng(5))


def test_seams_with_different_vertices_on_the_way_cancel_too():
    contour = [(0, 0), (8, 0), (8, 8), (0, 8), (0, 0), (2, 2), (6, 2), (6, 6), (2, 6)]
    contour += [(2, 2), (1, 1)]
    check_filling(np.array(contour, dtype=float), np.random.default_rng(6))


def test_collinear_and_repeated_vertices_do_no_harm():
    contour = [(0, 0), (1, 0), (1, 0), (2, 0), (3, 0), (3, 3), (1.5, 3), (0, 3), (0, 1)]
    check_filling(np.array(contour, dtype=float), np.random.default_rng(7))


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e5])
def test_areas_are_exact_at_any_size(scale):
    contour = scale * np.array([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)], dtype=float)
    hole = scale * np.array([(1, 1), (3, 1), (3, 3), (1, 3), (1, 1)], dtype=float)
    flat = np.concatenate([contour, hole])
    made = triangulate(np.column_stack([flat, np.full(len(flat), 7.0)]))
    corner = made.vertices[made.faces]
    normals = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    assert normals.sum(axis=0)[2] == pytest.approx(12 * scale**2, rel=1e-9)


def test_the_facade_with_a_hole_wound_like_its_rim_has_its_window(shared_data):
    """Wall 6.4525 × 3.0559 m with an opening of 6.096 × 1.524 m, from the file."""
    text = (shared_data / "tutorial_room/objects/ExteriorWalls.rad").read_text().split()
    at = text.index("f_5_0")
    numbers = np.array(text[at + 4 : at + 4 + int(text[at + 3])], dtype=float)
    made = triangulate(numbers.reshape(-1, 3))
    corner = made.vertices[made.faces]
    normals = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    expected = (6.274262 + 0.178262) * 3.055937 - 6.096 * (2.4384 - 0.9144)
    assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(expected, rel=1e-12)
