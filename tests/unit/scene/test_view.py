"""Views: closed forms of solid angles, both ways between pixels and directions."""

import contextlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.radiance.view_text import format_view, parse_view, read_view
from clerestory.scene.view import View, solid_angles

KINDS = {
    "perspective": (90, 60),
    "hemispherical": (180, 180),
    "angular": (360, 360),
    "planisphere": (270, 200),
    "cylindrical": (360, 90),
}


def oblique(kind, **more):
    horizontal, vertical = KINDS[kind]
    return View(
        kind=kind,
        position=np.array([1.0, -2.0, 1.5]),
        direction=np.array([1.0, 2.0, 0.3]),
        up=np.array([0.1, 0.0, 1.0]),
        **{"horizontal": horizontal, "vertical": vertical, **more},
    )


WHOLE = {
    # a pyramid of tangents a and b: 4 atan(ab/√(1+a²+b²))
    "perspective": 4 * np.arctan2(np.tan(np.pi / 6), np.sqrt(2 + 1 / 3)),
    "hemispherical": 2 * np.pi,
    "angular": 4 * np.pi,
    # a band of the sphere up to 45° of altitude
    "cylindrical": 4 * np.pi * np.sin(np.pi / 4),
}


@pytest.mark.parametrize("kind", WHOLE)
@pytest.mark.parametrize("size", [1, 7, 200])
def test_solid_angles_fill_the_view(kind, size):
    total = solid_angles(oblique(kind), size, size + 1).sum()
    # The angular view's rim, where θ = π, is cut by quadrature only
    tolerance = {1: 0.1, 7: 1e-3, 200: 1e-6}[size] if kind == "angular" else 1e-9
    assert total == pytest.approx(WHOLE[kind], rel=tolerance)


def test_half_an_angular_view_within_its_circle_is_a_hemisphere():
    view = oblique("angular", horizontal=180, vertical=180)
    angles = solid_angles(view, 1000, 1000)
    cosine = view.rays(1000, 1000).direction @ view.direction
    assert angles[cosine > 0].sum() == pytest.approx(2 * np.pi, rel=1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_a_pixel_s_solid_angle_is_the_area_its_directions_cover(kind):
    """Against the Jacobian of the rays, by finite differences, integrated."""
    view = oblique(kind, shift=0.1, lift=-0.2)
    columns, rows = 9, 6
    angles = solid_angles(view, columns, rows)

    def density(x, y, step=1e-5):
        corners = np.array([[-1, 0], [1, 0], [0, -1], [0, 1]]) * step
        jitter = np.full((4, rows, columns, 2), 0.5)
        jitter[:] = np.array([x, y]) + corners[:, None, None, :]
        a, b, c, d = (view.rays(columns, rows, j).direction[2, 4] for j in jitter)
        return np.linalg.norm(np.cross(b - a, d - c)) / (4 * step**2)

    node, weight = np.polynomial.legendre.leggauss(6)
    node, weight = (node + 1) / 2, weight / 2
    area = sum(
        wx * wy * density(x, y)
        for x, wx in zip(node, weight, strict=True)
        for y, wy in zip(node, weight, strict=True)
    )
    assert angles[2, 4] == pytest.approx(area, rel=1e-5)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_pixels_and_directions_are_each_other_s_inverse(kind, offset):
    # Narrow enough that no direction appears twice
    narrow = {"horizontal": 200.0} if kind == "cylindrical" else {}
    view = oblique(kind, shift=offset, lift=-offset, **narrow)
    rays = view.rays(20, 15)
    found = view.pixel(rays.direction[rays.valid], columns=20, rows=15)
    row, column = np.nonzero(rays.valid)
    assert np.allclose(found, np.column_stack([row, column]) + 0.5, atol=1e-9)


def test_points_are_found_where_parallel_rays_start():
    view = View(kind="parallel", direction=np.array([1.0, 1, -1]), horizontal=6)
    rays = view.rays(12, 8)
    points = rays.origin + 5 * rays.direction
    found = view.pixel_of_point(points, columns=12, rows=8)
    row, column = np.indices((8, 12))
    assert np.allclose(found, np.stack([row, column], axis=-1) + 0.5)
    assert np.isnan(view.pixel(view.direction, columns=12, rows=8)).all()
    assert not solid_angles(view, 12, 8).any()


def test_nothing_behind_is_found_in_front():
    behind = -View().direction
    for kind in ("perspective", "hemispherical", "planisphere"):
        view = View(kind=kind)
        assert np.isnan(view.pixel(behind, columns=4, rows=4)).all()


def test_behind_an_angular_view_lies_its_rim():
    view = View(kind="angular", horizontal=360, vertical=360)
    row, column = view.pixel(-view.direction, columns=100, rows=100)
    assert np.hypot(row - 50, column - 50) == pytest.approx(50)


def test_jitter_moves_rays_right_and_up():
    view = View()
    jitter = np.zeros((4, 4, 2))
    jitter[..., 0] = 1
    corner = view.rays(4, 4, jitter)
    # The lower right corner of pixel (1, 1) is the middle of the picture
    assert np.allclose(corner.direction[1, 1], view.direction)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"kind": "fisheye"}, "one of perspective"),
        ({"horizontal": 180.0}, "horizontal size of the perspective view is 180"),
        ({"kind": "hemispherical", "vertical": 181.0}, "between 0 and 180 expected"),
        ({"kind": "parallel", "horizontal": 0.0}, "a number between 0 and inf"),
        ({"up": np.array([0.0, 5.0, 0.0])}, "parallel to its direction"),
        ({"direction": np.zeros(3)}, "zero or not finite"),
        ({"position": np.array([0.0, np.nan, 0.0])}, "three finite numbers"),
        ({"fore": -1.0}, "behind its position"),
        ({"fore": 2.0, "aft": 1.0}, "beyond its fore"),
        ({"shift": np.inf}, "shift is inf"),
    ],
)
def test_views_that_cannot_be_are_refused(changes, words):
    with pytest.raises(InputError, match=words):
        View(**changes)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("-vtx", "unknown view type"),
        ("-vp 1 2", "-vp without 3 numbers"),
        ("-vh wide", "-vh without 1 number"),
        ("-vz 3", "unknown view option"),
        ("-vta -vh 361", "between 0 and 360"),
    ],
)
def test_broken_options_are_refused(text, words):
    with pytest.raises(InputError, match=words):
        parse_view(text)


def test_other_options_are_passed_over():
    view = parse_view("rpict -av .1 .1 .1 -x 800 -vf some.vf -vta -ab 2 -vh 180 -w")
    assert (view.kind, view.horizontal, view.vertical) == ("angular", 180, 45)


def test_a_view_file_s_last_state_counts_and_lines_add_up(tmp_path):
    file = tmp_path / "a.vf"
    file.write_text("# walk\nrvu -vtv -vp 1 2 3 -vd 1 0 0\n/bin/rpict -vp 4 5 6\n")
    view = read_view(file)
    assert view.position.tolist() == [4, 5, 6]
    assert view.direction.tolist() == [1, 0, 0]


def test_a_file_without_a_view_is_refused(tmp_path):
    (tmp_path / "a.vf").write_text("hello\n")
    with pytest.raises(InputError, match=r"a\.vf: no view"):
        read_view(tmp_path / "a.vf")
    (tmp_path / "b.vf").write_text("\nrvu -vp 1 x 2\n")
    with pytest.raises(InputError, match=r"b\.vf:2: view option -vp"):
        read_view(tmp_path / "b.vf")


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(tmp_path_factory, data):
    file = tmp_path_factory.getbasetemp() / "fuzz.vf"
    file.write_bytes(b"rvu -vt" + data)
    with contextlib.suppress(InputError):
        read_view(file)


@pytest.mark.parametrize("kind", [*KINDS, "parallel"])
def test_text_keeps_the_view(kind):
    view = View(kind=kind, position=np.array([0.1, -123.456789, 1e-3]), shift=0.25)
    again = parse_view(format_view(view))
    assert again.kind == kind
    assert np.allclose(again.position, view.position, rtol=1e-8)
    assert again.shift == 0.25


@pytest.mark.parametrize("name", ["in.vf", "skyUp.vf", "bsdf.vf"])
def test_the_tutorial_s_views_are_read(name, shared_data):
    view = read_view(shared_data / "tutorial_room" / "views" / name)
    assert np.linalg.norm(view.direction) == pytest.approx(1)
