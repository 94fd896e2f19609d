"""The suns that occur."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.constants import SUN_DIAMETER
from clerestory.errors import InputError, MatrixError
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.sky.sun_matrix import merge_suns, sun_matrix


def test_without_tolerance_every_lit_step_has_its_sun(spring_day):
    suns = sun_matrix(spring_day, spectrum="solar")
    up = sky_conditions(spring_day).sun.altitude > -SUN_DIAMETER / 2
    lit = (spring_day.direct_normal > 0) & up
    assert len(suns) == np.count_nonzero(lit)
    received = np.asarray(suns.direct_normal.sum(axis=0))
    np.testing.assert_allclose(received, np.where(lit, spring_day.direct_normal, 0))


@pytest.mark.parametrize("tolerance_deg", [0.5, 1.0, 9.0])
def test_a_shared_sun_is_within_the_tolerance(spring_day, tolerance_deg):
    suns = sun_matrix(spring_day, tolerance_deg=tolerance_deg, spectrum="solar")
    exact = sky_conditions(spring_day).sun.directions()
    sun, step = suns.direct_normal.tocoo().coords
    cosine = np.sum(suns.directions[sun] * exact[step], axis=1)
    assert np.degrees(np.arccos(cosine.clip(-1, 1)).max()) <= tolerance_deg + 1e-6
    whole = sun_matrix(spring_day, spectrum="solar")
    assert suns.direct_normal.sum() == pytest.approx(whole.direct_normal.sum())
    assert (len(suns) < len(whole)) == (tolerance_deg > 4)


def test_the_strongest_of_a_group_keeps_its_place():
    angle = np.radians([0.0, 1.0, 2.0, 10.0])
    directions = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)
    leader = merge_suns(
        directions, np.array([5.0, 9.0, 1.0, 2.0]), tolerance=np.radians(1.5)
    )
    assert leader.tolist() == [1, 1, 1, 3]


def test_the_radiance_of_a_disc_times_its_solid_angle_is_the_irradiance(spring_day):
    suns = sun_matrix(spring_day)
    disc = np.pi * np.radians(1.0) ** 2 / 4
    radiance = suns.radiance(np.radians(1.0))
    assert radiance.sum() * disc == pytest.approx(suns.direct_normal.sum())


def test_a_dark_year_has_no_suns(spring_day):
    dark = replace(spring_day, direct_normal=np.zeros(len(spring_day)))
    assert len(sun_matrix(dark, tolerance_deg=1.0)) == 0


def test_impossible_arguments_are_refused(spring_day):
    with pytest.raises(InputError, match="0 to 10 expected"):
        sun_matrix(spring_day, tolerance_deg=-1)
    suns = sun_matrix(spring_day)
    with pytest.raises(MatrixError, match="suns by 96 steps"):
        replace(suns, directions=suns.directions[1:])
