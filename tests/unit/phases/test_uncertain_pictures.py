"""Errors of pictures by the matrix equation are those of perturbed matrices."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.matrix.axis import pixel_axis
from clerestory.phases.camera import Camera
from clerestory.phases.matrix_equation import Skies
from clerestory.phases.methods import THREE_PHASE
from clerestory.phases.picture_series import (
    pictures_over_time,
    uncertain_pictures_over_time,
)
from clerestory.scene.view import View
from phase_matrices import (
    SENSORS,
    daylight,
    transmission,
    uniform_sky,
    view,
    window_matrices,
)

CAMERA = Camera(View(kind="angular", horizontal=180, vertical=180), 10, SENSORS // 10)
TERMS = THREE_PHASE


def matrices(seed=1):
    rng = np.random.default_rng(seed)
    pixels = replace(view("a", rng=rng, count=1), rows=pixel_axis(SENSORS))
    return pixels, daylight("a", rng=rng, count=4)


def luminance(pixels, sky, states):
    shades = [transmission(0.3), transmission(0.6)]
    window = window_matrices(pixels, shades, sky)
    series = pictures_over_time([window], TERMS, CAMERA, Skies(uniform_sky()), states)
    return np.stack([picture.luminance() for picture in series])


@pytest.mark.parametrize("states", [[0, 0, 0], [0, 1, 0]])
def test_errors_are_those_of_perturbed_matrices(states):
    """By brute force: V or D plus each of its components, whole or in state order."""
    pixels, sky = matrices()
    shades = [transmission(0.3), transmission(0.6)]
    window = window_matrices(pixels, shades, sky)
    states = [np.array(states)]
    found = list(
        uncertain_pictures_over_time(
            [window], TERMS, CAMERA, Skies(uniform_sky()), states
        )
    )
    plain = luminance(pixels, sky, states)
    moved = replace(pixels, values=pixels.values + pixels.components[0])
    error = np.abs(luminance(moved, sky, states) - plain)
    drawn = [
        luminance(pixels, replace(sky, values=sky.values + part), states) - plain
        for part in sky.components
    ]
    for step, each in enumerate(found):
        np.testing.assert_allclose(each.picture.luminance(), plain[step], rtol=1e-4)
        np.testing.assert_allclose(each.error, error[step], atol=2e-3)
        for number, shared in enumerate(each.shared):
            # The mean of the squares of four draws is the sum of those of components
            np.testing.assert_allclose(shared, 2 * drawn[number][step], atol=5e-3)
    assert np.max(found[0].error) > 0.1
    assert np.max(found[1].shared) > 0.1
