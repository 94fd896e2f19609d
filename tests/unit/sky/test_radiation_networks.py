"""Files of measuring networks, against their raw numbers."""

import numpy as np
import pytest
from pvlib import iotools

from clerestory.errors import InputError
from clerestory.sky.csv_measurements import Columns, read_measured
from clerestory.sky.radiation_networks import read_srml, read_surfrad
from clerestory.sky.solar_position import sun_at
from clerestory.sky.weather import Site
from clerestory.sky.weather_formats import read_weather
from processor_time import least_processor_time

EUGENE = Site(44.05, -123.07, -8.0, 150.0, "Eugene")
GOLDEN = Site(39.91, -105.23, -7.0, 1855.0, "Golden")

pytestmark = pytest.mark.filterwarnings(
    "ignore:.*(below zero set|missing or impossible)"
)


def sun_of(weather):
    return sun_at(weather.site, weather.times)


def test_surfrad_values_are_those_of_the_file(shared_data):
    """Columns 13 (direct) and 15 (diffuse), counted from 1, after the README."""
    path = shared_data / "irradiance" / "surfrad-slv16001.dat"
    weather = read_weather(path)
    table = np.array([row.split() for row in path.read_text().splitlines()[2:]], float)
    up = sun_of(weather).altitude > np.radians(-6)
    for ours, column in ((weather.direct_normal, 12), (weather.diffuse_horizontal, 14)):
        np.testing.assert_array_equal(ours[up], np.maximum(table[up, column], 0))
        assert np.all(ours[~up] == 0)
    assert (weather.latitude_deg, weather.longitude_deg) == (37.7, -105.92)
    assert weather.step_minutes == 1

    # The first minute of 2016 in UTC, seven hours before in the mountains
    assert str(weather.times[0]) == "2015-12-31T16:59:30"
    assert str(read_surfrad(path, utc_offset_hours=0).times[0]).endswith("23:59:30")


def test_the_sun_of_a_surfrad_file_is_that_of_its_own_zenith_column(shared_data):
    """Column 8 is the network's zenith angle [°], without refraction."""
    path = shared_data / "irradiance" / "surfrad-slv16001.dat"
    weather = read_surfrad(path)
    rows = path.read_text().splitlines()[2:]
    zenith = np.array([row.split()[7] for row in rows], float)
    ours = 90 - np.degrees(sun_of(weather).altitude)
    high = zenith < 80
    assert high.sum() > 300
    np.testing.assert_allclose(ours[high], zenith[high], atol=0.15)


@pytest.mark.filterwarnings("ignore:The inplace:DeprecationWarning")
def test_surfrad_agrees_with_pvlib(shared_data):
    path = shared_data / "irradiance" / "surfrad-slv16001.dat"
    weather = read_surfrad(path, utc_offset_hours=0)
    truth, about = iotools.read_surfrad(str(path))
    assert weather.elevation == about["elevation"]
    ends = truth.index.tz_localize(None).to_numpy().astype("datetime64[s]")
    np.testing.assert_array_equal(weather.times, ends - np.timedelta64(30, "s"))
    bright = truth["dni"].to_numpy() > 20
    direct = weather.direct_normal[bright]
    np.testing.assert_array_equal(direct, truth["dni"].to_numpy()[bright])


def test_surfrad_closes_to_its_global_instrument(shared_data):
    """GHI = DHI + DNI sin h, within what two instruments agree to."""
    path = shared_data / "irradiance" / "surfrad-slv16001.dat"
    weather = read_surfrad(path)
    level = np.array([row.split()[8] for row in path.read_text().splitlines()[2:]])
    sine = np.maximum(np.sin(sun_of(weather).altitude), 0)
    ours = weather.direct_normal * sine + weather.diffuse_horizontal
    assert ours.sum() == pytest.approx(level.astype(float).clip(0).sum(), rel=0.02)


def test_srml_global_and_direct_give_the_diffuse(shared_data):
    path = shared_data / "irradiance" / "SRML-day-EUPO1801.txt"
    weather = read_srml(path, site=EUGENE)
    rows = [row.split("\t") for row in path.read_text().splitlines()[1:]]
    level, direct = (np.array([row[i] for row in rows], float) for i in (2, 4))
    assert str(weather.times[0]) == "2018-01-01T00:00:30"
    good = (direct >= 0) & (direct < 1500)
    np.testing.assert_array_equal(weather.direct_normal[good], direct[good])
    sine = np.maximum(np.sin(sun_of(weather).altitude), 0)
    ours = weather.direct_normal * sine + weather.diffuse_horizontal
    lit = good & (level > direct * sine)
    np.testing.assert_allclose(ours[lit], level[lit], rtol=1e-12)


def test_midc_files_are_plain_columns(shared_data):
    """Global irradiance alone, with an offset of -8 W/m² at night, split by Erbs."""
    path = shared_data / "irradiance" / "midc_20181014.txt"
    columns = Columns(
        ("DATE (MM/DD/YYYY)", "MST"), global_horizontal="Global PSP [W/m^2]"
    )
    weather = read_measured(
        path,
        columns=columns,
        site=GOLDEN,
        time_format="%m/%d/%Y %H:%M",
        stands_for="end",
    )
    assert (len(weather), weather.step_minutes) == (1440, 1)
    rows = path.read_text().splitlines()[1:]
    level = np.array([row.split(",")[2] for row in rows], float).clip(0)
    sun = sun_of(weather)
    ours = weather.diffuse_horizontal + weather.direct_normal * np.sin(
        sun.altitude.clip(0)
    )
    up = sun.altitude > 0
    np.testing.assert_allclose(ours[up], level[up], atol=1e-9)


SURFRAD = " Testville\n   37.70  105.92 2317 m version 1\n"
SURFRAD_ROW = " 2016   1  1  1 {hour} 0 {hour}.0 60 " + "100.0 0 " * 20 + "\n"


def test_a_damaged_network_file_is_an_input_error(tmp_path):
    path = tmp_path / "a.dat"
    rows = "".join(SURFRAD_ROW.format(hour=hour) for hour in (18, 19, 20))
    for text in ("", "hello\n", SURFRAD, SURFRAD + "1 2 3\n", SURFRAD + rows + "x y\n"):
        path.write_text(text)
        with pytest.raises(InputError) as caught:
            read_surfrad(path)
        assert str(caught.value).startswith(f"{path}:")
        with pytest.raises(InputError):
            read_srml(path, site=EUGENE)
    path.write_text(SURFRAD + rows)
    assert read_weather(path).direct_normal.tolist() == [100.0] * 3


@pytest.mark.parametrize(("line", "header", "cells"), [(2, 6, 4006), (1, 40_000, 6)])
def test_an_srml_file_of_too_many_columns_is_refused(tmp_path, line, header, cells):
    """pvlib takes minutes, and takes the first cells of longer lines as labels."""
    path = tmp_path / "a.txt"
    rows = ["94255\t2018" + "\t1000\t0" * (header // 2 - 1)]
    rows += ["1\t1200" + "\t300\t12" * (cells // 2 - 1)]
    path.write_text("\n".join(rows))
    message = f"txt:{line}: {max(header, cells)} columns"

    def read():
        with pytest.raises(InputError, match=message):
            read_srml(path, site=EUGENE)

    assert least_processor_time(read) < 2


def test_an_address_is_not_fetched():
    with pytest.raises(InputError, match="cannot be read"):
        read_surfrad("https://example.org/surfrad.dat")
