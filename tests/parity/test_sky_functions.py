"""Skies as functions of direction against gensky and gendaylit, by rtrace."""

import re

import numpy as np
import pytest

pytest.importorskip("pyradiance")
from gendaylit import blended, likeness, run, trace, upward_directions

from clerestory.sky.gensky import cie_sky

pytestmark = pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")


@pytest.fixture
def directions():
    return upward_directions()


@pytest.mark.parametrize("position", [(40, 30), (10, -120), (75, 80)])
@pytest.mark.parametrize(
    ("kind", "option"),
    [("clear", "s"), ("intermediate", "i"), ("overcast", "c"), ("uniform", "u")],
)
def test_cie_skies_equal_gensky(kind, option, position, directions, tmp_path):
    """gensky counts azimuth from south to west; it prints three digits."""
    altitude, azimuth = position
    text = run("gensky", "-ang", altitude, azimuth, f"-{option}").decode()
    ground = float(re.search(r"skybright.cal\n0\n\d \d \S+ (\S+)", text).group(1))
    sky = cie_sky(
        kind, sun_altitude=np.radians(altitude), sun_azimuth=np.radians(180 + azimuth)
    )
    theirs = trace(text, directions, tmp_path)
    ours = blended(sky.radiance(directions), ground, directions)
    np.testing.assert_allclose(ours, theirs, rtol=3e-3)
    assert sky.ground == pytest.approx(ground, rel=6e-3)


@pytest.mark.parametrize(("kind", "option"), [("clear", "+s"), ("intermediate", "+i")])
def test_the_sun_of_cie_skies_equals_gensky(kind, option):
    text = run("gensky", "-ang", 40, 30, option).decode()
    radiance = float(re.search(r"void light solar\n0\n0\n3 (\S+)", text).group(1))
    sky = cie_sky(
        kind, sun_altitude=np.radians(40), sun_azimuth=np.radians(210), with_sun=True
    )
    assert sky.direct_normal == pytest.approx(6e-5 * radiance, rel=3e-3)


# Two hundred skies in all, thirty-two of them always
BATCHES = [*range(4), *(pytest.param(i, marks=pytest.mark.slow) for i in range(4, 25))]


@pytest.mark.parametrize("batch", BATCHES)
def test_perez_skies_scaled_as_gendaylit_does_are_gendaylits(batch, tmp_path):
    """Every radiance within 0.5 %, when ours is scaled by the same coarse sum.

    That sum lies up to some per cent above the integral that ours is scaled by.
    """
    random = np.random.default_rng(batch)
    for _ in range(8):
        found = likeness(random, tmp_path)
        assert found.parameters < 2e-5
        assert found.rescaled < 5e-3
        assert found.as_is == pytest.approx(abs(found.excess), abs=5e-3)
