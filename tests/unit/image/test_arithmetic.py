"""Sums, cut-outs and reductions of pictures."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.image.arithmetic import (
    crop,
    masked,
    reduce,
    scale,
    weighted_sum,
    within_view,
)
from clerestory.image.picture import Picture
from clerestory.image.picture_statistics import statistics
from clerestory.scene.view import View, solid_angles

KINDS = {
    "perspective": (90, 60),
    "parallel": (6, 4),
    "hemispherical": (180, 180),
    "angular": (180, 200),
    "planisphere": (270, 200),
    "cylindrical": (300, 90),
}


def random_picture(rows=12, columns=18, **more):
    rng = np.random.default_rng(5)
    return Picture(rng.uniform(0, 9, (rows, columns, 3)).astype(np.float32), **more)


@pytest.mark.parametrize("kind", KINDS)
def test_a_cut_out_sees_what_it_saw_before(kind):
    horizontal, vertical = KINDS[kind]
    view = View(kind=kind, horizontal=horizontal, vertical=vertical, shift=0.1, fore=1)
    picture = random_picture(view=view)
    part = crop(picture, left=3, top=2, columns=7, rows=5)
    whole, cut = view.rays(18, 12), part.view.rays(7, 5)
    box = np.s_[2:7, 3:10]
    assert np.array_equal(part.radiance, picture.radiance[box])
    assert np.array_equal(cut.valid, whole.valid[box])
    assert np.allclose(cut.direction, whole.direction[box], atol=1e-12)
    assert np.allclose(cut.origin, whole.origin[box], atol=1e-12)
    angles = solid_angles(view, 18, 12)[box]
    assert np.allclose(solid_angles(part.view, 7, 5), angles, rtol=1e-6)


def test_reduction_keeps_the_mean_whatever_the_ratio():
    picture = random_picture()
    for columns, rows in [(6, 4), (5, 7), (1, 1), (18, 12), (17, 11)]:
        small = reduce(picture, columns=columns, rows=rows)
        assert small.radiance.shape == (rows, columns, 3)
        assert np.allclose(
            small.radiance.mean(axis=(0, 1)), picture.radiance.mean(axis=(0, 1))
        )


def test_reduction_to_the_same_size_changes_nothing():
    picture = random_picture()
    same = reduce(picture, columns=18, rows=12)
    assert np.allclose(same.radiance, picture.radiance, rtol=1e-6)


def test_reduction_of_one_side_makes_pixels_flat():
    small = reduce(random_picture(), columns=9, rows=12)
    assert small.pixel_aspect == pytest.approx(0.5)


def test_sums_are_weighted_and_signed():
    a, b = random_picture(), random_picture(header=("b",))
    total = weighted_sum([a, b], [3, -2])
    assert np.allclose(total.radiance, a.radiance, rtol=1e-5)
    assert np.allclose(weighted_sum([a, b]).radiance, 2 * a.radiance)
    assert np.allclose(scale(a, (1, 0, 2)).radiance, a.radiance * [1, 0, 2])


def test_masks_fill():
    picture = random_picture()
    mask = picture.luminance() > 800
    result = masked(picture, mask, fill=(1, 2, 3))
    assert np.array_equal(result.radiance[mask], picture.radiance[mask])
    assert (result.radiance[~mask] == [1, 2, 3]).all()


def test_the_disc_of_a_hemisphere_is_within_view():
    view = View(kind="hemispherical", horizontal=180, vertical=180)
    disc = within_view(random_picture(rows=200, columns=200, view=view))
    assert disc.mean() == pytest.approx(np.pi / 4, rel=1e-3)
    assert within_view(random_picture()).all()


def test_statistics_are_those_of_the_masked_pixels():
    values = np.arange(101, dtype=np.float32)[None, :, None] / 179
    picture = Picture(values * np.ones(3, dtype=np.float32))
    result = statistics(picture)
    assert (result.smallest, result.unit) == (0, "cd/m²")
    assert result.largest == pytest.approx(100, rel=1e-5)
    assert result.median == pytest.approx(50, rel=1e-5)
    assert dict(result.percentile)[90] == pytest.approx(90, rel=1e-5)
    half = statistics(picture, picture.luminance() > 49.5)
    assert half.pixels == 51
    assert half.mean == pytest.approx(75, rel=1e-5)


@pytest.mark.parametrize(
    ("work", "words"),
    [
        (lambda p: weighted_sum([]), "no pictures"),
        (lambda p: weighted_sum([p], [1, 2]), "2 weights for 1"),
        (lambda p: weighted_sum([p, random_picture(3, 3)]), "picture 2 has 3 × 3"),
        (
            lambda p: weighted_sum([p, random_picture(quantity="irradiance")]),
            "picture 2 contains irradiance",
        ),
        (lambda p: scale(p, np.nan), "finite"),
        (lambda p: crop(p, left=0, top=0, columns=19, rows=1), "within 18 × 12"),
        (lambda p: crop(p, left=0, top=0, columns=0, rows=1), "within 18 × 12"),
        (lambda p: reduce(p, columns=19, rows=1), "1 × 1 to 18 × 12"),
        (lambda p: masked(p, np.ones((2, 2), bool)), "mask has 2 × 2"),
        (lambda p: statistics(p, np.zeros((12, 18), bool)), "selects no pixel"),
    ],
)
def test_what_does_not_fit_is_refused(work, words):
    with pytest.raises(InputError, match=words):
        work(random_picture())
