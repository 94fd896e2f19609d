"""Pixels that decide DGP: contributions against differences of DGP, and views."""

import numpy as np
import pytest

from clerestory.bands import RGB
from clerestory.engine.pixel_goals import PixelEstimates
from clerestory.errors import InputError
from clerestory.glare.dgp_goal import DgpError
from clerestory.glare.evaluate import evaluate_glare
from clerestory.image.picture import Picture
from clerestory.scene.view import View

SIZE = 60
EYE = View(kind="angular", horizontal=180, vertical=180)


def estimates(error=0.01):
    """A window of 16,000 cd/m² in a room of 360 cd/m²; errors relative to the pixel."""
    value = np.full((SIZE, SIZE, 3), 2.0)
    value[20:30, 25:35] = 90.0
    return PixelEstimates(value, np.square(error * value), EYE, RGB)


def dgp(value):
    return evaluate_glare(Picture(value.astype(np.float32), view=EYE), trust=True).dgp


@pytest.mark.filterwarnings("ignore:.*too coarse to tell glare sources")
def test_contributions_are_the_squares_of_changes_of_dgp():
    """One pixel inside of the source and one outside of it, changed by its error."""
    pixels = estimates()
    found = np.sqrt(DgpError(0.01).contributions(pixels))
    for row, column, step in ((25, 30, 30.0), (45, 20, 30.0)):
        more, less = pixels.value.copy(), pixels.value.copy()
        more[row, column] *= 1 + 0.01 * step
        less[row, column] *= 1 - 0.01 * step
        change = (dgp(more) - dgp(less)) / (2 * step)
        assert found[row, column] == pytest.approx(abs(change), rel=0.08)


def test_pixels_behind_the_eye_contribute_nothing():
    assert DgpError(0.01).contributions(estimates())[0, 0] == 0


def test_the_sum_of_contributions_is_the_variance_of_dgp():
    """Independent pixels, far from the threshold of glare sources.

    An error of DGP, of 8 pairs of pictures, has a standard deviation of 25 %.
    """
    goal, ratios = DgpError(0.001), []
    for error in np.linspace(0.01, 0.02, 10):
        pixels = estimates(error)
        linear = np.sqrt(goal.contributions(pixels).sum())
        ratios.append(goal.error(pixels) * goal.target / linear)
    assert np.sqrt(np.mean(np.square(ratios))) == pytest.approx(1, abs=0.25)


def test_other_views_are_refused():
    perspective = View(kind="perspective", horizontal=60, vertical=60)
    with pytest.raises(InputError, match=r"covers 30% .* a fisheye view of 180°"):
        DgpError(0.01).check_view(perspective, SIZE, SIZE)
    with pytest.raises(InputError, match="standard error of DGP is 0;"):
        DgpError(0)
