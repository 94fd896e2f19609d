"""Station files describe files of measurements."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.sky.csv_measurements import Columns, read_measured
from clerestory.sky.weather import Site
from clerestory.sky.weather_formats import read_weather
from sample_files import ROOF, STATION


@pytest.fixture
def station(tmp_path):
    (tmp_path / "roof.csv").write_text(ROOF)

    def write(text):
        path = tmp_path / "roof.toml"
        path.write_text(text)
        return path

    return write


def test_a_station_file_reads_as_its_arguments(station, tmp_path):
    weather = read_weather(station(STATION))
    truth = read_measured(
        tmp_path / "roof.csv",
        columns=Columns(("day", "clock"), "GHI", "DHI"),
        site=Site(50.0, 8.5, 1.0, place="roof"),
        stands_for="end",
        separator=";",
    )
    assert (weather.place, weather.step_minutes) == ("roof", 5)
    np.testing.assert_array_equal(weather.times, truth.times)
    np.testing.assert_array_equal(weather.direct_normal, truth.direct_normal)


FAULTS = {
    "not TOML": ("file =", "file", "not TOML"),
    "unknown key": ("stands_for", "stand_for", 'unknown key "stand_for"; one of'),
    "no latitude": ("latitude_deg", "latitude", "site.latitude_deg is missing"),
    "a word": ("8.5", '"west"', 'site.longitude_deg is "west"; a number'),
    "another moment": ('"end"', '"late"', 'stands_for is "late"'),
    "no columns": ("[columns]", "[column]", "column"),
    "another format": ("[site]", 'format = "x"\n[site]', 'format is "x"'),
    "columns of SRML": ("[site]", 'format = "srml"\n[site]', "no table [columns]"),
    "off the globe": ("50.0", "95.0", "latitude_deg is 95.0; a number of at most 90"),
    "no file": ("roof.csv", "wall.csv", "wall.csv: cannot be read"),
    "no such column": ('"GHI"', '"GLO"', "roof.csv:1: no column 'GLO'"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_station_file_is_one_line(station, fault):
    old, new, message = FAULTS[fault]
    assert old in STATION
    with pytest.raises(InputError) as caught:
        read_weather(station(STATION.replace(old, new)))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert ".toml" in str(caught.value) or ".csv" in str(caught.value)


def test_networks_have_columns_of_their_own(station, shared_data):
    folder = shared_data / "irradiance"
    site = STATION[STATION.index("[site]") : STATION.index("[columns]")]
    for format_, name in (
        ("srml", "SRML-day-EUPO1801.txt"),
        ("surfrad", "surfrad-slv16001.dat"),
    ):
        text = f'file = "{folder / name}"\nformat = "{format_}"\n{site}'
        with pytest.warns(UserWarning, match="W/m|zero|missing|night|below"):
            assert len(read_weather(station(text))) == 1440
