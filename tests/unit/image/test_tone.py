"""Tone mappings: fixed points, order, visibility, veiling glare."""

import numpy as np
import pytest

from clerestory.errors import InputError, OutputError
from clerestory.image.picture import Picture
from clerestory.image.srgb_display import to_srgb, write_display
from clerestory.image.tone_curves import filmic, key_luminance, linear
from clerestory.image.veiling_glare import foveal_view, with_veil
from clerestory.image.visibility_matching import Screen, human_vision, threshold
from clerestory.scene.view import View


def grey(luminance, **more):
    """A grey picture of luminances [cd/m²]."""
    values = np.asarray(luminance, dtype=np.float32) / 179
    return Picture(np.repeat(values[..., None], 3, axis=-1), **more)


def ramp(low, high, count=4000, rows=20):
    return grey(np.tile(np.geomspace(low, high, count), (rows, 1)))


def test_white_is_shown_white_and_nothing_black():
    picture = grey([[0, 50, 100, 200]])
    assert linear(picture, white=100)[0, :, 1] == pytest.approx([0, 0.5, 1, 2])


def test_automatic_exposure_shows_the_log_average_as_18_percent():
    picture = grey([[1, 100]])
    assert key_luminance(picture) == pytest.approx(10 / 0.18, rel=1e-5)
    assert key_luminance(grey([[0, 0]])) == 1


def test_the_film_s_curve_begins_black_rises_and_ends_white():
    """Hable's white point: 11.2 before the curve, which an exposure of 2 precedes."""
    shown = filmic(grey([np.linspace(0, 5.6, 500)]), white=1.0)[0, :, 1]
    assert shown[0] == pytest.approx(0, abs=1e-6)
    assert shown[-1] == pytest.approx(1, rel=1e-4)
    assert (np.diff(shown) > 0).all()


@pytest.mark.parametrize("mapping", [linear, filmic])
def test_a_white_that_is_none_is_refused(mapping):
    for white in (0, -1, np.inf, np.nan):
        with pytest.raises(InputError, match="luminance of white is"):
            mapping(grey([[1.0]]), white=white)


def test_srgb_is_that_of_the_standard():
    """IEC 61966-2-1: 0.0031308 and 18 % grey; white stays white."""
    display = np.repeat(np.array([[[0.0031308], [0.18], [2.0]]]), 3, axis=2)
    assert to_srgb(display)[0].tolist() == [[10] * 3, [118] * 3, [255] * 3]


def test_display_files_are_written(tmp_path):
    pixels = np.zeros((3, 4, 3), dtype=np.uint8)
    for name, magic in (("a.png", b"\x89PNG"), ("a.jpg", b"\xff\xd8"), ("a.JPEG", b"")):
        write_display(pixels, tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(magic)
    with pytest.raises(InputError, match=r"\.png"):
        write_display(pixels, tmp_path / "a.hdr")
    with pytest.raises(OutputError):
        write_display(pixels, tmp_path / "nowhere" / "a.png")


def test_thresholds_are_ferwerda_s():
    """Weber's law above 80 cd/m²: 10^-1.255; absolute threshold 10^-2.86."""
    assert threshold(1000.0) == pytest.approx(1000 * 10**-1.255)
    assert threshold(1e-6) == pytest.approx(10**-2.86)
    for end in (-3.94, -1.44, -0.0184, 1.9):
        below, above = threshold(10 ** (end - 1e-6)), threshold(10 ** (end + 1e-6))
        assert below == pytest.approx(above, rel=0.03)


def slopes(shown, luminance):
    """Steepness of the mapping between logarithms, away from black."""
    lit = shown > 0.02
    return np.diff(np.log(shown[lit] * 99 + 1)) / np.diff(np.log(luminance[lit]))


def test_no_contrast_is_exaggerated():
    """Two patches of similar luminance, far apart: naive equalisation would split
    each over half of the screen's range."""
    low = np.geomspace(1, 1.2, 4000)
    values = np.concatenate([low, low * 1e5])
    picture = grey(np.tile(values, (10, 1)))
    for sensitive in (False, True):
        shown = human_vision(picture, contrast_sensitivity=sensitive)[0, :, 1]
        assert (np.diff(shown) >= -1e-6).all()
        steepest = np.percentile(slopes(shown[4000:], values[4000:]), 90)
        assert steepest < 1.1


def test_what_the_eye_cannot_see_is_not_shown():
    """At 1 mcd/m² a step of 10 % lies far below threshold; shown steps do too."""
    values = np.geomspace(1e-3, 1e3, 4000)
    shown = human_vision(grey(np.tile(values, (10, 1))), colour_loss=False)[0, :, 1]
    on_screen = shown * 99 + 1
    dark = values < 1e-2
    seen = np.diff(on_screen[dark]) / threshold(on_screen[dark][:-1])
    in_scene = np.diff(values[dark]) / threshold(values[dark][:-1])
    assert (seen <= in_scene * 1.3 + 1e-9).all()


def test_a_scene_that_fits_the_screen_is_mapped_straight():
    picture = ramp(20, 60)
    shown = human_vision(picture)[0, :, 1]
    ratio = shown / picture.luminance()[0]
    assert np.ptp(ratio) < 1e-5 * ratio.mean()


def test_darkness_has_no_colour():
    blue = np.array([0.0, 0.0, 1.0], dtype=np.float32)
    dark = Picture(np.full((4, 4, 3), 1e-5, dtype=np.float32) * blue)
    red, green, blue_shown = human_vision(dark)[0, 0]
    assert red == pytest.approx(green)
    assert red == pytest.approx(blue_shown)
    coloured = human_vision(dark, colour_loss=False)[0, 0]
    assert coloured[0] == 0
    assert coloured[2] > 0


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_flat_pictures_are_mapped(value):
    shown = human_vision(grey(np.full((5, 6), value)))
    assert np.isfinite(shown).all()
    assert shown.std() == pytest.approx(0, abs=1e-6)


def test_a_screen_without_range_is_refused():
    with pytest.raises(InputError, match="contrast above 1"):
        Screen(contrast=1.0)


def test_a_view_in_degrees():
    """2 tan 30° over one degree; and 40° by default."""
    foveal = foveal_view(grey(np.ones((300, 300)), view=View(horizontal=60)))
    assert foveal.columns == round(2 * np.tan(np.radians(30)) / np.radians(1))
    untold = foveal_view(grey(np.ones((150, 300))))
    assert untold.view.horizontal == pytest.approx(40)


def test_a_veil_over_a_uniform_view_changes_nothing():
    view = View(kind="angular", horizontal=90, vertical=90)
    picture = grey(np.full((100, 100), 30.0), view=view)
    assert with_veil(picture).luminance() == pytest.approx(30, rel=1e-5)


def test_a_point_is_scattered_as_cos_theta_over_theta_squared():
    view = View(kind="angular", horizontal=80, vertical=80)
    values = np.zeros((81, 81))
    values[40, 40] = 1e6
    veil = with_veil(grey(values, view=view)).luminance()[40]
    # 10 and 30 pixels off the middle; normalised by nearly the same sum
    theta = np.radians(80 / 81) * np.array([10, 30])
    expected = np.cos(theta) / (2 * (1 - np.cos(theta)))
    ratio = veil[50] / veil[70]
    assert ratio == pytest.approx(expected[0] / expected[1], rel=0.25)
