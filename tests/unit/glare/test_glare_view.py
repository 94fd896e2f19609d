"""Solid angles and cosines of pixels, against closed forms."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.glare.glare_view import glare_view, pixel_pitch
from clerestory.glare.pixel_rays import pixel_rays, quadrilaterals
from clerestory.radiance.view_text import parse_view
from clerestory.scene.view import View, solid_angles

WHOLE = ["-vta -vh 180 -vv 180", "-vth -vh 180 -vv 180", "-vta -vh 220 -vv 220"]
PARTS = [
    "-vtv -vh 90 -vv 60",
    "-vtv -vh 60 -vv 60 -vs .4 -vl -.3",
    "-vts -vh 100 -vv 100",
    "-vtc -vh 150 -vv 70",
    "-vta -vh 80 -vv 50 -vs .6 -vl .5",
    "-vth -vh 60 -vv 60",
]


@pytest.mark.parametrize("text", WHOLE)
def test_a_uniform_hemisphere_lights_the_eye_with_pi(text):
    """E = πL. A hemispherical view loses the pixels that its rim cuts."""
    eye = glare_view(parse_view(text), 400, 400)
    assert eye.eye_weight.sum() == pytest.approx(np.pi, rel=0.01)
    lost = 0.1 if text.startswith("-vth") else 0.01
    assert eye.total_solid_angle == pytest.approx(2 * np.pi, rel=lost)


@pytest.mark.parametrize("text", PARTS)
def test_solid_angles_are_those_of_the_exact_integrals(text):
    view = parse_view(text)
    columns, rows = view.size_for(200)
    found = glare_view(view, columns, rows).solid_angle
    exact = solid_angles(view, columns, rows)
    seen = found > 0
    assert seen.mean() > 0.9
    assert np.allclose(found[seen], exact[seen], rtol=2e-3)


def test_directions_are_those_of_the_view():
    view = parse_view("-vta -vd 1 2 -.5 -vu 0 0 1 -vh 140 -vv 100 -vs .1 -vl .2")
    columns, rows = view.size_for(90)
    found = glare_view(view, columns, rows).direction
    assert np.abs(found - view.rays(columns, rows).direction).max() < 1e-12


def test_nothing_behind_the_eye_counts():
    eye = glare_view(View(kind="angular", horizontal=360, vertical=360), 100, 100)
    assert eye.total_solid_angle == pytest.approx(2 * np.pi, rel=0.05)


def test_guths_field_of_view_is_narrow_above_and_wide_below():
    eye = glare_view(View(kind="angular", horizontal=180, vertical=180), 180, 180)
    total, both = eye.in_field("total"), eye.in_field("binocular")
    middle = 90
    # 60° upwards by the brow, about 70° downwards by the cheek
    assert total[middle - 58, middle]
    assert not total[middle - 64, middle]
    assert total[middle + 66, middle]
    assert not total[middle + 70, middle]
    assert both[middle - 58, middle]
    assert not both[middle - 64, middle]


def test_a_parallel_view_is_refused():
    with pytest.raises(InputError, match="parallel view have no solid angles"):
        glare_view(View(kind="parallel", horizontal=2, vertical=2), 100, 100)


def test_a_tiny_picture_is_refused():
    with pytest.raises(InputError, match="20 × 20 pixels; at least 21"):
        glare_view(View(), 20, 20)


def test_views_that_differ_only_in_place_share_their_pixels():
    here = View(
        kind="angular", position=np.array([1.0, 2, 3]), horizontal=90, vertical=90
    )
    there = View(kind="angular", horizontal=90, vertical=90)
    assert glare_view(here, 50, 50) is glare_view(there, 50, 50)


@pytest.mark.parametrize("kind", ["angular", "hemispherical", "perspective"])
def test_blocks_of_rows_make_up_the_whole_picture(kind):
    """To the last bit, on which the number of sources may hang."""
    size = 180 if kind != "perspective" else 80
    view = View(kind=kind, horizontal=size, vertical=size)
    whole = quadrilaterals(view, 90, 90)
    rays = pixel_rays(view, 90, 90)
    for some in (slice(0, 1), slice(7, 40), slice(89, 90)):
        np.testing.assert_array_equal(quadrilaterals(view, 90, 90, some), whole[some])
        part = pixel_rays(view, 90, 90, some)
        np.testing.assert_array_equal(part.direction, rays.direction[some])


def test_neighbouring_pixels_are_apart_by_the_slope_of_the_picture():
    """In an angular fisheye a degree along a radius, sin σ / σ of it across."""
    eye = glare_view(View(kind="angular", horizontal=180, vertical=180), 180, 180)
    pitch, sigma = pixel_pitch(eye.direction), eye.sigma
    part = np.s_[20:80, 100:160]
    np.testing.assert_allclose(np.degrees(pitch.most[part]), 1, rtol=1e-3)
    expected = np.sin(sigma[part]) / sigma[part]
    np.testing.assert_allclose(np.degrees(pitch.least[part]), expected, rtol=1e-3)
