"""Measured irradiance: parting sun and sky, and CSV files."""

import numpy as np
import pytest

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.sky.csv_measurements import Columns, read_measured
from clerestory.sky.irradiance_decomposition import split_irradiance
from clerestory.sky.solar_position import SunPosition
from clerestory.sky.weather import Site

SITE = Site(latitude_deg=50.0, longitude_deg=8.5, utc_offset_hours=1.0, place="roof")
BOTH = Columns("time", global_horizontal="GHI", diffuse_horizontal="DHI")


def sun_at(*altitude_deg):
    altitude = np.radians(np.array(altitude_deg, dtype=float))
    return SunPosition(altitude, np.zeros_like(altitude))


def split_of(times, sun, decomposition="erbs", **series):
    return split_irradiance(times, sun, series, decomposition=decomposition)


def moments(count):
    return np.datetime64("2022-06-21T10:00", "s") + 300 * np.arange(count)


def test_any_two_of_three_give_the_same_parts():
    """GHI = DHI + DNI sin h with DNI 800, DHI 100 at 30°: GHI 500."""
    sun, times = sun_at(30.0), moments(1)
    direct, diffuse, level = np.array([800.0]), np.array([100.0]), np.array([500.0])
    for given in (
        {"direct_normal": direct, "diffuse_horizontal": diffuse},
        {"direct_normal": direct, "global_horizontal": level},
        {"diffuse_horizontal": diffuse, "global_horizontal": level},
    ):
        split = split_of(times, sun, **given)
        assert split.direct_normal[0] == pytest.approx(800)
        assert split.diffuse_horizontal[0] == pytest.approx(100)
        assert split.notes == ()


def test_near_the_horizon_the_sine_is_that_of_three_degrees():
    split = split_of(
        moments(1),
        sun_at(1.0),
        global_horizontal=np.array([20.0]),
        diffuse_horizontal=np.array([15.0]),
    )
    assert split.direct_normal[0] == pytest.approx(5 / np.sin(np.radians(3)))
    level = split.direct_normal * np.sin(np.radians(1)) + split.diffuse_horizontal
    assert level[0] == pytest.approx(20)


def test_the_sun_is_never_stronger_than_outside_the_atmosphere():
    split = split_of(
        moments(1),
        sun_at(4.0),
        global_horizontal=np.array([300.0]),
        diffuse_horizontal=np.array([10.0]),
    )
    assert 1300 < split.direct_normal[0] < 1420
    level = split.direct_normal * np.sin(np.radians(4)) + split.diffuse_horizontal
    assert level[0] == pytest.approx(300)


def test_diffuse_above_global_is_cut_and_counted():
    split = split_of(
        moments(2),
        sun_at(30, 30),
        global_horizontal=np.array([100.0, 100.0]),
        diffuse_horizontal=np.array([102.0, 140.0]),
    )
    assert split.direct_normal.tolist() == [0, 0]
    assert split.diffuse_horizontal.tolist() == [100, 100]
    assert split.notes == ("1 diffuse values above global limited to global",)


def test_light_at_night_is_set_to_zero_and_counted():
    split = split_of(
        moments(2),
        sun_at(-7, -5),
        direct_normal=np.array([300.0, 0.0]),
        diffuse_horizontal=np.array([10.0, 6.0]),
    )
    assert split.diffuse_horizontal.tolist() == [0, 6]
    assert split.direct_normal.tolist() == [0, 0]
    assert "1 steps with irradiance" in split.notes[0]


@pytest.mark.parametrize("model", ["erbs", "dirint"])
def test_global_alone_is_split_and_keeps_its_sum(model):
    sun = sun_at(*np.linspace(10, 60, 20))
    level = 1000 * np.sin(sun.altitude) * 0.6
    split = split_of(moments(20), sun, global_horizontal=level, decomposition=model)
    total = split.direct_normal * np.sin(sun.altitude) + split.diffuse_horizontal
    np.testing.assert_allclose(total, level, rtol=1e-9)
    assert np.all(split.direct_normal > 0)
    assert np.all(split.diffuse_horizontal > 0)


def test_too_little_irradiance_is_refused():
    with pytest.raises(InputError, match="any two of global"):
        split_of(moments(1), sun_at(30), direct_normal=np.array([1.0]))
    with pytest.raises(
        InputError, match="decomposition is 'x'; one of erbs, dirint expected"
    ):
        split_of(
            moments(1), sun_at(30), global_horizontal=np.array([1.0]), decomposition="x"
        )


@pytest.fixture
def write(tmp_path):
    def write_csv(text):
        path = tmp_path / "roof.csv"
        path.write_text(text)
        return path

    return write_csv


GOOD = "time,GHI,DHI\n2022-06-21 12:00,700,120\n2022-06-21 12:05,710,118\n"


@pytest.mark.parametrize(
    ("stands_for", "first"),
    [("start", "12:02:30"), ("centre", "12:00:00"), ("end", "11:57:30")],
)
def test_times_go_to_the_centre_of_their_step(write, stands_for, first):
    weather = read_measured(write(GOOD), columns=BOTH, site=SITE, stands_for=stands_for)
    assert str(weather.times[0]) == f"2022-06-21T{first}"
    assert weather.step_minutes == 5


def test_daylight_saving_in_the_offset_ends_in_standard_time(write):
    text = GOOD.replace(":00,", ":00+02:00,").replace(":05,", ":05+02:00,")
    weather = read_measured(write(text), columns=BOTH, site=SITE)
    assert str(weather.times[0]) == "2022-06-21T11:00:00"


def test_a_clock_with_daylight_saving_ends_in_standard_time(write):
    """In Berlin on 30 October 2022 the hour from 2 to 3 comes twice."""
    hours = ["00:30", "01:30", "02:30", "02:30", "03:30"]
    text = "time,GHI,DHI\n" + "".join(f"2022-10-30 {hour},0,0\n" for hour in hours)
    weather = read_measured(write(text), columns=BOTH, site=SITE, clock="Europe/Berlin")
    found = [str(time)[5:16] for time in weather.times]
    assert found == [
        f"10-{day}" for day in ("29T23:30", *(f"30T0{h}:30" for h in range(4)))
    ]
    with pytest.raises(InputError, match=r"follows 2.*; increasing times expected"):
        read_measured(write(text), columns=BOTH, site=SITE)
    with pytest.raises(InputError, match="unknown time zone 'Hessen'"):
        read_measured(write(text), columns=BOTH, site=SITE, clock="Hessen")


def test_time_in_two_columns_and_a_format(write):
    text = "day;clock;GHI;DHI\n21.06.2022;12:00;700;120\n21.06.2022;12:01;710;118\n"
    weather = read_measured(
        write("a station\n" + text),
        columns=Columns(("day", "clock"), "GHI", "DHI"),
        site=SITE,
        time_format="%d.%m.%Y %H:%M",
        separator=";",
        skip_lines=1,
    )
    assert str(weather.times[1]) == "2022-06-21T12:01:00"


def test_the_model_of_a_split_is_noted(write):
    columns = Columns("time", global_horizontal="GHI")
    weather = read_measured(write(GOOD), columns=columns, site=SITE)
    assert weather.notes == ("global irradiance decomposed by the erbs model",)


def test_gaps_are_reported(write):
    rows = "".join(f"2022-06-21 12:{m:02d},{700 + m},100\n" for m in range(20))
    text = "time,GHI,DHI\n" + rows.replace(",705,", ",-9999.9,")
    with pytest.warns(ClerestoryWarning, match="GHI: 1 of 20 values .* line 7"):
        weather = read_measured(write(text), columns=BOTH, site=SITE)
    steady = weather.direct_normal[4:7]
    assert steady[1] == pytest.approx((steady[0] + steady[2]) / 2, rel=1e-3)


CSV_FAULTS = {
    "column missing": (("GHI", "global"), 1, "no column 'GHI'; one of time, global"),
    "not a number": (("710", "7l0"), 3, "GHI is '7l0'"),
    "not a time": (("2022-06-21 12:05", "noon"), 3, "time 'noon'; ISO 8601 expected"),
    "time goes back": (("12:05", "11:55"), 3, "follows 2.*; increasing times expected"),
    "row cut short": ((",118", ""), 3, "2 fields; DHI expected"),
    "no rows": ((GOOD[13:], ""), 1, "no data rows"),
}


@pytest.mark.parametrize("fault", CSV_FAULTS)
def test_a_faulty_csv_is_named_with_its_line(write, fault):
    change, line, message = CSV_FAULTS[fault]
    path = write(GOOD.replace(*change))
    with pytest.raises(InputError, match=message) as caught:
        read_measured(path, columns=BOTH, site=SITE)
    assert str(caught.value).startswith(f"{path}:{line}: ")


def test_an_unknown_moment_of_the_step_is_refused(write):
    with pytest.raises(InputError, match="one of start, centre, end expected"):
        read_measured(write(GOOD), columns=BOTH, site=SITE, stands_for="middle")


def test_five_minute_data_with_all_three_agree(shared_data):
    """NSRDB's GHI, DHI and DNI satisfy the closure: computed and given DNI agree."""
    path = shared_data / "irradiance" / "test_psm3_2019_5min.csv"
    site = Site(40.5137, -108.5449, -7.0, 1830.0)
    given = Columns("", direct_normal="DNI", diffuse_horizontal="DHI")
    derived = Columns("", global_horizontal="GHI", diffuse_horizontal="DHI")
    truth = read_measured(path, columns=given, site=site)
    ours = read_measured(path, columns=derived, site=site)
    assert len(truth) == 288
    high = truth.direct_normal > 300
    assert high.sum() > 50
    ratio = ours.direct_normal[high] / truth.direct_normal[high]
    assert np.median(ratio) == pytest.approx(1, abs=0.02)
