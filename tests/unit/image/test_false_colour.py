"""False colour: scales, the colours of pixels, contours, legend."""

import matplotlib as mpl
import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.image.colour_scale import (
    ColourScale,
    linear_scale,
    logarithmic_scale,
    round_up,
)
from clerestory.image.false_colour import false_colour
from clerestory.image.legend import legend, value_word
from clerestory.image.picture import Picture


def grey(luminance, **more):
    values = np.asarray(luminance, dtype=np.float32) / 179
    return Picture(np.repeat(values[..., None], 3, axis=-1), **more)


def ramp(count=101, rows=60):
    return grey(np.tile(np.linspace(0, 100, count), (rows, 1)))


def palette(name, place):
    return np.round(255 * np.array(mpl.colormaps[name](place)[:3]))


def test_ends_and_middle_have_the_palette_s_colours():
    scale = linear_scale(ramp(), largest=100, palette="viridis")
    pixels = false_colour(ramp(), scale, with_legend=False)
    for column in (0, 50, 100):
        expected = palette("viridis", column / 100)
        assert np.abs(pixels[0, column] - expected).max() <= 2


def test_a_logarithmic_scale_halves_decades():
    scale = logarithmic_scale(ramp(), largest=100, decades=2)
    assert scale.place(np.array([0.1, 1, 10, 100])).tolist() == pytest.approx(
        [0, 0, 0.5, 1]
    )
    assert scale.levels == pytest.approx((1, 2, 5, 10, 20, 50, 100))


def test_automatic_scales_cover_nearly_all_pixels():
    for scale in (linear_scale(ramp()), logarithmic_scale(ramp())):
        assert scale.largest >= 99.5
        assert scale.levels[0] == scale.smallest
        assert scale.levels[-1] == pytest.approx(scale.largest)
    dark = grey(np.zeros((3, 3)))
    assert linear_scale(dark).largest > 0
    assert logarithmic_scale(dark).largest == 1


def test_round_up_finds_the_next_of_1_2_5():
    found = [round_up(x) for x in (0.11, 0.2, 3, 5.1, 1000)]
    assert found == pytest.approx([0.2, 0.2, 5, 10, 1000])


def test_steps_are_flat_between_levels():
    scale = linear_scale(ramp(), largest=100, divisions=4)
    pixels = false_colour(ramp(), scale, style="steps", with_legend=False)
    assert (pixels[0, 1:24] == pixels[0, 1]).all()
    assert (pixels[0, 24] != pixels[0, 26]).any()


@pytest.mark.parametrize("style", ["lines", "bands"])
def test_contours_lie_at_levels(style):
    """Colour appears only near 25, 50 and 75 in a grey ramp."""
    picture = ramp(count=201)
    scale = linear_scale(picture, largest=100, divisions=4)
    pixels = false_colour(picture, scale, style=style, with_legend=False).astype(int)
    colourful = np.flatnonzero(np.ptp(pixels[30], axis=-1) > 40)
    distance = np.abs(colourful[:, None] / 2 - [0, 25, 50, 75, 100]).min(axis=1)
    assert set(np.round(colourful / 50).astype(int)) >= {1, 2, 3}
    assert distance.max() <= 3


def test_extremes_are_marked_where_they_are():
    values = np.full((90, 120), 10.0)
    values[20, 30], values[70, 90] = 500, 1
    picture = grey(values)
    scale = linear_scale(picture, largest=100)
    plain = false_colour(picture, scale, with_legend=False).astype(int)
    marked = false_colour(picture, scale, extremes=True, with_legend=False).astype(int)
    changed = np.abs(marked - plain).sum(axis=2) > 0
    assert changed[10:30, 20:40].any()
    assert changed[60:80, 80:100].any()
    assert not changed[40:55, :].any()


def test_pixels_outside_the_view_are_black():
    from clerestory.scene.view import View

    view = View(kind="hemispherical", horizontal=180, vertical=180)
    picture = grey(np.full((40, 40), 50.0), view=view)
    pixels = false_colour(picture, linear_scale(picture), with_legend=False)
    assert not pixels[0, 0].any()
    assert pixels[20, 20].any()


@pytest.mark.parametrize("rows", [1, 30, 400])
def test_a_legend_stands_beside_pictures_of_any_size(rows):
    picture = ramp(rows=rows)
    pixels = false_colour(picture, linear_scale(picture), style="lines")
    assert pixels.shape[0] >= rows
    assert pixels.shape[1] > picture.columns + 40


def test_the_legend_shows_the_whole_palette():
    scale = ColourScale(0, 100, (0, 50, 100), "lux", palette="viridis")
    pixels = legend(scale, height=400)
    bar = pixels[:, 20]
    for place in (0, 0.5, 1):
        distance = np.abs(bar - palette("viridis", place)).sum(axis=1)
        assert distance.min() < 12


def test_numbers_of_legends_are_short():
    found = [value_word(x) for x in (0, 0.25, 1, 2000)]
    assert found == ["0", "0.25", "1", "2\u2009000"]


@pytest.mark.parametrize(
    ("work", "words"),
    [
        (lambda: ColourScale(5, 5, (1, 2)), "from 5 to 5; a smallest value below"),
        (lambda: ColourScale(0, 5, (1, 2), logarithmic=True), "above 0"),
        (lambda: ColourScale(0, 5, (1, 2), palette="rainbows"), "colour map"),
        (lambda: ColourScale(0, 5, (2, 1)), "levels"),
        (lambda: linear_scale(ramp(), divisions=0), "divisions"),
        (lambda: logarithmic_scale(ramp(), decades=0), "decades"),
        (lambda: logarithmic_scale(ramp(), largest=-1), "positive number"),
    ],
)
def test_scales_that_cannot_be_are_refused(work, words):
    with pytest.raises(InputError, match=words):
        work()
