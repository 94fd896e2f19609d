"""Hours of sun of an opening, in closed form from the sun's declination.

With hour angle H, declination δ and latitude φ, the sun stands towards
south: cos δ cos H sin φ - sin δ cos φ, west: cos δ sin H,
up: cos δ cos H cos φ + sin δ sin φ. An hour is 15° of H.
"""

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.sky.solar_position import sun_at
from clerestory.sky.weather import Site
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.sunlight_exposure import sunlight

LATITUDE = np.radians(48.0)
LOWEST = np.radians(10.0)

# Minutes begin and end by the minute; refraction is 0.09° at 10°, half a minute
TOLERANCE = 2 / 60

WALL = """
void plastic wall 0 0 5 .5 .5 .5 0 0
wall polygon floor 0 0 12 -5 0 0  5 0 0  5 5 0  -5 5 0
"""
STUDY = """
method = "3-phase"
[scene]
files = ["scene.rad"]
[[window]]
file = "window.rad"
bsdf = "diffuser.xml"
[[sensors]]
file = "desk.pts"
[weather]
[weather.clear_sky]
latitude_deg = 48.0
longitude_deg = 15.0
utc_offset_hours = 1
[sky]
rotation_deg = {rotation}
[trace]
device = "{device}"
[sunlight]
day = "{day}"
{more}
"""
# Two metres wide and high; the point is at (0, 0, 1.2)
SOUTH = "void polygon pane 0 0 12 -1 0 0.5  -1 0 2.5  1 0 2.5  1 0 0.5\n"


@pytest.fixture
def hours(tmp_path, diffuser, device):
    """Hours of sun of the openings, and of the room, on a day behind obstructions."""

    def found(obstructions="", *, day="03-21", window=SOUTH, rotation=0, more=""):
        (tmp_path / "scene.rad").write_text(WALL + obstructions)
        (tmp_path / "window.rad").write_text(window)
        (tmp_path / "desk.pts").write_text("0 2 0.8 0 0 1\n")
        diffuser(tmp_path / "diffuser.xml")
        file = tmp_path / "study.toml"
        file.write_text(
            STUDY.format(day=day, rotation=rotation, device=device, more=more)
        )
        study = read_study(file)
        data = sunlight(study, read_inputs(study))
        return data["hours_of_sun"].values, float(data["room_hours_of_sun"])

    return found


@pytest.fixture
def diffuser():
    """Writer of some BSDF: what stands in the window does not matter."""
    return lambda path: write_bsdf(path, lambertian(0.5, klems("full")))


def declination(day):
    """Declination of the sun, from its greatest altitude at 48°, 42° + δ."""
    minutes = np.arange(600, 840).astype("timedelta64[m]")
    times = (np.datetime64(f"2023-{day}") + minutes).astype("datetime64[s]")
    sun = sun_at(Site(48, 15, 1), times)
    return float(sun.altitude.max() + LATITUDE - np.pi / 2)


def above(altitude, day):
    """Hour angle at which the sun stands at an altitude."""
    delta = declination(day)
    sine = np.sin(altitude) - np.sin(LATITUDE) * np.sin(delta)
    return float(np.arccos(sine / (np.cos(LATITUDE) * np.cos(delta))))


def to_hours(angle):
    return float(np.degrees(angle) / 15)


@pytest.mark.parametrize("day", ["02-01", "03-01", "03-21"])
def test_a_free_window_has_sun_from_the_least_altitude_on(hours, day):
    """Until the equinox the sun stays in front of a south wall all day."""
    expected = to_hours(2 * above(LOWEST, day))
    each, room = hours(day=day)
    assert each == pytest.approx([expected], abs=TOLERANCE)
    assert room == each[0]


def test_a_higher_least_altitude_leaves_less(hours):
    expected = to_hours(2 * above(np.radians(25), "03-21"))
    assert hours(more="lowest_sun_deg = 25")[1] == pytest.approx(
        expected, abs=TOLERANCE
    )


@pytest.mark.parametrize("day", ["02-01", "02-20"])
def test_an_overhang_hides_the_high_sun_around_noon(hours, day):
    """It hides what stands steeper than k = up / south, so the larger cos H."""
    steepness = 0.35 if day == "02-01" else 0.50
    depth = 1.3 / steepness  # the overhang lies 1.3 m above the point
    overhang = f"wall polygon o 0 0 12 -90 0 2.5  90 0 2.5  90 -{depth} 2.5 "
    overhang += f"-90 -{depth} 2.5\n"
    delta, k = declination(day), steepness
    up = np.cos(LATITUDE) - k * np.sin(LATITUDE)
    cosine = -np.tan(delta) * (np.sin(LATITUDE) + k * np.cos(LATITUDE)) / up
    hidden = float(np.arccos(cosine))
    assert 0.2 < hidden < above(LOWEST, day)
    expected = to_hours(2 * (above(LOWEST, day) - hidden))
    assert hours(overhang, day=day)[1] == pytest.approx(expected, abs=3 * TOLERANCE)


def test_a_house_opposite_hides_the_low_sun(hours):
    """The other way round: what stands flatter than k is hidden."""
    k, day = 0.40, "02-01"
    height = 1.2 + 20 * k
    house = f"wall polygon h 0 0 12 -900 -20 0  900 -20 0  900 -20 {height} "
    house += f"-900 -20 {height}\n"
    delta = declination(day)
    up = np.cos(LATITUDE) - k * np.sin(LATITUDE)
    cosine = -np.tan(delta) * (np.sin(LATITUDE) + k * np.cos(LATITUDE)) / up
    seen = float(np.arccos(cosine))
    assert 0.2 < seen < above(LOWEST, day)
    expected = to_hours(2 * seen)
    assert hours(house, day=day)[1] == pytest.approx(expected, abs=3 * TOLERANCE)


def test_a_fin_hides_the_afternoon(hours):
    """One metre to the west and two deep: sun from tan β = a / p west of south on."""
    fin = "wall polygon f 0 0 12 -1 0 -90  -1 0 90  -1 -2 90  -1 -2 -90\n"
    # At the equinox tan β = tan H / sin φ
    cut = np.arctan(0.5 * np.sin(LATITUDE))
    expected = to_hours(above(LOWEST, "03-21") + cut)
    assert hours(fin)[1] == pytest.approx(expected, abs=2 * TOLERANCE)


def test_clear_glass_hides_nothing_and_a_shutter_all(hours):
    sheet = "polygon s 0 0 12 -1 -0.05 0.5  1 -0.05 0.5  1 -0.05 2.5  -1 -0.05 2.5\n"
    clear = "void glass clear 0 0 3 .8 .8 .8\nclear " + sheet
    big = "wall polygon s 0 0 12 -9 -.05 -9  9 -.05 -9  9 -.05 9  -9 -.05 9\n"
    assert hours(clear)[1] == hours()[1]
    assert hours(big)[1] == 0


def test_openings_to_east_and_west_add_up(hours):
    """At the equinox each has one half of the day, and the room all of it."""
    east = "a polygon e 0 0 12 4 -1 0.5  4 -1 2.5  4 1 2.5  4 1 0.5\n"
    west = "b polygon w 0 0 12 -4 1 0.5  -4 1 2.5  -4 -1 2.5  -4 -1 0.5\n"
    each, room = hours(window=east + west)
    half = to_hours(above(LOWEST, "03-21"))
    assert each == pytest.approx([half, half], abs=2 * TOLERANCE)
    assert room == pytest.approx(2 * half, abs=2 * TOLERANCE)


def test_a_turned_scene_turns_the_sun(hours):
    """With +y to the east, the window in the south wall faces west."""
    half = to_hours(above(LOWEST, "03-21"))
    assert hours(rotation=90)[1] == pytest.approx(half, abs=2 * TOLERANCE)
