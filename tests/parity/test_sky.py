"""Sky matrices against Radiance's gendaymtx, patch by patch."""

import re

import numpy as np
import pytest

pytest.importorskip("pyradiance")
from gendaymtx import epw_to_wea, gendaymtx

from clerestory.sky.sky_conditions import daylight_steps
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.sky.weather_formats import read_weather
from clerestory.sky.weather_selection import select_moment

# The weather is random, and one file of the world has light at night
pytestmark = pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")

# Days in which sun and sky differ; longitude 8.5° E, one row per hour.
HEADER = """\
place Testville
latitude {latitude}
longitude -8.5
time_zone -15
site_elevation 110
weather_data_file_units 1
"""


def assert_same_sky(ours: np.ndarray, theirs: np.ndarray) -> None:
    """Every patch within 0.5 % or 10⁻³ of the dome's mean, nearly all far within."""
    mean = theirs[:, 1:].mean(axis=1, keepdims=True)
    difference = np.abs(ours - theirs)
    allowed = np.maximum(0.005 * theirs, 1e-3 * mean) + 1e-7
    assert np.all(difference <= allowed)
    assert np.mean(difference <= allowed / 20) > 0.999


@pytest.fixture(scope="module", params=[65.0, 47.0, -12.0])
def wea(request, tmp_path_factory):
    """Twenty days of a year with irradiance from 0 to 1000 W/m², drawn at random."""
    random = np.random.default_rng(11)
    days = {1: 5, 2: 11, 3: 21, 4: 9, 6: 21, 8: 2, 10: 17, 11: 30, 12: 22}
    rows = []
    for month, day in days.items():
        for hour in np.arange(0.5, 24):
            direct = random.choice([0, 30, 150, 400, 950]) * (4 < hour < 21)
            diffuse = random.choice([0, 10, 60, 180, 400]) * (4 < hour < 21)
            rows.append(f"{month} {day} {hour} {direct} {diffuse}")
    path = tmp_path_factory.mktemp("wea") / "random.wea"
    path.write_text(HEADER.format(latitude=request.param) + "\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize("subdivision", [1, 2, 3, 4, 5, 6])
def test_every_patch_equals_gendaymtx(wea, subdivision):
    sky = sky_matrix(read_weather(wea), subdivision=subdivision, sun_formula="radiance")
    assert_same_sky(sky.values, gendaymtx(wea, "-m", str(subdivision)))


def test_a_sky_at_a_moment_equals_that_of_gendaymtx_at_this_moment(wea, tmp_path):
    """At 12:00, between the steps 11:30 and 12:30 of the file: the sun stands at 12:00,
    with the irradiance of the step from 12:00 to 13:00."""
    head, rows = wea.read_text().split("units 1\n")
    (row,) = (line for line in rows.splitlines() if line.startswith("6 21 12.5"))
    row = row.replace("12.5", "12.0")
    (tmp_path / "noon.wea").write_text(f"{head}units 1\n{row}\n")
    noon = select_moment(read_weather(wea), "06-21 12:00")
    sky = sky_matrix(noon, subdivision=2, sun_formula="radiance")
    theirs = gendaymtx(tmp_path / "noon.wea", "-m", "2")
    assert_same_sky(sky.values, theirs)


OPTIONS = [
    ("-d", {"include": "sun"}),
    ("-s", {"include": "sky"}),
    ("-g .1 .35 .02", {"ground_reflectance": (0.1, 0.35, 0.02)}),
    ("-c 1 .9 .7", {"sky_colour": (1, 0.9, 0.7)}),
    ("-r 33", {"rotation_deg": 33}),
    ("-r -100", {"rotation_deg": -100}),
    ("-O1", {"spectrum": "solar"}),
    ("-d -5 .533", {"include": "sun", "sun": "disc"}),
    ("-5 .533", {"sun": "disc"}),
    ("-5 6", {"sun": "disc", "sun_diameter_deg": 6.0}),
]


@pytest.mark.parametrize(("options", "arguments"), OPTIONS)
def test_options_mean_the_same(wea, options, arguments):
    sky = sky_matrix(
        read_weather(wea), subdivision=2, sun_formula="radiance", **arguments
    )
    assert_same_sky(sky.values, gendaymtx(wea, "-m", "2", *options.split()))


def test_the_mean_sky_equals_gendaymtx(wea):
    sky = sky_matrix(read_weather(wea), subdivision=2, sun_formula="radiance").mean()
    assert_same_sky(sky.values, gendaymtx(wea, "-m", "2", "-A"))


@pytest.mark.parametrize("options", [["-u"], ["-u", "-A"]])
def test_the_sky_of_daylight_equals_gendaymtx(wea, options):
    """-u leaves out the steps in which no part of the sun is up."""
    weather = daylight_steps(read_weather(wea), sun_formula="radiance")
    sky = sky_matrix(weather, subdivision=2, sun_formula="radiance")
    sky = sky.mean() if "-A" in options else sky
    assert_same_sky(sky.values, gendaymtx(wea, "-m", "2", *options))


def test_exact_suns_equal_the_sources_of_gendaymtx(wea, tmp_path):
    """gendaymtx -D writes one source a step with the sun up, some of them black."""
    file = tmp_path / "suns.rad"
    gendaymtx(wea, "-n", "-D", str(file))
    text = file.read_text()
    radiance = np.array(re.findall(r"\n3 (\S+) \S+ \S+\n", text), dtype=float)
    vectors = re.findall(r"\n4 (\S+) (\S+) (\S+) 0.533", text)
    bright = radiance > 0
    suns = sun_matrix(read_weather(wea), sun_formula="radiance", dew_point_c=11)
    ours = np.asarray(suns.radiance().sum(axis=1)).ravel()
    np.testing.assert_allclose(ours, radiance[bright], rtol=1e-3)
    theirs = np.array(vectors, dtype=float)[bright]
    np.testing.assert_allclose(suns.directions, theirs, atol=2e-6)


CLIMATES = [
    "Oslo",
    "NLD_Amsterdam062400_IWEC",
    "barcelona",
    "denver",
    "mannheim",
    "chicago",
]


@pytest.mark.parametrize("climate", CLIMATES)
def test_a_year_of_each_climate_equals_gendaymtx(shared_data, tmp_path, climate):
    epw = shared_data / "weather" / f"{climate}.epw"
    wea = tmp_path / "year.wea"
    epw_to_wea(epw, wea)
    sky = sky_matrix(read_weather(wea), subdivision=1, sun_formula="radiance")
    assert_same_sky(sky.values, gendaymtx(wea, "-m", "1"))


def test_the_epw_itself_gives_the_same_as_its_wea(shared_data, tmp_path):
    """epw2wea rounds irradiance to whole watts."""
    epw = shared_data / "weather" / "geneva.epw"
    wea = tmp_path / "year.wea"
    epw_to_wea(epw, wea)
    sky = sky_matrix(read_weather(epw), subdivision=1, sun_formula="radiance")
    theirs = gendaymtx(wea, "-m", "1")
    for receiver in (
        sky.partition.solid_angles(),
        sky.partition.centres()[:, 2].clip(0),
    ):
        ours = receiver @ sky.values[1]
        np.testing.assert_allclose(ours, receiver @ theirs[1], rtol=2e-3, atol=2)


def test_the_default_differs_from_gendaymtx_only_as_stated(wea):
    """With patch centres for the cosine, gendaymtx's sky sends cos(δ/2) of the diffuse.

    δ = 90°/7.5 is the height of a row of MF 1; the true projected solid angle of a
    row's patch is that at its centre times cos(δ/2), 0.55 % less.
    """
    weather = read_weather(wea)
    sky = sky_matrix(
        weather, subdivision=1, include="sky", sky_colour=(1, 1, 1), spectrum="solar"
    )
    theirs = gendaymtx(wea, "-m", "1", "-s", "-O1", "-c", "1", "1", "1")
    projected = sky.partition.dome.projected_solid_angles()
    loss = np.cos(np.radians(90 / 7.5) / 2)
    diffuse = weather.diffuse_horizontal
    np.testing.assert_allclose(projected @ sky.values[0, 1:], diffuse, rtol=1e-5)
    np.testing.assert_allclose(projected @ theirs[0, 1:], loss * diffuse, rtol=3e-4)
