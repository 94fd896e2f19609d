"""The steps that a study simulates: hours, moments, one of every few, clear skies."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.study.config import read_study
from clerestory.study.inputs import study_weather

DATA = Path(__file__).parents[2] / "data"
FILE = 'file = "two_days.wea"'

CLEAR = """
[weather.clear_sky]
latitude_deg = 47.27
longitude_deg = 11.39
utc_offset_hours = 1
step_minutes = 30
"""

ROOF = """file = "roof_5min.csv"
every = 6
[weather.measured]
stands_for = "end"
site = {latitude_deg = 50.0, longitude_deg = 8.5, utc_offset_hours = 1}
"""


def weather(study_file, keys):
    text = study_file.read_text()
    assert FILE in text
    study_file.write_text(text.replace(FILE, keys))
    return study_weather(read_study(study_file))


def stamps(found):
    return [str(time)[5:16] for time in found.times]


def test_hours_of_the_day_can_be_chosen(study_file):
    found = weather(study_file, f"{FILE}\nfrom_hour = 9\nto_hour = 12")
    hours = ["09:30", "10:30", "11:30"]
    assert stamps(found) == [f"06-{day}T{hour}" for day in (20, 21) for hour in hours]
    assert found.step_minutes == 60


def test_one_step_of_a_few_stands_for_all_of_them(study_file):
    found = weather(study_file, f"{FILE}\nevery = 4")
    assert stamps(found)[:3] == ["06-20T00:30", "06-20T04:30", "06-20T08:30"]
    assert found.step_minutes == 240


def test_moments_can_be_named(study_file):
    found = weather(study_file, f'{FILE}\nmoments = ["06-21T12:30", "06-20T09:30"]')
    assert stamps(found) == ["06-20T09:30", "06-21T12:30"]


def test_a_clear_day_needs_no_file(study_file):
    found = weather(study_file, f'from = "03-21"\nto = "03-21"\n{CLEAR}')
    assert len(found) == 48
    assert stamps(found)[24] == "03-21T12:15"
    assert 700 < found.direct_normal.max() < 1000


def test_five_minute_measurements_become_half_hours(study_file):
    shutil.copy(DATA / "roof_5min.csv", study_file.with_name("roof_5min.csv"))
    head = (DATA / "roof_5min.csv").read_text().splitlines()[0].split(",")
    columns = f'columns = {{time = "{head[0]}", global_horizontal = "{head[1]}"}}\n'
    table = ROOF + columns + "[schedule]\nfrom_hour = 0\nto_hour = 24"
    with pytest.warns(ClerestoryWarning, match="2 of 288 values missing"):
        found = weather(study_file, table)
    assert found.step_minutes == 30
    assert set(np.diff(found.times).astype(int).tolist()) <= {1800}


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (f'{FILE}\nmoments = ["06-21T12:00"]', "no step at 06-21T12:00"),
        (f"{FILE}\nfrom_hour = 9\nto_hour = 9.2", "no time step lies between 9 and"),
        ("from_hour = 9", 'neither "file" nor "clear_sky"'),
        (f"{FILE}\n{CLEAR}", 'both "file" and "clear_sky"'),
        (CLEAR.replace("30", "7"), "a divisor of 60 expected"),
        (CLEAR.replace("47.27", "97"), "at most 90"),
        (f"{FILE}\nfrom_hour = 9\nto_hour = 8", '"from_hour" is not before'),
        (f"{FILE}\nmoments = ['noon']", "a list of moments"),
    ],
)
def test_what_is_wrong_is_reported(study_file, keys, words):
    with pytest.raises(InputError) as caught:
        weather(study_file, keys)
    assert words in str(caught.value)
