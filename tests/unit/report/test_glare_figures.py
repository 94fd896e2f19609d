"""Maps and rosettes of glare show the numbers they are given."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.report.glare_figures import glare_rosette_figure, glare_year_figure

HOURS = np.datetime64("2023-03-01T00:30") + np.arange(48) * np.timedelta64(1, "h")


def test_the_map_has_a_cell_for_each_hour():
    dgp = np.full(48, 0.2)
    dgp[12], dgp[36] = 0.5, 0.37
    figure = glare_year_figure(dgp, HOURS, title="Desk")
    axes = figure.axes[0]
    cells = axes.images[0].get_array()
    assert cells.shape == (24, 2)
    assert cells[12].tolist() == [0.5, 0.37]
    # 5 % of 48 hours are two: the third worst hour counts
    assert "DGP 0.20 is exceeded in 5 %" in axes.get_title(loc="left")
    assert "high protection" in axes.get_title(loc="left")


def test_hours_of_use_make_the_title():
    dgp = np.where(np.arange(48) % 24 == 12, 0.6, 0.2)
    noon = np.arange(48) % 24 == 12
    title = glare_year_figure(dgp, HOURS, use=noon).axes[0].get_title(loc="left")
    assert "no protection" in title
    assert "glare autonomy 0 %" in title


def test_dark_hours_are_free_of_glare():
    """Studies give NaN in the dark; 4 of 48 hours glare, more than 5 %."""
    dgp = np.full(48, np.nan)
    dgp[10:14] = 0.5
    dgp[14:20] = 0.3
    title = glare_year_figure(dgp, HOURS).axes[0].get_title(loc="left")
    assert "DGP 0.50 is exceeded in 5 %" in title
    assert "glare autonomy 92 %" in title
    figure = glare_rosette_figure(dgp[None], np.array([0.0]))
    heights = [patch.get_height() for patch in figure.axes[0].patches]
    np.testing.assert_allclose(heights, [4 / 48, 0, 0, 44 / 48])
    assert figure.axes[0].texts[0].get_text() == "0.50"


def test_the_rosette_shows_the_fraction_of_time_in_each_class():
    dgp = np.array([[0.2, 0.2, 0.5, 0.5], [0.2, 0.2, 0.2, 0.38]])
    figure = glare_rosette_figure(dgp, np.radians([0.0, 90.0]))
    heights = [patch.get_height() for patch in figure.axes[0].patches]
    # Worst first: intolerable, disturbing, perceptible, imperceptible
    assert heights == [0.5, 0, 0, 0, 0, 0.25, 0.5, 0.75]
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert texts == ["0.50", "0.38"]


def test_numbers_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="48 time steps for 3 DGP values"):
        glare_year_figure(np.ones(3), HOURS)
