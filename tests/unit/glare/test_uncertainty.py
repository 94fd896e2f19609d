"""Standard errors of glare indices: their size, and what they cover.

Pixels are means of eight batches with known distribution, so that the picture without
noise is known, and every seed gives an independent picture.
"""

import json
import warnings

import numpy as np
import pytest
from glare_rooms import FISHEYE, picture
from scipy.stats import norm

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.evaluate import evaluate_glare
from clerestory.glare.uncertainty import UncertainLuminance, index_errors

SIZE, BATCHES, SEEDS = 136, 8, 40

# Luminance of a single path that finds the sun [cd/m²]
FIREFLY = 8e6
INDICES = ("dgp", "illuminance", "average_luminance", "dgi", "ugr", "cgi", "ugp")


def room():
    """A window from 800 to 5000 cd/m² that crosses the threshold, and a lamp."""
    level = np.full((SIZE, SIZE), 150.0)
    level[22:60, 15:105] = np.linspace(800, 5000, 90)
    level[75:84, 45:54] = 20_000
    return level


def averaged(batches):
    """Mean and standard error of batches."""
    return batches.mean(axis=0), batches.std(axis=0, ddof=1) / np.sqrt(BATCHES)


def noise(seed, shape):
    random = np.random.default_rng(seed)
    return random.gamma(shape, 1 / shape, (BATCHES, SIZE, SIZE)), random


def evaluated(batches):
    mean, error = averaged(batches)
    return evaluate_glare(picture(mean), error=picture(error))


@pytest.mark.parametrize("shape", [30.0, 8.0])
def test_errors_are_the_scatter_over_seeds(shape):
    """Pixel errors of 6 and 12 %; the rms of 40 errors against the scatter of 40."""
    found = [evaluated(room() * noise(seed, shape)[0]) for seed in range(SEEDS)]
    for name in INDICES:
        scatter = np.std([each.values()[name] for each in found], ddof=1)
        error = np.sqrt(np.mean([each.errors[name] ** 2 for each in found]))
        assert 0.8 < error / scatter < 1.25, name


def crossing(levels, *, shared):
    """Rms ± of the number of pixels above 2000, for pixels with an error of 40."""
    random, squares = np.random.default_rng(5), []
    for noise in random.standard_normal((400, *levels.shape)):
        value = levels + 40 * noise
        error = random.uniform(39.9, 40.1, levels.shape)  # other draws for each picture
        if shared:
            draws = 40 * random.standard_normal((4, *levels.shape))
            given = UncertainLuminance(value, 0 * error, draws)
        else:
            given = UncertainLuminance(value, error)
        lit = (given.pairs() > 2000).sum(axis=(1, 2), dtype=float)
        squares.append(index_errors(lit[None])[0] ** 2)
    return np.sqrt(np.mean(squares))


def test_pixels_that_cross_the_threshold_scatter_as_stated():
    """Levels evenly across the threshold: ∑ p (1 - p) with p = Φ((level - 2000)/40)."""
    levels = np.linspace(1800, 2200, 400).reshape(20, 20)
    chance = norm.cdf((levels - 2000) / 40)
    truth = np.sqrt(np.sum(chance * (1 - chance)))
    assert crossing(levels, shared=False) == pytest.approx(truth, rel=0.05)


def test_a_window_that_crosses_the_threshold_scatters_as_stated():
    """One level each, with errors that all pixels share."""
    levels = np.linspace(1800, 2200, 41)
    chance = norm.cdf((levels - 2000) / 40)
    truth = np.sqrt(np.mean(chance * (1 - chance)))
    each = [crossing(np.full((1, 1), level), shared=True) for level in levels]
    assert np.sqrt(np.mean(np.square(each))) == pytest.approx(truth, rel=0.05)


def test_errors_shared_by_all_pixels_are_those_of_the_closed_form():
    """Luminances that are all 2 % off, without sources: DGP = c1 Ev + c3."""
    level = np.full((SIZE, SIZE), 500.0)
    sign = np.array([1, -1, 1, 1])[:, None, None]
    given = UncertainLuminance(level, 0 * level, 0.02 * level * sign)
    year = annual_glare([given], FISHEYE)
    assert year.illuminance_error[0] == pytest.approx(0.02 * year.illuminance.item())
    assert year.dgp_error[0] == pytest.approx(5.87e-5 * year.illuminance_error.item())


def fireflies(seed):
    """Rare paths: one batch of 20,000 in a part of the room finds the sun."""
    factor, random = noise(seed, 30.0)
    batches, chance = room() * factor, 1 / 20_000
    part = np.s_[90:118, 10:110]
    hits = random.random((BATCHES, 28, 100)) < chance
    batches[(slice(None), *part)] += hits * FIREFLY * BATCHES
    exact = room()
    exact[part] += chance * FIREFLY * BATCHES
    return batches, exact, int(hits.sum())


def test_the_error_of_a_picture_with_fireflies_covers_the_closed_form():
    """Single samples of 8e6 cd/m² as in the acceptance run; truth by expectation."""
    truth = evaluate_glare(picture(fireflies(0)[1])).dgp
    wrong = 0
    for seed in range(SEEDS):
        batches, _, hits = fireflies(seed)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = evaluated(batches)
        assert bool(caught) == (hits > 0), (seed, hits)
        if hits:
            assert abs(found.dgp - truth) < 2 * found.errors["dgp"]
            wrong += abs(found.dgp - truth) > 0.05
            words = str(caught[0].message)
            assert hits > 1 or "a single path sample (8e+06 cd/m² ± 100 %)" in words
            assert "path sample" in words
    assert wrong > 10


def test_the_warning_names_direction_share_and_error():
    """At (-36.4°, -29.8°) in the circle: 47.1° off, 39.8° left and 27.6° below."""
    mean, error = room(), np.zeros((SIZE, SIZE))
    mean[90, 40] = error[90, 40] = FIREFLY
    with pytest.warns(
        ClerestoryWarning, match="40° to the left of and 28° below"
    ) as caught:
        found = evaluate_glare(picture(mean), error=picture(error))
    without = evaluate_glare(picture(np.where(error > 0, 0, mean))).dgp
    share = round(100 * (1 - without / found.dgp))
    assert f"this source causes {share} % of DGP {found.dgp:.3f} ±" in str(
        caught[0].message
    )
    assert found.errors["dgp"] == pytest.approx(found.dgp - without)
    assert found.sources.samples().min() == pytest.approx(1)


def test_the_worst_picture_of_a_year_is_reported_once():
    mean, error = room(), np.zeros((SIZE, SIZE))
    bad, noisy = mean.copy(), error.copy()
    bad[90, 40] = noisy[90, 40] = FIREFLY
    series = [UncertainLuminance(mean, error), UncertainLuminance(bad, noisy)] * 3
    with pytest.warns(ClerestoryWarning, match="desk, picture 1: the glare") as caught:
        year = annual_glare(series, FISHEYE, name="desk")
    assert len(caught) == 1
    assert year.dgp_error.values[0] == 0
    assert year.dgp_error.values[1] > 0.1


def test_pictures_without_errors_have_none():
    assert evaluate_glare(picture(room())).errors == {}
    assert "dgp_error" not in annual_glare([room()], FISHEYE)


def test_errors_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="standard errors has 60 × 136 pixels; 136"):
        evaluate_glare(picture(room()), error=picture(room()[:, :60]))
    with pytest.raises(InputError, match="standard error of a pixel is -1"):
        UncertainLuminance(room(), room() * 0 - 1)


def test_equal_pictures_have_equal_errors():
    batches = room() * noise(1, 3.0)[0]
    assert json.dumps(dict(evaluated(batches).errors)) == json.dumps(
        dict(evaluated(batches).errors)
    )
