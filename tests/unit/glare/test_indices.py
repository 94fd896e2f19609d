"""Indices of glare against the numbers of their papers and standards, by hand."""

import math

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.glare.cgi import cgi
from clerestory.glare.comfort_classes import (
    exceeded_dgp,
    glare_control_class,
    protection_level,
)
from clerestory.glare.dgi import dgi, modified_dgi
from clerestory.glare.dgp import (
    DGP,
    age_correction,
    dgp,
    low_light_correction,
    simplified_dgp,
)
from clerestory.glare.imageless import imageless_dgp, position_of
from clerestory.glare.index import EyePhotometry
from clerestory.glare.index_settings import DgpCoefficients, IndexSettings
from clerestory.glare.indices import INDICES, REPORTED, quantities_over_time
from clerestory.glare.pgsv import contrast_pgsv, saturation_pgsv
from clerestory.glare.position_index import position_index
from clerestory.glare.source_table import GlareSources
from clerestory.glare.ugp import ugp
from clerestory.glare.ugr import experimental_ugr, ugr
from clerestory.glare.vcp import VCP, dgr, vcp
from clerestory.glare.veiling import veiling_luminance
from clerestory.scene.view import View

NOTHING = GlareSources.of(luminance=[], solid_angle=[], position_index=[])
TWO = GlareSources.of(
    luminance=[4000.0, 9000.0], solid_angle=[0.05, 0.01], position_index=[1.5, 4.0]
)


def at(sigma_deg, tau_deg, below=False):
    values = np.radians([sigma_deg]), np.radians([tau_deg]), np.array([below])
    return float(position_index(*values)[0])


def test_position_index_is_one_on_the_line_of_sight():
    assert at(0, 0) == at(0, 90) == at(0, 180, below=True) == 1


def test_position_index_straight_up_is_levins():
    """τ = 0: ln P = (33.98 σ + 0.21 σ²)·10⁻³."""
    assert at(30, 0) == pytest.approx(math.exp(0.03398 * 30 + 21e-5 * 900))


def test_position_index_beside_the_line_of_sight_is_continuous():
    """τ = 90°: Iwata's curve below is Guth's with the slope of 6.49."""
    above, under = at(40, 89.999), at(40, 90.001, below=True)
    assert above == pytest.approx(under, rel=2e-3)


def test_sources_below_disturb_more_than_above_at_the_same_angle():
    assert at(40, 180, below=True) < at(40, 0)


def test_no_position_index_exceeds_sixteen():
    assert at(89, 0) == 16


def test_dgp_is_the_published_equation():
    level = 3000.0
    total = 4000**2 * 0.05 / (level**1.87 * 1.5**2) + 9000**2 * 0.01 / (
        level**1.87 * 16
    )
    expected = 5.87e-5 * level + 9.18e-2 * math.log10(1 + total) + 0.16
    assert dgp(
        TWO, illuminance=level, coefficients=DgpCoefficients(c2=0.0918, c3=0.16)
    ) == pytest.approx(expected)


def test_dgp_stops_at_one():
    assert dgp(TWO, illuminance=50_000.0) == 1


def test_corrections_are_those_of_wienold():
    assert float(low_light_correction(np.array(4 / 0.024))) == pytest.approx(0.5)
    assert float(low_light_correction(np.array(1000.0))) == 1
    assert age_correction(20) == pytest.approx(1)
    assert float(simplified_dgp(np.array(1000.0))) == pytest.approx(0.2462)


def test_ugr_is_that_of_cie_117():
    total = 4000**2 * 0.05 / 2.25 + 9000**2 * 0.01 / 16
    assert ugr(TWO, background=80.0) == pytest.approx(8 * math.log10(0.25 / 80 * total))
    assert cgi(TWO, illuminance=800.0, direct=300.0) == pytest.approx(
        8 * math.log10(2 * (1 + 0.6) / 800 * total)
    )
    assert ugp(TWO, background=80.0) == pytest.approx(
        0.26 * math.log10(0.25 / 80 * total)
    )


def test_dgi_is_that_of_hopkinson():
    term = sum(
        lum**1.6 * (omega / p**2) ** 0.8 / (100 + 0.07 * omega**0.5 * lum)
        for lum, omega, p in ((4000, 0.05, 1.5), (9000, 0.01, 4))
    )
    assert dgi(TWO, background=100.0) == pytest.approx(10 * math.log10(0.478 * term))


def test_vcp_is_half_where_the_rating_says_so():
    """ln DGR = 6.374 / 1.3227."""
    assert vcp(math.exp(6.374 / 1.3227)) == pytest.approx(50)
    assert vcp(10.0) == 100
    assert vcp(800.0) == 0


def test_indices_of_many_steps_are_those_of_each_step():
    """Steps with two sources, none, one; the last is dark."""
    bright = TWO.select(TWO.luminance > 5000)
    every = GlareSources.joined([TWO, NOTHING, bright, TWO])
    light = {"illuminance": 3000.0, "average": 700.0, "brightest": 9000.0}
    eye = EyePhotometry(
        sources=every,
        **{name: value * np.array([1, 0.5, 2, 0.0]) for name, value in light.items()},
        reference=np.full(4, 500.0),
        eye_illuminance=np.full(4, 2000.0),
        solid_angle=2 * np.pi,
        settings=IndexSettings(),
    )
    together = quantities_over_time(eye)
    assert (together["source_count"] == [2, 0, 1, 2]).all()
    assert np.isnan(together["ugr"]).tolist() == [False, False, False, True]
    for step in range(4):
        alone = quantities_over_time(eye.at_step(step))
        for name, value in alone.items():
            assert together[name][step] == pytest.approx(value[0], nan_ok=True), name


def test_veiling_luminance_follows_stiles_and_holladay():
    lamp = GlareSources.of(
        luminance=[1e5], solid_angle=[1e-3], position_index=[1], sigma=[np.radians(5)]
    )
    expected = 10 * 100 * math.cos(math.radians(5)) / 25
    assert veiling_luminance(lamp)[0] == pytest.approx(expected)


def test_without_sources_there_is_no_glare():
    assert ugr(NOTHING, background=80.0) == dgi(NOTHING, background=80.0) == 0
    assert (
        cgi(NOTHING, illuminance=500.0, direct=0.0) == dgr(NOTHING, average=100.0) == 0
    )
    assert vcp(dgr(NOTHING, average=100.0)) == 100
    assert dgp(NOTHING, illuminance=1000.0) == pytest.approx(5.87e-2 + 0.159)


def test_without_a_background_indices_are_not_numbers():
    assert np.isnan(ugr(TWO, background=0.0))
    assert np.isnan(modified_dgi(TWO, average=float("nan")))
    assert np.isnan(experimental_ugr(TWO, average=1.0, background=-1.0))


def test_pgsv_of_a_window():
    assert saturation_pgsv(1250 * math.pi) == pytest.approx(3.3 - 3.87 / 2)
    rest = (2 * math.pi * 500 - 2000 * 0.4) / (2 * math.pi - 0.4)
    size = math.log10(0.4)
    expected = 3.2 * math.log10(2000) - 0.64 * size
    expected += (0.79 * size - 0.61) * math.log10(rest) - 8.2
    found = contrast_pgsv(window=2000, window_solid_angle=0.4, average=500.0)
    assert found == pytest.approx(expected)
    with pytest.raises(InputError, match="accounts for all light"):
        contrast_pgsv(window=9000, window_solid_angle=0.4, average=500.0)


def test_five_percent_of_the_hours_may_exceed_a_limit():
    hours = np.concatenate([np.full(95, 0.3), np.full(5, 0.9)])
    assert exceeded_dgp(hours) == 0.3
    assert exceeded_dgp(np.append(hours[1:], 0.9)) == 0.9
    assert protection_level(0.35) == "high"
    assert protection_level(0.451) == "none"
    assert DGP.category(np.array([0.35, 0.36])).tolist() == [0, 1]
    assert VCP.category(np.array([90.0, 70.0, 50.0, 30.0])).tolist() == [0, 1, 2, 3]


def test_every_index_is_reported_once_with_its_thresholds_in_order():
    assert len({one.name for one in REPORTED}) == len(REPORTED)
    for index in INDICES:
        sign = 1 if index.glare_increases else -1
        assert (np.diff(index.thresholds) * sign > 0).all()


def test_classes_of_fabrics():
    """Corners of the table of EN 14501."""
    assert glare_control_class(normal_normal=0, normal_diffuse=0.01) == 4
    assert glare_control_class(normal_normal=0.04, normal_diffuse=0.01) == 3
    assert glare_control_class(normal_normal=0.2, normal_diffuse=0.0) == 0


def test_imageless_dgp_is_dgp_with_a_source_a_direction():
    luminance = np.array([[4000.0, 100.0], [9000.0, 9000.0]])
    found = imageless_dgp(
        np.array([3000.0, 3000.0]),
        luminance=luminance,
        solid_angle=np.array([[0.05], [0.01]]),
        index=np.array([[1.5], [4.0]]),
    )
    assert found[0] == pytest.approx(dgp(TWO, illuminance=3000.0))
    one = GlareSources.of(luminance=[9000], solid_angle=[0.01], position_index=[4])
    assert found[1] == pytest.approx(dgp(one, illuminance=3000.0))


def test_directions_behind_the_eye_have_no_weight():
    sides = np.array([[0.0, -1.0, 0.0], [0.0, np.cos(0.5), np.sin(0.5)]])
    found = position_of(sides, View())
    assert np.isinf(found[0])
    assert found[1] == pytest.approx(at(math.degrees(0.5), 0))
