"""Five-minute measurements through the whole chain: study, results, report."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from clerestory.sky.weather_formats import read_weather

DATA = Path(__file__).parents[1] / "data"
STATION = """\
file = "roof_5min.csv"
stands_for = "end"

[site]
latitude_deg = 51.5
longitude_deg = 0.0
utc_offset_hours = 0
place = "roof"

[columns]
time = "time"
global_horizontal = "global [W/m²]"
diffuse_horizontal = "diffuse [W/m²]"
dew_point = "dew point [°C]"
"""


def study_under(weather):
    """Let the study of the room have other weather, and no .ill of whole hours."""
    text = Path("study.toml").read_text()
    text = text.replace('file = "two_days.wea"', weather).replace("ill = true", "")
    Path("study.toml").write_text(text)


@pytest.fixture
def roof(room):
    """Measurements beside the study, and a station file."""
    shutil.copy(DATA / "roof_5min.csv", room)
    Path("roof.toml").write_text(STATION)


def test_the_station_is_described_with_its_repairs(call, roof):
    outcome = call("sky", "describe", "roof.toml")
    assert outcome.status == 0
    assert "288 of 5 min, 2022-06-21T00:02 to 2022-06-21T23:57" in outcome.out
    assert "just below zero set to zero" in outcome.out
    assert "2 of 288 values missing or impossible, interpolated" in outcome.out
    assert len([w for w in outcome.err.splitlines() if "warning" in w]) == 1


def test_measured_days_run_through_the_whole_study(call, roof):
    study_under('file = "roof.toml"')
    outcome = call("run", "study.toml")
    assert outcome.status == 0, outcome.err
    assert Path("study_results/report.html").is_file()
    with xr.open_dataset("study_results/results.nc") as results:
        assert results.sizes["time"] == 288
        lux = results["illuminance"].values
    assert np.all(np.isfinite(lux) & (lux >= 0))

    # Sensors follow the measured light: brighter outside, brighter inside
    weather = read_weather_quietly("roof.toml")
    light = weather.direct_normal + weather.diffuse_horizontal
    assert np.corrcoef(lux.mean(axis=0), light)[0, 1] > 0.5
    assert np.all(lux[:, light == 0] == 0)


def read_weather_quietly(path):
    with pytest.warns(UserWarning, match="set to zero"):
        return read_weather(path)


def test_a_network_file_runs_through_the_whole_study(call, shared_data):
    """A clear winter day in the mountains, every minute."""
    path = shared_data / "irradiance" / "surfrad-slv16001.dat"
    study_under(f'file = "{path}"')
    assert call("run", "study.toml", "--quiet").status == 0
    with xr.open_dataset("study_results/results.nc") as results:
        lux = results["illuminance"]
        assert results.sizes["time"] == 1440
        assert float(lux.sel(time=slice("2016-01-01T12", "2016-01-01T13")).min()) > 0
        assert float(lux.sel(time=slice("2015-12-31T20", "2016-01-01T04")).max()) == 0


def test_satellite_data_in_five_minutes_run_through_the_whole_study(call, shared_data):
    path = shared_data / "irradiance" / "test_psm3_2019_5min.csv"
    station = STATION.replace('"roof_5min.csv"', f'"{path}"')
    station = station.replace("51.5", "40.5").replace("0.0", "-108.5")
    station = station.replace("hours = 0", "hours = -7").replace('"end"', '"centre"')
    for ours, theirs in (
        ('time = "time"', 'time = ""'),
        ("global [W/m²]", "GHI"),
        ("diffuse [W/m²]", "DHI"),
        ("dew point [°C]", "Dew Point"),
    ):
        station = station.replace(ours, theirs)
    Path("nsrdb.toml").write_text(station)
    study_under('file = "nsrdb.toml"')
    outcome = call("run", "study.toml", "--quiet")
    assert outcome.status == 0, outcome.err
    with xr.open_dataset("study_results/results.nc") as results:
        assert results.sizes["time"] == 288
        assert float(results["illuminance"].max()) > 100


def test_a_study_may_say_itself_how_measurements_are_read(call, roof):
    """The keys of the station file, in the table of the weather."""
    inline = STATION.replace('file = "roof_5min.csv"', "[weather.measured]")
    for table in ("site", "columns"):
        inline = inline.replace(f"[{table}]", f"[weather.measured.{table}]")
    study_under(f'file = "roof_5min.csv"\n{inline}')
    assert call("run", "study.toml", "--quiet").status == 0
    with xr.open_dataset("study_results/results.nc") as results:
        inside = results["illuminance"].values
    text = Path("study.toml").read_text()
    Path("study.toml").write_text(text.replace("latitude_deg", "latitud"))
    outcome = call("run", "study.toml")
    assert outcome.status == 2
    assert "study.toml:" in outcome.err
    assert "latitude_deg" in outcome.err
    assert np.all(np.isfinite(inside))
