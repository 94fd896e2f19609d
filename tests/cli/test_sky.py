"""`clerestory sky`, on two days of weather."""

from pathlib import Path

import numpy as np
import pytest

from clerestory.matrix.netcdf import read_netcdf
from clerestory.matrix.radiance_format import read_matrix
from clerestory.sky.sky_conditions import daylight_steps
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather

MATRIX = "sky matrix two_days.wea --subdivision 1 --format double -o S.smx"


def sky(call, words):
    return call("sky", *words.split())


def matrix(call, options=""):
    outcome = call(*f"{MATRIX} {options}".split())
    assert outcome.status == 0, outcome.err
    return read_matrix("S.smx").values


@pytest.mark.parametrize("command", ["matrix", "vector", "sun", "describe", "plot"])
def test_every_sky_command_has_help_with_an_example(call, command):
    outcome = call("sky", command, "--help")
    assert outcome.status == 0
    assert f"Example: clerestory sky {command}" in " ".join(outcome.out.split())


def test_header_names_weather_place_and_options(call):
    call(*f"{MATRIX} --sun-formula radiance --no-direct".split())
    header = Path("S.smx").read_bytes().split(b"\n\n")[0].decode().splitlines()
    command = "sky matrix two_days.wea --subdivision 1 --format double -o S.smx"
    assert (
        header[1].strip() == f"clerestory {command} --sun-formula radiance --no-direct"
    )
    given = dict(line.split("= ", 1) for line in header if "= " in line)
    weather = read_weather("two_days.wea")
    assert given["PLACE"] == weather.place
    assert given["LATLONG"] == f"{weather.latitude_deg} {weather.longitude_deg}"
    assert given["SOURCE"].endswith("two_days.wea")
    assert given["SUN_FORMULA"] == "radiance"
    assert given["INCLUDE"] == "sky"


def test_help_says_what_the_formula_of_the_sun_changes(call):
    """Not the solar position alone."""
    text = " ".join(call("sky", "matrix", "--help").out.replace("│", " ").split())
    for part in ("sunrise or sunset", "centre of each patch", "dew point of 11"):
        assert part in text


OPTIONS = [
    ("", {}),
    ("--sun-only", {"include": "sun"}),
    ("--no-direct", {"include": "sky"}),
    ("--sun-size 0", {"sun": "patch"}),
    ("--sun-size 0.533", {"sun": "disc", "sun_diameter_deg": 0.533}),
    ("--sun-size 6", {"sun": "disc", "sun_diameter_deg": 6.0}),
    ("--sun-formula radiance", {"sun_formula": "radiance"}),
    ("--rotation 30", {"rotation_deg": 30.0}),
    ("--ground 0.3", {"ground_reflectance": 0.3}),
    ("--ground-reflectance .1,.2,.05", {"ground_reflectance": (0.1, 0.2, 0.05)}),
    ("--sky-colour 1,.9,.7", {"sky_colour": (1, 0.9, 0.7)}),
    ("--solar", {"spectrum": "solar"}),
]


@pytest.mark.parametrize(("options", "arguments"), OPTIONS)
def test_options_are_the_arguments_in_python(call, options, arguments):
    found = matrix(call, options)
    truth = sky_matrix(read_weather("two_days.wea"), subdivision=1, **arguments)
    np.testing.assert_array_equal(found, truth.values.astype(float))


@pytest.mark.parametrize("name", ["S.smx", "S.nc"])
def test_luminance_is_one_number_a_patch(call, name):
    """179 lm/W times Radiance's weights of the three channels."""
    red, green, blue = matrix(call)
    outcome = sky(call, f"matrix two_days.wea --subdivision 1 --luminance -o {name} -q")
    assert outcome.status == 0
    found = (read_netcdf if name == "S.nc" else read_matrix)(name)
    expected = 179 * (0.265 * red + 0.670 * green + 0.065 * blue)
    np.testing.assert_allclose(found.values[0], expected, rtol=1e-6)
    assert len(found.values) == 1


def test_the_average_of_daylight_is_one_column(call):
    found = matrix(call, "--daylight-only --average")
    day = daylight_steps(read_weather("two_days.wea"))
    assert 10 < len(day.times) < 40
    truth = sky_matrix(day, subdivision=1).values.mean(axis=2, keepdims=True)
    np.testing.assert_allclose(found, truth, rtol=1e-5)


def test_a_clock_that_is_wrong_is_reported(call, room):
    """A year of clear days whose light comes three hours late."""
    hours = np.arange(8760)
    day, hour = hours // 24, hours % 24 + 0.5
    light = np.maximum(np.sin((hour - 9) / 12 * np.pi), 0) * 500
    month = np.datetime64("2023-01-01") + day
    rows = [
        f"{m[5:7]} {m[8:10]} {h} {v:.0f} {v / 4:.0f}"
        for m, h, v in zip(month.astype(str), hour, light, strict=True)
    ]
    head = "place late\nlatitude 40\nlongitude 0\ntime_zone 0\nsite_elevation 0\n"
    head += "weather_data_file_units 1\n"
    (room / "late.wea").write_text(head + "\n".join(rows) + "\n")
    outcome = sky(call, "sun late.wea -o suns.csv")
    assert outcome.status == 0
    assert "h late relative to the solar position" in outcome.err


def test_the_three_formats_and_netcdf_hold_the_same_sky(call):
    exact = matrix(call)
    for kind, error in (("ascii", 1e-8), ("float", 1e-7)):
        call(*f"{MATRIX} --format {kind}".split())
        np.testing.assert_allclose(read_matrix("S.smx").values, exact, rtol=error)
    sky(call, "matrix two_days.wea --subdivision 1 -o S.nc -q")
    found = read_netcdf("S.nc")
    np.testing.assert_allclose(found.values, exact, rtol=1e-7)
    assert found.rows.kind == "sky"
    assert len(found.rows.partition) == 146
    np.testing.assert_array_equal(
        found.columns.times, read_weather("two_days.wea").times
    )


def test_a_matrix_read_back_takes_its_axes(call):
    """Radiance's files do not say what they hold: the caller does."""
    matrix(call)
    truth = sky_matrix(read_weather("two_days.wea"), subdivision=1)
    back = read_matrix("S.smx", rows=truth.rows, columns=truth.columns)
    assert back.rows.fits(truth.rows)
    np.testing.assert_array_equal(back.columns.times, truth.times)


def test_days_and_moments_are_columns_of_the_whole(call):
    whole = matrix(call)
    times = [str(time) for time in read_weather("two_days.wea").times]
    day = matrix(call, "--from 06-21 --to 06-21")
    assert day.shape == (3, 146, 24)
    np.testing.assert_allclose(day, whole[:, :, 24:], rtol=1e-5)
    outcome = call(*MATRIX.split(), "--time", "06-21 12:30")
    assert outcome.status == 0
    column = times.index("2023-06-21T12:30:00")
    noon = read_matrix("S.smx").values
    np.testing.assert_allclose(noon[:, :, 0], whole[:, :, column], rtol=1e-5)


def test_a_uniform_vector_is_the_same_everywhere(call):
    """A sky of π W/m² on the ground has a radiance of 1; the ground a fifth of it."""
    command = (
        "sky vector uniform --sun 40 180 --diffuse 3.14159265 --subdivision 1 -o S.vec"
    )
    assert call(*command.split(), "--format", "double").status == 0
    values = read_matrix("S.vec").values
    np.testing.assert_allclose(values[:, 1:, 0], 1, rtol=1e-6)
    np.testing.assert_allclose(values[:, 0, 0], 0.2, rtol=1e-6)


def test_a_perez_vector_sends_the_light_asked_for(call):
    """Visible irradiance on the ground, and from the sun, over the patches."""
    command = "sky vector perez --sun 40 180 --diffuse 90 --direct 400 -o S.nc -q"
    assert call(*command.split(), "--subdivision", "4").status == 0
    sent = read_netcdf("S.nc")
    dome = sent.rows.partition
    assert call(*command.split(), "--subdivision", "4", "--no-direct").status == 0
    sky_alone = read_netcdf("S.nc").values[:, :, 0] / [[0.960], [1.004], [1.118]]
    received = sky_alone[:, 1:] @ dome.dome.projected_solid_angles()
    np.testing.assert_allclose(received, 90, rtol=2e-3)
    whole = sent.values[:, :, 0] / [[0.960], [1.004], [1.118]]
    assert whole.max() > 3 * sky_alone.max()


def test_a_clear_vector_has_its_sun_by_default(call):
    command = "sky vector clear --sun 40 180 --direct 500 --subdivision 2 -o S.vec"
    call(*command.split())
    bright = read_matrix("S.vec").values
    call(*command.split(), "--no-direct")
    dark = read_matrix("S.vec").values
    assert bright.max() > 5 * dark.max()
    np.testing.assert_allclose(bright[:, 0], dark[:, 0])
    assert sky(call, "vector 12 --sun 40 180 --diffuse 90 -o S.vec").status == 0


def test_occurring_suns_are_those_with_light(call):
    sky(call, "sun two_days.wea --occurring -o suns.csv")
    rows = [line.split(",") for line in Path("suns.csv").read_text().splitlines()[1:]]
    assert 0 < len(rows) <= np.count_nonzero(read_weather("two_days.wea").direct_normal)
    table = np.array(rows, dtype=float)
    np.testing.assert_allclose(np.sin(np.radians(table[:, 0])), table[:, 4], atol=1e-5)
    assert np.all(table[:, 5] == 1)


def test_the_suns_of_the_finest_sky_are_5185(call):
    sky(call, "sun two_days.wea --reinhart 6 -o suns.csv")
    table = np.loadtxt("suns.csv", delimiter=",", skiprows=1)
    assert len(table) == 5185
    assert tuple(table[0, 1:3]) == (0.0, 0.0)  # the first stands in the north
    lit = np.count_nonzero(read_weather("two_days.wea").direct_normal)
    assert table[:, 5].sum() == lit


@pytest.mark.parametrize(
    ("options", "kind"), [("", "png"), ("--time 06-21T15:30", "svg")]
)
def test_plots_are_written_in_the_kind_of_their_name(call, options, kind):
    outcome = call(*f"sky plot two_days.wea {options} -o sky.{kind}".split())
    assert outcome.status == 0, outcome.err
    start = Path(f"sky.{kind}").read_bytes()[:8]
    assert start.startswith(b"\x89PNG" if kind == "png" else b"<?xml")


def test_a_description_lists_repairs_and_doubtful_values(call):
    text = Path("two_days.wea").read_text().replace("longitude 0", "longitude 90")
    Path("east.wea").write_text(text)
    outcome = call("sky", "describe", "east.wea")
    assert outcome.status == 0
    assert "kWh/m²" in outcome.out
    assert "doubtful" in outcome.out
    assert "below the horizon" in outcome.out


BAD = {
    "two parts": (f"{MATRIX} --sun-only --no-direct", "both --sun-only and"),
    "luminance of heat": (f"{MATRIX} --luminance --solar", "both --luminance and"),
    "time and days": (
        f"{MATRIX} --time 06-21T12:00 --from 01-01",
        "--time is given with --from",
    ),
    "no such day": (f"{MATRIX} --from 02-01 --to 02-02", "no weather from"),
    "not a day": (f"{MATRIX} --from 2-1", "MM-DD expected"),
    "no such moment": (f"{MATRIX} --time 02-01T12:00", "no weather at"),
    "two grounds": (f"{MATRIX} --ground 0.1,0.2", "one number or R,G,B expected"),
    "a word for the ground": (f"{MATRIX} --ground grass", "one number or R,G,B"),
    "unknown formula": (f"{MATRIX} --sun-formula noaa", "sun-formula"),
    "two suns": (
        "sky sun two_days.wea --occurring --reinhart 6 -o s.csv",
        "both --occ",
    ),
    "plot of another kind": ("sky plot two_days.wea -o sky.gif", ".png, .svg"),
    "dome at night": (
        "sky plot two_days.wea --time 06-21T00:30 -o s.png",
        "daytime step",
    ),
    "unknown sky": ("sky vector foggy --sun 40 0 -o S.vec", "unknown sky 'foggy'"),
    "perez without sun": (
        "sky vector perez --sun 40 0 --diffuse 9 -o S.vec",
        "is missing; both expected",
    ),
    "general sky without level": ("sky vector 3 --sun 40 0 -o S.vec", "sky 3 without"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line_and_writes_nothing(call, room, case):
    command, message = BAD[case]
    before = {path.name for path in room.iterdir()}
    outcome = call(*command.split())
    assert outcome.status == 2
    assert message in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert {path.name for path in room.iterdir()} == before
