"""Luminance over time, and its errors, are those of pictures and perturbed matrices."""

import itertools
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.sparse import csc_array

from clerestory.bands import RGB
from clerestory.image.camera import Camera
from clerestory.matrix.axis import pixel_axis
from clerestory.phases import picture_series, pixel_blocks
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
)
from clerestory.phases.methods import FIVE_PHASE, THREE_PHASE
from clerestory.phases.picture_series import (
    luminance_over_time,
    pictures_over_time,
    uncertain_luminance_over_time,
)
from clerestory.phases.received_sunlight import ReceivedSunlight
from clerestory.scene.view import View
from clerestory.sky.sun_matrix import SunMatrix
from phase_matrices import (
    SENSORS,
    daylight,
    transmission,
    uniform_sky,
    view,
    window_matrices,
)

CAMERA = Camera(View(kind="angular", horizontal=180, vertical=180), 10, SENSORS // 10)
SHADES = (transmission(0.3), transmission(0.6))
STATES = [np.array([0, 1, 0])]

# Two suns: one at steps 0 and 2, the other at step 1
NORMAL = csc_array([[300.0, 0, 200.0], [0, 500.0, 0]])
SUNS = SunMatrix(
    np.array([[0, -1.0, 0], [0, -0.6, 0.8]]), uniform_sky().times, NORMAL, {}
)


@dataclass(frozen=True)
class Sunlight:
    """Coefficients C_ds (band, pixel, sun), and their error component."""

    values: np.ndarray
    error: np.ndarray

    def received(self, normal, weights):
        lit = np.flatnonzero(normal.sum(axis=0))
        batches = [self.values + self.error, self.values - self.error]
        found = np.einsum("ob,tbps->tops", weights, batches) @ normal.toarray()
        return ReceivedSunlight(lit, np.float32(found[..., lit]))


def matrices(seed=1, share=1.0):
    rng = np.random.default_rng(seed)
    pixels = view("a", rng=rng, count=1, share=share)
    # Unequal bands, so that their order and weights count
    values = pixels.values * np.array([0.5, 1.0, 2.0])[:, None, None]
    values = values * np.linspace(0.5, 1.5, SENSORS)[:, None]
    pixels = replace(pixels, values=values, rows=pixel_axis(SENSORS))
    return pixels, daylight("a", rng=rng, count=4)


def five_phases(seed=1):
    """Matrices of the five phases; V_d T D_d S_ds is less than V T D S."""
    whole, direct = matrices(seed), matrices(seed + 1, share=0.2)
    rng = np.random.default_rng(seed + 2)
    shape = 3, SENSORS, len(SUNS)
    suns = [Sunlight(rng.random(shape), 0.1 * rng.normal(size=shape)) for _ in SHADES]
    parts = (window_matrices(*p[:1], SHADES, *p[1:]).whole for p in (whole, direct))
    return WindowMatrices(*parts, MatrixChain(tuple(suns)))


def skies(terms):
    sky = uniform_sky()
    return Skies(sky, sky, SUNS) if terms is FIVE_PHASE else Skies(sky)


def luminance(pixels, sky, states):
    window = window_matrices(pixels, SHADES, sky)
    series = pictures_over_time(
        [window], THREE_PHASE, CAMERA, Skies(uniform_sky()), states
    )
    return np.stack([picture.luminance() for picture in series])


def coarse(monkeypatch):
    """Divide the picture of 7 × 10 pixels into 4 × 5 blocks."""
    monkeypatch.setattr(pixel_blocks, "_MOST", 5)


def block_means(pixels):
    rows, columns = ([0, 1, 3, 5, 7], [0, 2, 4, 6, 8, 10])
    return np.array(
        [
            [pixels[a:b, c:d].mean() for c, d in itertools.pairwise(columns)]
            for a, b in itertools.pairwise(rows)
        ]
    )


@pytest.mark.parametrize("states", [[0, 0, 0], [0, 1, 0]])
@pytest.mark.parametrize("blocks", [False, True], ids=["pixels", "blocks"])
def test_errors_are_those_of_perturbed_matrices(states, blocks, monkeypatch):
    """By brute force: V or D plus each of its components, whole or in state order."""
    if blocks:
        coarse(monkeypatch)
    mean = block_means if blocks else np.asarray
    pixels, sky = matrices()
    window = window_matrices(pixels, SHADES, sky)
    states = [np.array(states)]
    found = list(
        uncertain_luminance_over_time(
            [window], THREE_PHASE, CAMERA, Skies(uniform_sky()), states
        )
    )
    plain = luminance(pixels, sky, states)
    moved = replace(pixels, values=pixels.values + pixels.components[0])
    error = luminance(moved, sky, states) - plain
    drawn = [
        luminance(pixels, replace(sky, values=sky.values + part), states) - plain
        for part in sky.components
    ]
    for step, each in enumerate(found):
        np.testing.assert_allclose(each.luminance, plain[step], rtol=1e-4)
        np.testing.assert_allclose(each.blocks, mean(plain[step]), rtol=1e-4)
        np.testing.assert_allclose(each.error, abs(mean(error[step])), atol=2e-3)
        for number, shared in enumerate(each.shared):
            # The mean of the squares of four draws is the sum of those of components
            expected = 2 * mean(drawn[number][step])
            np.testing.assert_allclose(shared, expected, atol=5e-3)
    assert np.max(found[0].error) > 0.1
    assert np.max(found[1].shared) > 0.1


def test_blocks_of_pixels_have_means_of_any_number_of_steps(monkeypatch):
    """Also of none, as in a night or behind an opaque blind."""
    monkeypatch.setattr(pixel_blocks, "_MOST", 5)
    blocks = pixel_blocks.PixelBlocks.of(7, 11)
    light = np.random.default_rng(1).random((2, 1, 77, 3)).astype(np.float32)
    found = blocks.means(light)
    assert found.shape == (2, 1, np.prod(blocks.shape), 3)
    first = light.reshape(2, 7, 11, 3)[:, : blocks.rows[1], : blocks.columns[1]]
    np.testing.assert_allclose(found[:, 0, 0], first.mean(axis=(1, 2)), rtol=1e-5)
    assert blocks.means(light[..., :0]).shape == (*found.shape[:-1], 0)


def test_matrices_of_blocks_divided_beforehand_give_the_same_pictures(monkeypatch):
    """Also of half precision; matrices of pixels then need no error components."""
    coarse(monkeypatch)
    rest = FIVE_PHASE, CAMERA, skies(FIVE_PHASE), STATES
    parts = [five_phases()]
    pixels, few = pixel_blocks.PixelBlocks.of(CAMERA.rows, CAMERA.columns).divided(
        parts
    )
    views = [chain.view for chain in (pixels[0].whole, pixels[0].direct)]
    assert all(view.components is None for view in views)
    assert all(view.values.dtype == np.float32 for view in views)
    divided = list(uncertain_luminance_over_time(pixels, *rest, of_blocks=few))
    whole = list(uncertain_luminance_over_time(parts, *rest))
    for one, other in zip(divided, whole, strict=True):
        for name in ("luminance", "blocks", "error", "shared"):
            value, expected = getattr(one, name), getattr(other, name)
            np.testing.assert_allclose(value, expected, rtol=1e-5, atol=1e-5)
    assert np.max(whole[0].error) > 0


@pytest.mark.parametrize("terms", [THREE_PHASE, FIVE_PHASE], ids=["three", "five"])
@pytest.mark.parametrize("most", [None, (2, 9)], ids=["one block", "many blocks"])
def test_luminance_is_that_of_the_pictures(terms, most, monkeypatch):
    """Also if the product is computed in small blocks of time steps and pixels."""
    if most:
        monkeypatch.setattr(picture_series, "_STEPS", 2)
        monkeypatch.setattr(picture_series, "block_steps", lambda pixels: most[0])
        monkeypatch.setattr(picture_series, "_PIXELS", most[1])
    given = [five_phases()], terms, CAMERA, skies(terms), STATES
    pictures = [picture.luminance() for picture in pictures_over_time(*given)]
    certain = list(luminance_over_time(*given))
    uncertain = [each.luminance for each in uncertain_luminance_over_time(*given)]
    assert min(np.min(p) for p in pictures[:2]) > 0
    for other in (certain, uncertain):
        np.testing.assert_allclose(other, pictures, rtol=1e-4, atol=1e-3)


@pytest.mark.parametrize("blocks", [False, True], ids=["pixels", "blocks"])
def test_errors_of_direct_light_cancel(blocks, monkeypatch):
    """V, V_d and C_ds share paths: errors are those of all of them moved together."""
    if blocks:
        coarse(monkeypatch)
    mean = block_means if blocks else np.asarray
    parts = five_phases()
    rest = FIVE_PHASE, CAMERA, skies(FIVE_PHASE), STATES
    found = list(uncertain_luminance_over_time([parts], *rest))
    plain = list(luminance_over_time([parts], *rest))

    def moved(*, whole=0.0, direct=0.0):
        def view_of(chain, share):
            V = chain.view
            own = replace(V, values=V.values + share * V.components[0])
            return replace(chain, receiving=(own,))

        sun = tuple(
            replace(each, values=each.values + direct * each.error)
            for each in parts.sun.receiving
        )
        window = WindowMatrices(
            view_of(parts.whole, whole),
            view_of(parts.direct, direct),
            replace(parts.sun, receiving=sun),
        )
        return list(luminance_over_time([window], *rest))

    together = moved(whole=1.0, direct=1.0)
    for step, each in enumerate(found):
        deviation = mean(together[step] - plain[step])
        np.testing.assert_allclose(each.error, abs(deviation), atol=0.02)
    assert np.max(found[0].error) > 1


def test_luminance_weights_the_bands():
    """A picture of unequal bands: Radiance's weights of red, green and blue."""
    parts, sky = matrices(), Skies(uniform_sky())
    window = window_matrices(*parts[:1], SHADES, *parts[1:])
    [first, *_] = luminance_over_time([window], THREE_PHASE, CAMERA, sky)
    each = np.pi * 0.3 * np.array([0.5, 1.0, 2.0])
    expected = float(RGB.photometric(each)) * np.linspace(0.5, 1.5, SENSORS)
    np.testing.assert_allclose(first.ravel(), expected, rtol=1e-4)
