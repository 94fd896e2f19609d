"""Wrong clocks and gaps in time are reported."""

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.radiance.generated_sky import sky_at, sky_scene
from clerestory.sky.quality_checks import clock_shift, quality_problems
from clerestory.sky.solar_position import sun_at
from clerestory.sky.weather import Site, Weather
from clerestory.sky.weather_selection import select_days, select_moment


def made_year(latitude_deg=50.0, clouds=0.5, **changes):
    """A year of hours: light follows the sun's height, with clouds drawn at random."""
    times = np.datetime64("2023-01-01T00:30", "s") + 3600 * np.arange(8760)
    place = {"latitude_deg": latitude_deg, "longitude_deg": 8.5}
    sun = sun_at(Site(utc_offset_hours=1.0, **place), times)
    cover = np.repeat(np.random.default_rng(5).uniform(0, clouds, 2920), 3)
    height = np.maximum(np.sin(sun.altitude), 0)
    weather = Weather(
        place="Testville",
        elevation=100.0,
        utc_offset_hours=1.0,
        times=times,
        step_minutes=60.0,
        direct_normal=800 * (1 - cover) * (height > 0.02),
        diffuse_horizontal=400 * height * cover + 80 * (height > 0),
        **place,
    )
    return replace(weather, **changes)


def in_daylight_saving(weather, months):
    """The same light with summer's clock an hour ahead."""
    month = weather.times.astype("datetime64[M]").astype(int) % 12 + 1
    summer = np.isin(month, months)
    late = {
        name: np.where(
            summer, np.roll(getattr(weather, name), 1), getattr(weather, name)
        )
        for name in ("direct_normal", "diffuse_horizontal")
    }
    return replace(weather, **late)


@pytest.mark.parametrize("latitude_deg", [60.0, 35.0, -35.0])
def test_a_right_clock_is_not_doubted(latitude_deg):
    weather = made_year(latitude_deg)
    assert not list(quality_problems(weather))
    assert clock_shift(weather).whole == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize(("hours", "word"), [(1, "early"), (-1, "late")])
def test_a_file_off_by_an_hour_is_reported(hours, word):
    weather = made_year(utc_offset_hours=1.0 + hours)
    assert clock_shift(weather).whole == pytest.approx(hours, abs=0.1)
    *_, doubt = quality_problems(weather)
    assert f"irradiance is 1.0 h {word} relative to the solar position" in doubt


@pytest.mark.parametrize(
    ("latitude_deg", "months"), [(50.0, range(4, 11)), (-35.0, (10, 11, 12, 1, 2, 3))]
)
def test_daylight_saving_time_is_reported(latitude_deg, months):
    weather = in_daylight_saving(made_year(latitude_deg), list(months))
    assert clock_shift(weather).summer_less_winter == pytest.approx(-1, abs=0.25)
    assert any("daylight saving" in doubt for doubt in quality_problems(weather))


def test_climates_of_the_world_are_not_doubted_but_for_one(shared_data):
    """Mannheim's file has light with the sun 6° and more below the horizon."""
    from clerestory.sky.weather_formats import read_weather

    doubted = {
        path.stem
        for path in (shared_data / "weather").glob("*.epw")
        if list(quality_problems(read_weather(path)))
    }
    assert doubted == {"mannheim"}


def test_missing_steps_are_counted():
    weather = made_year()
    keep = np.ones(8760, bool)
    keep[[100, 101, 102, 2000]] = False
    (doubt,) = quality_problems(weather.select(keep))
    assert doubt.startswith(
        "4 time steps are missing in 2 gaps (first: after 2023-01-05"
    )


def test_one_day_is_too_short_to_assess_the_clock():
    assert clock_shift(made_year().select(slice(0, 24))) is None


def test_days_of_the_year_may_go_over_new_year():
    weather = made_year()
    assert len(select_days(weather, first="03-01", last="03-02")) == 48
    assert len(select_days(weather, first="12-31", last="01-02")) == 72
    with pytest.raises(InputError, match="day '3-1'; MM-DD expected"):
        select_days(weather, first="3-1")
    march = select_days(weather, first="03-01", last="03-31")
    with pytest.raises(InputError, match="no weather from 05-01 to 05-02"):
        select_days(march, first="05-01", last="05-02")


@pytest.mark.parametrize("moment", ["06-21 11:00", "06-21T11:30", "06-21 11:59"])
def test_a_moment_has_its_own_sun_and_the_irradiance_of_its_step(moment):
    year = made_year()
    noon = select_moment(year, moment)
    assert str(noon.times[0]) == f"2023-{moment.replace(' ', 'T')}:00"
    step = year.times == np.datetime64("2023-06-21T11:30")
    assert noon.direct_normal == year.direct_normal[step]
    assert noon.diffuse_horizontal == year.diffuse_horizontal[step]
    assert noon.notes == (
        "irradiance of the 60-minute step centred at 2023-06-21T11:30",
    )


@pytest.mark.parametrize("minutes", [0, 10, 30, 59])
def test_a_picture_and_a_matrix_use_the_same_step(minutes):
    """Both `render --time` and `sky matrix --time`, also on the border of two steps."""
    year, moment = made_year(), datetime(2024, 6, 21, 12, minutes)  # noqa: DTZ001
    chosen = select_moment(year, f"{moment:%m-%d %H:%M}")
    drawn = sky_at(year, moment)
    command = (
        f"gendaylit 6 21 {12 + minutes / 60:.5f} -W {chosen.direct_normal[0]:g}"
        f" {chosen.diffuse_horizontal[0]:g} -a 50 -o -8.5 -m -15"
    )
    assert str(chosen.times[0]).endswith(f"12:{minutes:02d}:00")
    for one, other in zip(drawn.distant, sky_scene(command).distant, strict=True):
        np.testing.assert_array_equal(one.direction, other.direction)


@pytest.mark.parametrize(
    ("moment", "message"),
    [
        ("noon", "MM-DD HH:MM"),
        ("02-29 12:00", "no weather at"),
        ("13-01 12:00", "no"),
    ],
)
def test_a_moment_that_is_not_there_is_refused(moment, message):
    with pytest.raises(InputError, match=message):
        select_moment(made_year(), moment)
