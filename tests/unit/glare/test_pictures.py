"""Pictures that are not what they seem, and glare over a year of pictures."""

from dataclasses import replace

import numpy as np
import pytest
from glare_rooms import FISHEYE, SIZE, eye, picture, room

from clerestory.errors import InputError
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.check_picture import check_picture
from clerestory.glare.evaluate import evaluate_glare
from clerestory.glare.luminance_statistics import band, region_statistics
from clerestory.glare.sources import find_sources
from clerestory.scene.view import View


def window():
    luminance = room()
    luminance[40:60, 20:50] = 6000.0 + np.arange(30)
    return luminance


def test_illuminances_of_a_picture_add_up():
    result = evaluate_glare(picture(window()))
    weight = eye().eye_weight
    assert result.illuminance == pytest.approx((weight * window()).sum(), rel=1e-5)
    # What is no source has 100 cd/m² everywhere
    bright = weight[40:60, 20:50].sum()
    assert result.background == pytest.approx(100 * (weight.sum() - bright) / np.pi)
    by_mean = evaluate_glare(picture(window()), background="average")
    assert by_mean.background == pytest.approx(100, rel=1e-4)


def test_a_measured_illuminance_makes_the_dgp_only():
    plain = evaluate_glare(picture(window()))
    given = evaluate_glare(picture(window()), given_illuminance=5000.0)
    assert given.dgp != plain.dgp
    assert given.values()["ugr"] == plain.values()["ugr"]


def test_a_picture_without_a_view_is_refused():
    with pytest.raises(InputError, match="picture has no view"):
        evaluate_glare(picture(window(), view=None))


def test_pixels_must_be_square():
    with pytest.raises(InputError, match=r"1\.5 times as high as wide"):
        evaluate_glare(replace(picture(window()), pixel_aspect=1.5))
    with pytest.raises(InputError, match="180 × 100 pixels for the angular view"):
        evaluate_glare(picture(window()[:100]))


def test_a_fisheye_with_a_perspective_header_is_refused():
    view = View(horizontal=120, vertical=120)
    row, column = np.mgrid[:SIZE, :SIZE] - SIZE / 2
    dark = np.where(np.hypot(row, column) < SIZE / 2, room(), 0)
    with pytest.raises(InputError, match="100% of the corners are black"):
        evaluate_glare(picture(dark, view=view))
    assert evaluate_glare(picture(dark, view=view), trust=True).sources.count == 0


def test_an_ordinary_photograph_is_refused():
    flat = room(60)
    flat[:40] = 179.0
    with pytest.raises(InputError, match="photograph without luminance calibration"):
        evaluate_glare(picture(flat))


def test_a_denoised_picture_is_refused_without_trust():
    denoised = replace(picture(window()), header=("DENOISED= Open Image Denoise",))
    with pytest.raises(InputError, match="picture is denoised"):
        evaluate_glare(denoised)
    assert evaluate_glare(denoised, trust=True).sources.count == 1


def test_unlimited_radiance_is_refused():
    """Its luminance would be infinite in the precision of pictures."""
    spoilt = picture(window())
    spoilt.radiance[3, 4, 1] = 3e36
    with pytest.raises(InputError, match="row 3, column 4 has the radiance 3e"):
        evaluate_glare(spoilt, trust=True)


def test_negative_radiance_is_refused():
    spoilt = picture(window())
    spoilt.radiance[3, 4, 1] = -1
    with pytest.raises(InputError, match="row 3, column 4 has the radiance -1; 0 to"):
        evaluate_glare(spoilt)


def test_the_check_picture_keeps_luminances():
    plain = picture(window())
    found = find_sources(plain.luminance(), eye())
    shown = check_picture(plain, found)
    assert np.allclose(shown.luminance(), plain.luminance(), rtol=1e-5)
    assert np.ptp(shown.radiance[45, 30]) > 1
    assert np.ptp(shown.radiance[100, 100]) < 1e-5


def test_statistics_of_a_band():
    level = region_statistics(window(), eye(), band(eye(), 0.1))
    assert level.least == level.most == 100
    assert level.solid_angle == pytest.approx(
        0.2 * np.pi * np.sinc(0.1 / np.pi), rel=0.3
    )
    wide = region_statistics(window(), eye(), band(eye(), 1.0))
    assert wide.most == 6029
    with pytest.raises(InputError, match="has no pixel"):
        region_statistics(window(), eye(), np.zeros((SIZE, SIZE), bool))


def test_a_year_is_its_pictures_one_by_one():
    steps = np.stack([room(), window(), 2 * window(), room(0)])
    year = annual_glare(steps, FISHEYE)
    single = [evaluate_glare(picture(one)).dgp for one in steps[:3]]
    assert year.dgp.values[:3] == pytest.approx(single, abs=1e-5)
    assert year.source_count.values.tolist() == [0, 1, 1, 0]
    assert year.illuminance.attrs["units"] == "lux"
    assert year.source_luminance.values[2] == pytest.approx(12_000, rel=5e-3)


def test_a_year_takes_given_illuminances_and_times():
    times = np.array(["2023-01-01T09", "2023-01-01T10"], dtype="datetime64[ns]")
    lux = np.array([3000.0, 4000.0])
    steps = (one for one in (window(), window()))
    year = annual_glare(steps, FISHEYE, times=times, illuminance=lux)
    assert year.dgp.dims == ("time",)
    assert year.dgp[1] > year.dgp[0]


@pytest.mark.parametrize(
    ("steps", "options", "message"),
    [
        ([room(), room()[:100]], {}, "picture 1 has 180 × 100 pixels"),
        ([room(-1)], {}, "picture 0 has negative"),
        ([room(np.nan)], {}, "picture 0 has negative or non-finite"),
        ([], {}, "no pictures"),
        ([room()], {"times": np.arange(3)}, "3 times for 1 pictures"),
        ([room()], {"illuminance": np.ones(0)}, "0 illuminances, but more pictures"),
    ],
)
def test_years_that_do_not_fit_are_refused(steps, options, message):
    with pytest.raises(InputError, match=message):
        annual_glare(steps, FISHEYE, **options)
