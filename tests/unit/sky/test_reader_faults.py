"""Weather files with faults: one line that names the file, the line and the fault."""

import importlib.resources
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.sky.weather_formats import read_weather


def row(hour, direct=300, diffuse=120, *, month=3, day=21, dew=4.5, minute=60):
    cells = ["1999", month, day, hour, minute, "?9", "9.0", dew, "70", "101000"]
    cells += ["0", "0", "300", "250", direct, diffuse, "0", "0", "0", "0"]
    return ",".join(map(str, cells))


def day(**changes):
    return [row(hour, **changes) for hour in range(1, 25)]


TMY2_FAULTS = {
    "hour 25": (2, 7, "25", "hour 24.5"),
    "month 13": (2, 3, "13", "month 13"),
    "not a number": (3, 23, "12x4", "direct normal irradiance is '12x4'"),
    "time goes back": (3, 7, "01", "follows 2.*; increasing times expected"),
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


EPW_FAULTS = {
    "no number": ([row(1), row(2, direct="abc")], 10, "direct normal .* 'abc'"),
    "infinite": ([row(1), row(2, direct="inf")], 10, "'inf'; a number expected"),
    "short row": ([row(1), row(2)[:40]], 10, "fields; .* expected as field 15"),
    "month 13": ([row(1), row(2, month=13)], 10, "month 13, day 21; a date"),
    "30 February": ([row(1, month=2, day=30)], 9, "month 2, day 30; a date"),
    "day of fractions": ([row(1, day=1.5)], 9, "day 1.5; a date"),
    "hour 25": ([row(1), row(25)], 10, "hour 24.5; 0 to 24 expected"),
    "hour 0": ([row(0)], 9, "hour -0.5; 0 to 24 expected"),
    "time goes back": (
        [row(12), row(11)],
        10,
        "follows 2.*; increasing times expected",
    ),
    "an hour twice": ([row(12), row(12)], 10, "follows 2.*; increasing times expected"),
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
    "beyond the pole": (
        "50.0",
        "95.0",
        "latitude is 95 degrees; a number from -90 to 90",
    ),
    "wrong time zone": ("8.5,1.0", "8.5,60", "UTC offset is 60 h"),
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
        "'site_elevation' in the header; the key 'time_zone'",
    ),
    "unknown units": ("units 1", "units 4", 6, "units 4; 1 .direct normal"),
    "not a number": ("300 120", "3OO 120", 7, "direct normal irradiance is '3OO'"),
    "row cut short": ("310 121", "310", 8, "4 fields; diffuse"),
    "31 April": ("3 21 11.5", "4 31 11.5", 7, "month 4, day 31"),
    "hour 24.5": ("3 21 12.5", "3 21 24.5", 8, "hour 24.5"),
    "time goes back": (
        "3 21 12.5",
        "3 21 11.5",
        8,
        "follows 2.*; increasing times expected",
    ),
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
    ("text", "expected"),
    [
        *((text, "EPW, WEA, TMY2, TMY3 or SURFRAD") for text in
          ("", "\n", "hello\nworld\n", "Date,a,b\n1,2,3\n")),
        ("\0\1\2", "is binary, or not UTF-8; a text file expected"),
    ],
)  # fmt: skip
def test_a_file_of_another_kind_is_refused(tmp_path, text, expected):
    path = tmp_path / "thing.epw"
    path.write_text(text)
    with pytest.raises(InputError, match=expected):
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
