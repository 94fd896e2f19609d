"""Pictures from photographs, where the truth is known because we made them."""

import contextlib
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.image.camera_response import (
    ResponseCurve,
    linear_response,
    read_response,
    recover_response,
    srgb_response,
    write_response,
)
from clerestory.image.exposure_bracket import merge_bracket
from clerestory.image.fisheye_lens import ImageCircle, Lens, reproject
from clerestory.image.photograph import Exposure, read_exposure, read_photograph
from clerestory.image.photometric_calibration import (
    calibrate,
    eye_illuminance,
    overflow,
    replace_overflow,
)
from clerestory.image.picture import Picture
from clerestory.image.vignetting import Vignetting, correct_vignetting, fit_vignetting
from clerestory.scene.view import View, solid_angles

pytest.importorskip("cv2", reason="OpenCV makes pictures of photographs")

FISHEYE = View(kind="angular", horizontal=180, vertical=180)
TIMES = [2.0**stop for stop in range(-9, 1)]


def scene(rows=96, columns=128):
    """Four decades of smooth radiance, of slightly different colours."""
    rng = np.random.default_rng(5)
    row, column = np.mgrid[:rows, :columns]
    level = 10 ** (3.6 * column / columns - 0.6 + 0.3 * np.sin(row / 9))
    colours = 1 + 0.2 * np.sin(np.array([0.0, 1.0, 2.0]) + row[..., None] / 20)
    return level[..., None] * colours * rng.uniform(0.98, 1.02, (rows, columns, 1))


def photographs(radiance, curve, times=TIMES):
    """What a camera of this response makes of the scene, with 8 bits."""
    shots = []
    for time in times:
        levels = [
            np.interp(radiance[..., c] * time, curve.exposure[:, c], np.arange(256))
            for c in range(3)
        ]
        shots.append(np.rint(np.stack(levels, axis=-1)).astype(np.uint8))
    return shots


EXPOSURES = [Exposure(time=time) for time in TIMES]


def test_a_bracket_with_its_response_gives_the_scene_back():
    truth = scene()
    merged = merge_bracket(
        photographs(truth, srgb_response()), EXPOSURES, srgb_response()
    )
    well = ~(merged.overflow | merged.underflow)
    assert well.mean() > 0.99
    error = merged.picture.radiance[well] / truth[well] - 1
    assert np.sqrt((error**2).mean()) < 0.01
    assert abs(error.mean()) < 2e-3


@pytest.mark.parametrize("method", ["debevec", "robertson"])
def test_the_response_of_the_camera_is_recovered(method):
    truth = scene()
    known = srgb_response()
    shots = photographs(truth, known)
    found = recover_response(shots, EXPOSURES, method=method)
    middle = slice(30, 230)
    ratio = found.exposure[middle] / known.exposure[middle]
    assert np.abs(np.log2(ratio)).max() < 0.2
    merged = merge_bracket(shots, EXPOSURES, found)
    ratio = merged.picture.radiance / truth
    spread = np.percentile(ratio, 95) / np.percentile(ratio, 5)
    assert spread < 1.12


def test_what_the_shortest_exposure_cannot_hold_is_reported():
    truth = 0.3 * scene()
    truth[40:44, 60:64] = 1e6
    merged = merge_bracket(
        photographs(truth, linear_response()), EXPOSURES, linear_response()
    )
    assert merged.overflow[41, 61]
    assert merged.overflow.sum() == 16
    assert merged.picture.radiance[41, 61].min() < 1e6


def test_brackets_that_do_not_fit_are_refused():
    shots = photographs(scene(), linear_response())
    with pytest.raises(InputError, match="number of photographs: 1; two or more"):
        merge_bracket(shots[:1], EXPOSURES[:1], linear_response())
    with pytest.raises(InputError, match="9 exposures for 10 photographs"):
        merge_bracket(shots, EXPOSURES[:-1], linear_response())
    with pytest.raises(InputError, match="photograph 2 has 128 × 90"):
        merge_bracket([shots[0], shots[1][:90]], EXPOSURES[:2], linear_response())
    with pytest.raises(InputError, match="less than one stop apart"):
        recover_response(shots[:2], [Exposure(time=1), Exposure(time=1)])


def test_responses_are_kept_in_files(tmp_path):
    write_response(srgb_response(), tmp_path / "camera.csv")
    again = read_response(tmp_path / "camera.csv")
    assert np.allclose(again.exposure, srgb_response().exposure, rtol=1e-7)
    # hdrgen: order, then coefficients from the highest power down
    (tmp_path / "camera.rsp").write_text("2 0.5 0.5 0\n2 1 0 0\n1 1 0\n")
    curves = read_response(tmp_path / "camera.rsp").exposure
    x = 200 / 255
    middle = 128 / 255
    assert curves[200, 0] == pytest.approx(x * (1 + x) / (middle * (1 + middle)))
    assert curves[200, 1] == pytest.approx((x / middle) ** 2)
    (tmp_path / "bad.rsp").write_text("2 1\n")
    with pytest.raises(InputError, match="not a camera response"):
        read_response(tmp_path / "bad.rsp")
    with pytest.raises(InputError, match="not finite, or not positive"):
        ResponseCurve(np.zeros((256, 3)))


def test_the_exposure_of_photographs_is_read(tmp_path):
    image = Image.new("RGB", (8, 6), (10, 20, 30))
    exif = Image.Exif()
    sub = exif.get_ifd(0x8769)
    sub[0x829A], sub[0x829D], sub[0x8827] = 0.01, 4.0, 200
    image.save(tmp_path / "shot.jpg", exif=exif)
    found = read_exposure(tmp_path / "shot.jpg")
    assert found.relative() == pytest.approx(0.01 * 2 / 16)
    assert read_photograph(tmp_path / "shot.jpg").shape == (6, 8, 3)
    image.save(tmp_path / "plain.png")
    with pytest.raises(InputError, match="EXIF data lack the time"):
        read_exposure(tmp_path / "plain.png")
    (tmp_path / "broken.jpg").write_bytes(b"\xff\xd8\xff\xe0 nothing")
    with pytest.raises(InputError, match="not a photograph"):
        read_photograph(tmp_path / "broken.jpg")


@pytest.fixture(scope="module")
def jpeg(tmp_path_factory):
    path = tmp_path_factory.mktemp("shots") / "shot.jpg"
    exif = Image.Exif()
    exif.get_ifd(0x8769)[0x829A] = 0.01
    Image.new("RGB", (8, 6), (10, 20, 30)).save(path, exif=exif)
    return path.read_bytes()


@settings(
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_damaged_photographs_are_refused_or_read(jpeg, tmp_path, data):
    spoilt = bytearray(jpeg[: data.draw(st.integers(0, len(jpeg)))])
    for place in data.draw(st.lists(st.integers(0, len(jpeg)), max_size=6)):
        if place < len(spoilt):
            spoilt[place] = data.draw(st.integers(0, 255))
    (tmp_path / "shot.jpg").write_bytes(spoilt)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for read in (read_photograph, read_exposure):
            with contextlib.suppress(InputError):
                read(tmp_path / "shot.jpg")


@settings(
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(text=st.text("0123456789.,-e \nvaluredgnb", max_size=80))
def test_damaged_responses_are_refused_or_read(tmp_path, text):
    (tmp_path / "camera.rsp").write_text(text)
    with contextlib.suppress(InputError):
        read_response(tmp_path / "camera.rsp")


@pytest.mark.parametrize(
    "lens",
    [
        Lens("equidistant"),
        Lens("equisolid"),
        Lens("stereographic"),
        Lens("polynomial", (1.0, 0.05, -0.1)),
    ],
)
def test_a_lens_image_becomes_a_true_fisheye(lens):
    """A field of known luminance by direction, drawn as the lens would draw it."""
    size, radius = 401, 200.0
    row, column = np.mgrid[:size, :size] + 0.5
    right, up = column - size / 2, size / 2 - row
    away = np.hypot(right, up)
    angles = np.linspace(0, np.pi / 2, 2001)
    theta = np.interp(away / radius, lens.radius(angles), angles)
    turn = np.arctan2(right, up)
    level = 2 + np.cos(3 * theta) + 0.5 * np.sin(theta) * np.cos(turn)
    drawn = np.where(away <= radius, level, 0)[..., None].repeat(3, axis=2)
    photo = Picture(drawn.astype(np.float32))
    circle = ImageCircle(row=size / 2, column=size / 2, radius=radius)
    seen = reproject(photo, lens, circle, view=FISHEYE, columns=150, rows=150)

    rays = FISHEYE.rays(150, 150)
    x, _, z = np.moveaxis(rays.direction, -1, 0)
    angle = np.arccos(np.clip(rays.direction @ FISHEYE.direction, -1, 1))
    truth = 2 + np.cos(3 * angle) + 0.5 * np.sin(angle) * np.cos(np.arctan2(x, z))
    inner = angle < np.radians(85)
    assert np.abs(seen.radiance[..., 0] - truth)[inner].max() < 0.02
    assert seen.radiance[0, 0, 0] == 0


def test_a_uniform_field_keeps_its_illuminance_through_a_lens():
    size = 600
    photo = Picture(np.ones((size, size, 3), np.float32))
    circle = ImageCircle(row=size / 2, column=size / 2, radius=size / 2)
    seen = reproject(
        photo, Lens("equisolid"), circle, view=FISHEYE, columns=200, rows=200
    )
    assert eye_illuminance(seen) == pytest.approx(179 * np.pi, rel=2e-3)


def test_lenses_that_cannot_be_are_refused():
    with pytest.raises(InputError, match="radius that increases"):
        Lens("polynomial", (1.0, -1.0))
    with pytest.raises(InputError, match="and only for it"):
        Lens("equisolid", (1.0,))
    with pytest.raises(InputError, match="radius of the image circle is 0 pixels"):
        ImageCircle(row=1, column=1, radius=0)


def test_vignetting_is_measured_and_put_back():
    true = Vignetting((-0.05, -0.03))
    theta = np.radians(np.arange(0, 90, 5.0))
    fitted = fit_vignetting(theta, 37 * true.passed(theta), terms=2)
    assert fitted.coefficients == pytest.approx(true.coefficients, abs=1e-9)

    rays = FISHEYE.rays(80, 80)
    angle = np.arccos(np.clip(rays.direction @ FISHEYE.direction, -1, 1))
    dimmed = true.passed(angle)[..., None].repeat(3, axis=2).astype(np.float32)
    mended = correct_vignetting(Picture(dimmed, view=FISHEYE), fitted).radiance
    assert np.allclose(mended[angle < np.pi / 2], 1, rtol=1e-5)
    with pytest.raises(InputError, match="transmission of -"):
        Vignetting((-0.9,))


def fisheye(level):
    return Picture(np.full((90, 90, 3), level / 179, np.float32), view=FISHEYE)


def test_calibration_gives_the_measured_illuminance():
    result = calibrate(fisheye(3.0), before=1000, after=1040)
    assert eye_illuminance(result.picture) == pytest.approx(1020, rel=1e-5)
    assert result.drift == pytest.approx(40 / 1020)
    assert result.picture.luminance()[45, 45] == pytest.approx(1020 / np.pi, rel=1e-2)


def test_light_that_changes_is_reported():
    with pytest.warns(ClerestoryWarning, match="changed by 67% during the bracket"):
        calibrate(fisheye(3.0), before=1000, after=2000)
    with pytest.raises(InputError, match="measured illuminance is 0 lux"):
        calibrate(fisheye(3.0), before=0, after=100)
    with pytest.raises(InputError, match="the picture is black"):
        calibrate(fisheye(0.0), before=10, after=10)


def test_a_clipped_sun_is_found_and_mended():
    """The sun gives most of the light, and the camera holds a hundredth of it."""
    truth = fisheye(500).radiance.copy()
    truth[30, 45] = 1e6 / 179
    whole = Picture(truth, view=FISHEYE)
    measured = eye_illuminance(whole)
    clipped = Picture(np.minimum(truth, 1e4 / 179), view=FISHEYE)
    with pytest.warns(ClerestoryWarning, match="are probably clipped"):
        missing = overflow(clipped, measured)
    omega = solid_angles(FISHEYE, 90, 90)[30, 45]
    sun = 1e6 * omega * np.cos(np.radians(29))
    assert missing == pytest.approx(0.99 * sun / measured, rel=0.02)
    mended = replace_overflow(clipped, measured, brightest=9e3)
    assert mended.luminance()[30, 45] == pytest.approx(1e6, rel=1e-3)
    with pytest.raises(InputError, match="no pixel of 1e\\+07"):
        replace_overflow(clipped, measured, brightest=1e7)
    with pytest.raises(InputError, match="less than the measured"):
        replace_overflow(whole, measured / 2, brightest=9e3)
