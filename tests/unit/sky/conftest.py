"""Small weather files and values, written by the recipe in each fixture."""

import numpy as np
import pytest

from clerestory.sky.weather import Weather

EPW_HEADER = """\
LOCATION,Testville,-,DEU,made,000000,50.0,8.5,1.0,110.0
DESIGN CONDITIONS,0
TYPICAL/EXTREME PERIODS,0
GROUND TEMPERATURES,0
HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0
COMMENTS 1,made for tests
COMMENTS 2,
DATA PERIODS,1,1,Data,Sunday, 3/21, 3/21
"""
WEA_HEADER = """\
place Testville_DEU
latitude 50.0
longitude -8.5
time_zone -15
site_elevation 110
weather_data_file_units 1
"""
TMY3_HEADER = """\
722000,"TESTVILLE",NC,-5.0,36.100,-79.950,273
Date (MM/DD/YYYY),Time (HH:MM),DNI (W/m^2),DHI (W/m^2),Dew-point (C)
"""


def epw_row(
    hour, direct="300", diffuse="120", *, month=3, day=21, dew="4.5", minute=60
):
    cells = ["1999", month, day, hour, minute, "?9", "9.0", dew, "70", "101000"]
    cells += ["0", "0", "300", "250", direct, diffuse, "0", "0", "0", "0"]
    return ",".join(map(str, cells))


@pytest.fixture
def write_epw(tmp_path):
    def write(rows=None, header=EPW_HEADER):
        rows = [epw_row(hour) for hour in range(1, 25)] if rows is None else rows
        path = tmp_path / "test.epw"
        path.write_text(header + "\n".join(rows) + "\n")
        return path

    return write


@pytest.fixture
def write_wea(tmp_path):
    def write(rows=("3 21 11.5 300 120", "3 21 12.5 310 121"), header=WEA_HEADER):
        path = tmp_path / "test.wea"
        path.write_text(header + "\n".join(rows) + "\n")
        return path

    return write


@pytest.fixture
def write_tmy3(tmp_path):
    def write(rows=("03/21/1990,11:00,300,120,4.5",), header=TMY3_HEADER):
        path = tmp_path / "test.csv"
        path.write_text(header + "\n".join(rows) + "\n")
        return path

    return write


@pytest.fixture
def spring_day():
    """Weather of 21 March at 50° N, 15 min steps, skies from clear to overcast."""
    times = np.datetime64("2023-03-21", "s") + np.arange(450, 86400, 900)
    hour = np.arange(450, 86400, 900) / 3600
    height = np.maximum(np.sin((hour - 6.3) / 12 * np.pi), 0) * (
        (hour > 6) & (hour < 18)
    )
    cloud = 0.5 + 0.5 * np.sin(hour * 1.7)
    return Weather(
        place="Testville",
        latitude_deg=50.0,
        longitude_deg=8.5,
        elevation=110.0,
        utc_offset_hours=1.0,
        times=times,
        step_minutes=15.0,
        direct_normal=850 * np.sqrt(height) * (1 - cloud),
        diffuse_horizontal=40 * (height > 0) + 300 * height * cloud,
    )
