"""Weather files of three kinds, good and bad."""

import importlib.resources

import numpy as np
import pytest

from clerestory.errors import ClerestoryWarning
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather


def row(hour, direct=300, diffuse=120, *, month=3, day=21, dew=4.5, minute=60):
    cells = ["1999", month, day, hour, minute, "?9", "9.0", dew, "70", "101000"]
    cells += ["0", "0", "300", "250", direct, diffuse, "0", "0", "0", "0"]
    return ",".join(map(str, cells))


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


def test_sub_hourly_epw_steps_are_centred(write_epw):
    header = write_epw().read_text().split("DATA PERIODS")[0]
    rows = [row(h, minute=m) for h in range(1, 25) for m in (15, 30, 45, 60)]
    weather = read_weather(
        write_epw(rows, header + "DATA PERIODS,1,4,Data,Sunday,3/21,3/21\n")
    )
    assert weather.step_minutes == 15
    assert str(weather.times[0]) == "2023-03-21T00:07:30"
    assert str(weather.times[-1]) == "2023-03-21T23:52:30"


def test_a_leap_day_moves_the_file_to_2024(write_epw):
    weather = read_weather(
        write_epw([row(12, month=2, day=29), row(12, month=3, day=1)])
    )
    assert str(weather.times[0]) == "2024-02-29T11:30:00"


def test_missing_dew_points_become_nan(write_epw):
    weather = read_weather(
        write_epw([row(h, dew=99.9 if h == 1 else 4.5) for h in range(1, 25)])
    )
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
    rows = [row(h) for h in range(1, 25)]
    rows[:2] = [row(1, direct=-2.0), row(2, diffuse=-9.9)]
    path = write_epw(rows)
    with pytest.warns(ClerestoryWarning, match="1 values just below zero set to zero"):
        weather = read_weather(path)
    assert weather.direct_normal.tolist() == [0] + 23 * [300]
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
    with pytest.warns(
        ClerestoryWarning, match="8712 of the 8760 time steps.* 48 others"
    ):
        read_weather(write_epw(rows, header))


def year_rows():
    days = np.arange("2023-01-01", "2024-01-01", dtype="datetime64[D]")
    dates = [(int(str(day)[5:7]), int(str(day)[8:])) for day in days]
    return [row(h, month=m, day=d) for m, d in dates for h in range(1, 25)]


@pytest.mark.parametrize(
    ("lost", "message"),
    [
        (
            slice(100, 101),
            ":109: .* lacks 1 of the 8760 .*, first 2023-01-05T04:30:00; the 8759",
        ),
        (
            slice(5000, 5024),
            r":5009: .* 24 of the 8760 time steps of its header .1/ 1 to 12/31",
        ),
        (slice(0, 4380), ":9: .* lacks 4380 .*, first 2023-01-01T00:30"),
        (slice(4380, None), ":4388: .* lacks 4380 .*, first 2023-07-02T12:30"),
        (slice(0, None, 3), ":9: .* lacks 2920"),
    ],
)
def test_rows_that_an_epw_lacks_are_counted_and_named(write_epw, lost, message):
    header = write_epw().read_text().split("DATA PERIODS")[0]
    header += "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\n"
    rows = year_rows()
    del rows[lost]
    with pytest.warns(ClerestoryWarning, match=message):
        read_weather(write_epw(rows, header))


def test_a_year_in_two_periods_is_complete(write_epw):
    header = write_epw().read_text().split("DATA PERIODS")[0]
    header += "DATA PERIODS,2,1,A,Sunday,1/1,6/30,B,Saturday,7/1,12/31\n"
    assert len(read_weather(write_epw(year_rows(), header))) == 8760
    header = header.replace("7/1", "8/1")
    july = slice(24 * 181, 24 * 212)
    rows = year_rows()
    del rows[july]
    assert len(read_weather(write_epw(rows, header))) == 8760 - 31 * 24


def test_commas_in_quotes_do_not_separate(write_epw):
    path = write_epw()
    text = path.read_text().replace("Testville,-", '"VAN NUYS, AP",CA')
    path.write_text(text.replace("made for tests", '"made, for ""tests"""'))
    weather = read_weather(path)
    assert weather.place == "VAN NUYS, AP_DEU"
    assert (weather.latitude_deg, weather.longitude_deg) == (50.0, 8.5)


def test_a_very_long_cell_in_quotes_is_a_comment(write_epw):
    path = write_epw()
    long = '"' + 200_000 * "x" + '"'
    path.write_text(path.read_text().replace("made for tests", long))
    assert len(read_weather(path)) == 24


def test_daysim_five_minute_files_keep_their_step(write_wea):
    """Daysim writes hours with three digits: 0.042, 0.125, 0.208, …"""
    hours = (np.arange(288) + 0.5) / 12
    rows = [f"3 21 {hour:.3f} {300 * (7 < hour < 17):d} 0" for hour in hours]
    weather = read_weather(write_wea(rows))
    assert weather.step_minutes == 5
    error = weather.times - weather.times[0].astype("datetime64[D]")
    seconds = error.astype(float) - 3600 * hours
    assert np.abs(seconds).max() <= 2
    assert len(weather) == 288


def test_a_leap_year_of_wea_is_written_in_2024(write_wea):
    days = ((2, 28), (2, 29), (3, 1))
    weather = read_weather(write_wea([f"{m} {d} 12.5 300 100" for m, d in days]))
    assert [str(time)[:10] for time in weather.times] == [
        "2024-02-28",
        "2024-02-29",
        "2024-03-01",
    ]


def test_direct_above_the_extraterrestrial_is_cut_and_counted(write_epw):
    """On 21 March the sun is at 0.996 of its mean distance: 1367 × 1.0089 W/m²."""
    rows = [row(hour, "1450" if hour == 12 else "300") for hour in range(1, 25)]
    with pytest.warns(ClerestoryWarning, match="1 direct values above the extraterr"):
        weather = read_weather(write_epw(rows))
    assert weather.direct_normal.max() == pytest.approx(1367 * 1.0089, rel=1e-3)


def test_wea_illuminance_is_kept_and_has_its_irradiance(write_wea):
    rows = [f"6 21 {hour}.5 {90_000} {20_000}" for hour in range(9, 16)]
    path = write_wea(rows)
    path.write_text(path.read_text().replace("units 1", "units 3"))
    weather = read_weather(path)
    assert np.all(weather.illuminance.direct_normal == 90_000)
    sky = sky_matrix(weather, subdivision=1, sky_colour=(1, 1, 1))
    projected = sky.partition.dome.projected_solid_angles()
    lux = 179 * projected @ sky.diffuse[1:]
    np.testing.assert_allclose(lux, 20_000, rtol=1e-5)

    # Efficacies of a clear sky in summer, after Perez et al. 1990, figure 2
    assert np.all(np.abs(90_000 / weather.direct_normal - 100) < 10)
    assert np.all(np.abs(20_000 / weather.diffuse_horizontal - 130) < 15)
    assert np.all(sky_matrix(weather, subdivision=1, spectrum="solar").diffuse >= 0)
