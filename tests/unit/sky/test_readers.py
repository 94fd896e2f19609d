"""Weather files of three kinds, good and bad."""

import importlib.resources
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.sky.conditions import sun_over
from clerestory.sky.read import read_weather


def row(hour, direct=300, diffuse=120, *, month=3, day=21, dew=4.5, minute=60):
    cells = ["1999", month, day, hour, minute, "?9", "9.0", dew, "70", "101000"]
    cells += ["0", "0", "300", "250", direct, diffuse, "0", "0", "0", "0"]
    return ",".join(map(str, cells))


def day(**changes):
    return [row(hour, **changes) for hour in range(1, 25)]


def test_epw_hours_end_so_the_sun_is_half_an_hour_earlier(write_epw):
    weather = read_weather(write_epw())
    assert str(weather.times[0]) == "2023-03-21T00:30:00"
    assert str(weather.times[-1]) == "2023-03-21T23:30:00"
    assert weather.step_minutes == 60


def test_epw_longitude_and_time_zone_stay_east_positive(write_epw):
    weather = read_weather(write_epw())
    assert (weather.longitude_deg, weather.utc_offset_hours) == (8.5, 1.0)
    assert (weather.place, weather.elevation) == ("Testville_DEU", 110.0)


def test_wea_hours_are_centres_and_longitude_turns_east_positive(write_wea):
    weather = read_weather(write_wea())
    assert str(weather.times[0]) == "2023-03-21T11:30:00"
    assert (weather.longitude_deg, weather.utc_offset_hours) == (8.5, 1.0)


def test_wea_thirds_of_hours_fall_on_whole_minutes(write_wea):
    weather = read_weather(
        write_wea(("1 1 0.000 0 0", "1 1 0.167 0 0", "1 1 0.333 0 0"))
    )
    assert weather.step_minutes == 10
    assert str(weather.times[-1]) == "2023-01-01T00:20:00"


def test_wea_direct_irradiance_may_be_horizontal(write_wea):
    """Units 2: normal is horizontal over sin h, sin h = cos 50° cos 15.8° at first.

    On the equinox at 11:30, the sun is 26 + 7.5 minutes late: 15.8° before noon.
    """
    path = write_wea()
    normal = read_weather(path)
    path.write_text(path.read_text().replace("units 1", "units 2"))
    level = read_weather(path)
    sine = np.sin(sun_over(level).altitude)
    assert sine[0] == pytest.approx(
        np.cos(np.radians(50)) * np.cos(np.radians(15.8)), abs=0.01
    )
    np.testing.assert_allclose(level.direct_normal * sine, normal.direct_normal)
    np.testing.assert_array_equal(level.diffuse_horizontal, normal.diffuse_horizontal)


def test_tmy3_hours_end_so_the_sun_is_half_an_hour_earlier(write_tmy3):
    weather = read_weather(write_tmy3())
    assert str(weather.times[0]) == "2023-03-21T10:30:00"
    assert (weather.longitude_deg, weather.utc_offset_hours) == (-79.95, -5.0)


def test_tmy3_agrees_with_pvlib():
    """pvlib's own reader of the same file is the independent program."""
    iotools = pytest.importorskip("pvlib.iotools")
    path = importlib.resources.files("pvlib") / "data" / "723170TYA.CSV"
    weather = read_weather(str(path))
    table, site = iotools.read_tmy3(path, coerce_year=2023, map_variables=True)
    np.testing.assert_array_equal(weather.direct_normal, table["dni"])
    np.testing.assert_array_equal(weather.diffuse_horizontal, table["dhi"])
    np.testing.assert_array_equal(weather.dew_point_c, table["temp_dew"])
    assert site["latitude"] == weather.latitude_deg
    assert site["longitude"] == weather.longitude_deg
    ends = weather.times + np.timedelta64(30, "m")
    local = table.index.tz_localize(None).to_numpy()
    np.testing.assert_array_equal(ends[:-1], local[:-1])


def test_tmy2_agrees_with_pvlib():
    """pvlib's own reader of the same file is the independent program."""
    iotools = pytest.importorskip("pvlib.iotools")
    path = importlib.resources.files("pvlib") / "data" / "12839.tm2"
    weather = read_weather(str(path))
    table, site = iotools.read_tmy2(str(path))
    np.testing.assert_array_equal(weather.direct_normal, table["DNI"])
    np.testing.assert_array_equal(weather.diffuse_horizontal, table["DHI"])
    np.testing.assert_allclose(weather.dew_point_c, table["DewPoint"] / 10)
    assert site["latitude"] == weather.latitude_deg
    assert site["longitude"] == weather.longitude_deg
    assert str(weather.times[0]) == "2023-01-01T00:30:00"


TMY2_FAULTS = {
    "hour 25": (2, 7, "25", "hour 24.5"),
    "month 13": (2, 3, "13", "month 13"),
    "not a number": (3, 23, "12x4", "direct normal irradiance is '12x4'"),
    "time goes back": (3, 7, "01", "time goes back"),
    "latitude is text": (1, 39, "no", "latitude .* is 'no'"),
}


@pytest.mark.parametrize("fault", TMY2_FAULTS)
def test_a_faulty_tmy2_is_named_with_its_line(tmp_path, fault):
    line, start, text, message = TMY2_FAULTS[fault]
    whole = importlib.resources.files("pvlib") / "data" / "12839.tm2"
    lines = whole.read_text().splitlines()[:5]
    lines[line - 1] = (
        lines[line - 1][:start] + text + lines[line - 1][start + len(text) :]
    )
    path = tmp_path / "bad.tm2"
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=message) as caught:
        read_weather(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")


def test_sub_hourly_epw_steps_are_centred(write_epw):
    header = write_epw().read_text().split("DATA PERIODS")[0]
    rows = [row(h, minute=m) for h in (11, 12) for m in (15, 30, 45, 60)]
    weather = read_weather(
        write_epw(rows, header + "DATA PERIODS,1,4,Data,Sunday,1/1,1/1\n")
    )
    assert weather.step_minutes == 15
    assert str(weather.times[0]) == "2023-03-21T10:07:30"
    assert str(weather.times[-1]) == "2023-03-21T11:52:30"


def test_a_leap_day_moves_the_file_to_2024(write_epw):
    weather = read_weather(
        write_epw([row(12, month=2, day=29), row(12, month=3, day=1)])
    )
    assert str(weather.times[0]) == "2024-02-29T11:30:00"


def test_missing_dew_points_become_nan(write_epw):
    weather = read_weather(write_epw([row(11, dew=99.9), row(12)]))
    assert np.isnan(weather.dew_point_c[0])
    assert weather.dew_point_c[1] == 4.5


def test_epw_and_wea_of_one_climate_agree(shared_data):
    """The two files come from different converters; the WEA has rounded numbers."""
    epw = read_weather(shared_data / "weather" / "chicago.epw")
    wea = read_weather(shared_data / "weather" / "chicago.wea")
    np.testing.assert_array_equal(epw.times, wea.times)
    assert abs(epw.longitude_deg - wea.longitude_deg) < 1e-9
    assert epw.utc_offset_hours == wea.utc_offset_hours


def test_all_shared_climates_read_without_repairs(shared_data):
    files = sorted((shared_data / "weather").glob("*.[ew][pe][wa]"))
    assert len(files) >= 11
    for file in files:
        weather = read_weather(file)
        assert len(weather) in (8760, 52560)
        assert weather.notes == ()


def test_an_epw_of_forty_chosen_hours_reads_without_warning(shared_data):
    folder = shared_data / "tutorial_room" / "assets"
    weather = read_weather(next(folder.glob("*.epw")))
    wea = read_weather(next(folder.glob("*.wea")))
    assert len(weather) == 40
    np.testing.assert_array_equal(weather.times, wea.times)
    np.testing.assert_allclose(weather.direct_normal, wea.direct_normal, atol=1)


def test_zero_offsets_are_set_to_zero_and_counted(write_epw):
    path = write_epw([row(10, direct=-2.0), row(11, diffuse=-9.9), row(12)])
    with pytest.warns(ClerestoryWarning, match="1 values just below zero set to zero"):
        weather = read_weather(path)
    assert weather.direct_normal.tolist() == [0, 300, 300]
    assert len(weather.notes) == 2


@pytest.mark.parametrize("bad", [9999, -9999, 99999, 1501, "", "nan", -10.5])
def test_a_gap_is_interpolated_and_named(write_epw, bad):
    rows = [row(h, diffuse=10 * h) for h in range(1, 25)]
    rows[11] = row(12, diffuse=bad)
    with pytest.warns(
        ClerestoryWarning, match="1 of 24 .* interpolated .first: line 20"
    ):
        weather = read_weather(write_epw(rows))
    assert weather.diffuse_horizontal[11] == pytest.approx(120)


def test_a_year_cut_short_is_reported(write_epw):
    header = write_epw().read_text().split("DATA PERIODS")[0]
    header += "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\n"
    rows = [row(h, month=1, day=d) for d in (1, 2) for h in range(1, 25)]
    with pytest.warns(ClerestoryWarning, match="stop at 2023-01-02.*48 steps are used"):
        read_weather(write_epw(rows, header))


EPW_FAULTS = {
    "no number": ([row(1), row(2, direct="abc")], 10, "direct normal .* 'abc'"),
    "infinite": ([row(1), row(2, direct="inf")], 10, "'inf'; a number expected"),
    "short row": ([row(1), row(2)[:40]], 10, "fields; .* expected as field 15"),
    "month 13": ([row(1), row(2, month=13)], 10, "month 13, day 21; a date"),
    "30 February": ([row(1, month=2, day=30)], 9, "month 2, day 30; a date"),
    "day of fractions": ([row(1, day=1.5)], 9, "day 1.5; a date"),
    "hour 25": ([row(1), row(25)], 10, "hour 24.5; 0 to 24 expected"),
    "hour 0": ([row(0)], 9, "hour -0.5; 0 to 24 expected"),
    "time goes back": ([row(12), row(11)], 10, "time goes back"),
    "an hour twice": ([row(12), row(12)], 10, "time goes back"),
    "all missing": (day(direct=9999), 9, "24 of 24 values of direct normal"),
    "no rows": ([], 9, "no data rows"),
}


@pytest.mark.parametrize("fault", EPW_FAULTS)
def test_a_faulty_epw_row_is_named_with_its_line(write_epw, fault):
    rows, line, message = EPW_FAULTS[fault]
    path = write_epw(rows)
    with pytest.raises(InputError, match=message) as caught:
        read_weather(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")


HEADER_FAULTS = {
    "latitude is text": ("50.0", "north", "latitude is 'north'; a number"),
    "location cut short": (",50.0,8.5,1.0,110.0", "", "6 fields; latitude expected"),
    "beyond the pole": ("50.0", "95.0", "latitude 95.0; a number from -90.0 to 90.0"),
    "wrong time zone": ("8.5,1.0", "8.5,60", "UTC offset 60"),
    "no periods": ("DATA PERIODS", "DATA", "no DATA PERIODS"),
    "seven records": ("DATA PERIODS,1,1", "DATA PERIODS,1,7", "a divisor of 60"),
}


@pytest.mark.parametrize("fault", HEADER_FAULTS)
def test_a_faulty_epw_header_is_refused(write_epw, fault):
    old, new, message = HEADER_FAULTS[fault]
    path = write_epw()
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(InputError, match=message) as caught:
        read_weather(path)
    assert str(caught.value).startswith(f"{path}:")


WEA_FAULTS = {
    "key missing": (
        "time_zone -15\n",
        "",
        4,
        "'site_elevation' in the header; 'time_zone'",
    ),
    "photometric": ("units 1", "units 3", 6, "units 3; 1 or 2 expected"),
    "not a number": ("300 120", "3OO 120", 7, "direct normal irradiance is '3OO'"),
    "row cut short": ("310 121", "310", 8, "4 fields; diffuse"),
    "31 April": ("3 21 11.5", "4 31 11.5", 7, "month 4, day 31"),
    "hour 24.5": ("3 21 12.5", "3 21 24.5", 8, "hour 24.5"),
    "time goes back": ("3 21 12.5", "3 21 11.5", 8, "time goes back"),
    "longitude is text": ("longitude -8.5", "longitude east", 3, "longitude is 'east'"),
}


@pytest.mark.parametrize("fault", WEA_FAULTS)
def test_a_faulty_wea_is_named_with_its_line(write_wea, fault):
    old, new, line, message = WEA_FAULTS[fault]
    path = write_wea()
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(InputError, match=message) as caught:
        read_weather(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")


TMY3_FAULTS = {
    "column missing": ("DHI (W/m^2)", "DHI", 2, "no column 'DHI (W/m^2)'"),
    "date is text": ("03/21/1990", "spring", 3, "Date .* is 'spring'"),
    "row cut short": (",120,4.5", "", 3, "3 fields; DHI"),
    "hour 25": ("11:00", "25:00", 3, "hour 24.5"),
    "offset is text": ("-5.0", "EST", 1, "time zone is 'EST'"),
}


@pytest.mark.parametrize("fault", TMY3_FAULTS)
def test_a_faulty_tmy3_is_named_with_its_line(write_tmy3, fault):
    old, new, line, message = TMY3_FAULTS[fault]
    path = write_tmy3()
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(
        InputError, match=re.sub(r"([(^)])", r"\\\1", message)
    ) as caught:
        read_weather(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")


@pytest.mark.parametrize(
    "text", ["", "\n", "hello\nworld\n", "\0\1\2", "Date,a,b\n1,2,3\n"]
)
def test_a_file_of_another_kind_is_refused(tmp_path, text):
    path = tmp_path / "thing.epw"
    path.write_text(text)
    with pytest.raises(InputError, match="EPW, WEA, TMY2 or TMY3"):
        read_weather(path)


def test_a_missing_file_is_one_line(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_weather(tmp_path / "none.epw")


@pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")
@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    kind=st.sampled_from(["epw", "wea", "tmy3"]),
    place=st.floats(0, 1),
    length=st.integers(0, 12),
    text=st.text("0123456789.,-+ e\nnaif/:;\x00é", max_size=12),
)
def test_any_damage_to_a_file_is_an_input_error_or_none(
    write_epw, write_wea, write_tmy3, kind, place, length, text
):
    path = {"epw": write_epw, "wea": write_wea, "tmy3": write_tmy3}[kind]()
    whole = path.read_text()
    start = int(place * len(whole))
    path.write_text(whole[:start] + text + whole[start + length :])
    weather, fault = None, ""
    try:
        weather = read_weather(path)
    except InputError as error:
        fault = str(error)
    if weather is None:
        assert fault.startswith(f"{path}:")
        assert "\n" not in fault
    else:
        assert np.all(np.isfinite(weather.direct_normal))
