"""Position of the sun against the published table and Radiance's conventions."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.solar_position import day_of_year, standard_pressure, sun_at
from clerestory.sky.weather import Site, Weather

NREL = Site(39.742476, -105.1786, -7, 1830.14)


def moments(*texts):
    return np.array(texts, dtype="datetime64[s]")


def test_spa_gives_the_published_example():
    """NREL/TP-560-34302, table A5.1: zenith 50.11162°, azimuth 194.34024°."""
    sun = sun_at(NREL, moments("2003-10-17T12:30:30"), temperature_c=11)
    assert 90 - np.degrees(sun.altitude[0]) == pytest.approx(50.11162, abs=3e-4)
    assert np.degrees(sun.azimuth[0]) == pytest.approx(194.34024, abs=3e-4)


@pytest.mark.parametrize(
    ("elevation", "pressure"),
    [(-500, 1074.78), (0, 1013.25), (1000, 898.75), (5000, 540.20), (9000, 307.42)],
)
def test_pressure_falls_as_in_the_standard_atmosphere(elevation, pressure):
    """ISO 2533, table of the pressure over geopotential altitude [hPa]."""
    assert standard_pressure(elevation) == pytest.approx(pressure, rel=1e-4)


def test_the_sun_moves_from_east_over_south_to_west():
    times = moments("2023-06-21T06:00", "2023-06-21T12:10", "2023-06-21T18:00")
    east, south, west = sun_at(Site(50, 15, 1), times).directions()
    assert east[0] > 0.8
    assert west[0] < -0.8
    assert south[1] < 0
    assert abs(south[0]) < 0.05


@pytest.mark.parametrize("formula", ["spa", "radiance"])
def test_noon_altitude_at_solstice_is_the_complement_of_latitude_plus_obliquity(
    formula,
):
    times = np.datetime64("2023-06-21T11:30", "s") + 60 * np.arange(60)
    sun = sun_at(Site(45, 0, 0), times, formula=formula)
    assert np.degrees(sun.altitude.max()) == pytest.approx(45 + 23.44, abs=0.05)


def test_the_two_formulas_differ_by_half_a_degree_as_a_rule():
    times = np.datetime64("2023-01-01T00:30", "s") + 3600 * np.arange(8760)
    exact = sun_at(NREL, times).directions()
    rough = sun_at(NREL, times, formula="radiance").directions()
    angle = np.arccos(np.clip(np.sum(exact * rough, axis=1), -1, 1))
    assert np.degrees(angle.max()) < 1.5
    assert np.degrees(np.median(angle)) < 0.5


def test_time_zone_and_longitude_cancel_each_other():
    """15° further east, one hour further ahead: the same altitude at the same clock."""
    times = moments("2023-04-01T09:00")
    here = sun_at(Site(30, 15, 1), times)
    there = sun_at(Site(30, 30, 2), times)
    assert np.degrees(here.altitude - there.altitude)[0] == pytest.approx(0, abs=0.02)


def test_day_of_year_counts_leap_days():
    days = day_of_year(moments("2023-01-01T23:59", "2023-12-31", "2024-12-31"))
    assert days.tolist() == [1, 365, 366]


def test_an_unknown_formula_is_refused():
    with pytest.raises(
        InputError, match="sun formula is 'newton'; one of spa, radiance expected"
    ):
        sun_at(NREL, moments("2023-01-01"), formula="newton")


def hours_of_a_day():
    times = np.datetime64("2023-03-05T00:30", "s") + 3600 * np.arange(24)
    dark = np.zeros(24)
    return Weather("x", 50.0, 8.5, 100.0, 1.0, times, 60.0, dark, dark)


def test_in_the_hour_of_sunrise_the_sun_stands_where_it_shines_from():
    """It is up for a part of the hour, and stands in the middle of that part."""
    weather = hours_of_a_day()
    seconds = weather.times[0] - np.timedelta64(1800, "s") + np.arange(86400)
    altitude = sun_at(weather.site, seconds).altitude
    shines = altitude.reshape(24, 3600) > 0
    partly = shines.any(axis=1) & ~shines.all(axis=1)
    assert partly.sum() == 2
    found = sun_over(weather).altitude
    for hour in np.flatnonzero(partly):
        middle = 3600 * hour + int(np.flatnonzero(shines[hour]).mean())
        assert found[hour] > 0
        assert found[hour] == pytest.approx(altitude[middle], abs=np.radians(0.1))
    centres = altitude[1800::3600]
    np.testing.assert_allclose(found[~partly], centres[~partly], atol=1e-12)


def test_radiances_sun_stays_at_the_centre_of_the_hour():
    weather = hours_of_a_day()
    plain = sun_at(weather.site, weather.times, formula="radiance")
    found = sun_over(weather, sun_formula="radiance")
    np.testing.assert_array_equal(found.altitude, plain.altitude)
