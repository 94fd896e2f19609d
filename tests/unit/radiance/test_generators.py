"""Generators end in primitives or in one line, whatever their words."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.catalogue import GENERATORS
from clerestory.radiance.generators.sun_place import read_moment


def primitives(command):
    program, *words = command.split()
    return {i.name: i for i in GENERATORS[program](WordReader(words, program), Path)}


def polygons(command):
    return [np.reshape(i.reals, (-1, 3)) for i in primitives(command).values()]


def test_a_box_is_closed():
    """Its areas as vectors cancel, and its volume is that of its parts."""
    total, volume = np.zeros(3), 0.0
    for corner in polygons("genbox grey b 1 2 3 -b .25"):
        for i in range(1, len(corner) - 1):
            spokes = corner[i] - corner[0], corner[i + 1] - corner[0]
            area = np.cross(*spokes) / 2
            total += area
            volume += corner[0] @ area / 3
    np.testing.assert_allclose(total, 0, atol=1e-12)
    # A core, six slabs, twelve edges and eight corners
    d, inner = 0.25, np.array([1, 2, 3]) - 0.5
    slabs = 2 * d * inner.prod() * (1 / inner).sum()
    edges, corners = 4 * inner.sum() * d**2 / 2, 8 * d**3 / 6
    assert volume == pytest.approx(inner.prod() + slabs + edges + corners)


def test_inside_out_boxes_face_inwards():
    inward = primitives("genbox grey b 1 1 1 -r .1 -i")
    assert {item.kind for item in inward.values()} == {"polygon", "tube", "bubble"}


def test_blinds_have_the_depth_that_was_asked_for():
    """Flat slats at 30°: 20 polygons of depth × width."""
    corner = np.stack(polygons("genblinds grey b .06 2 1.5 20 30"))
    assert len(corner) == 20
    size = np.linalg.norm(corner[:, 1] - corner[:, 2], axis=1)
    np.testing.assert_allclose(size, 0.06)
    rise = corner[:, 2, 2] - corner[:, 1, 2]
    np.testing.assert_allclose(rise, 0.06 * np.sin(np.radians(30)))


@pytest.mark.parametrize(
    ("hour", "expected"),
    [("9", 9), ("9.5", 9.5), ("9:30", 9.5), ("+12", 12), ("14:15CET", 14.25)],
)
def test_hours_are_read(hour, expected):
    moment = read_moment(WordReader(["6", "21", hour], "gensky"))
    assert moment.hour == expected
    assert moment.solar == hour.startswith("+")


def test_the_sun_stands_due_south_at_solar_noon():
    """On 21 June at 47° north it is 66.4° high, by date and by almanac."""
    for year in ("", " -y 2021"):
        sun = primitives(f"gensky 6 21 +12 -a 47 -o 0 -m 0{year}")["sun"].reals
        assert sun[0] == pytest.approx(0, abs=1e-9)
        assert sun[1] < 0
        assert np.degrees(np.arcsin(sun[2])) == pytest.approx(66.44, abs=0.05)


def test_given_levels_of_the_sky_are_reached():
    """-B gives the irradiance of the overcast sky: 7π/9 of the zenith's radiance."""
    sky = primitives("gensky 3 1 12 -c -B 70 -a 47 -o -11 -m -15")["skyfunc"].reals
    assert sky[1] == pytest.approx(70 / (7 / 9 * np.pi))
    assert sky[2] == pytest.approx(0.2 * 70 / np.pi)


def test_the_sky_is_black_without_light():
    with pytest.warns(ClerestoryWarning, match="the sky is black"):
        made = primitives("gendaylit 12 21 22 -W 0 0 -a 47 -o -11 -m -15")
    assert set(made) == {"skyfunc"}
    assert made["skyfunc"].reals[:2] == (0, 0)


WORDS = (
    "grey b 1 2 3 .5 0 -1 1e9 1e-9 -i -b -r -e -c -l -ang +12 9:30 12CET -s +s -u -i +i"
    " -g -t -B -R -a -o -m -y 2020 -W -L -G -E -P -O 99 s t x^2 1/t sin(t) -f -n # é"
)
PIECES = st.sampled_from(WORDS.split())
PROGRAMS = st.sampled_from(sorted(GENERATORS))
STARTS = {
    "gensky": "6 21 12",
    "gendaylit": "6 21 12",
    "genbox": "grey b 1 2 3",
    "genblinds": "grey b .1 1 1 4",
    "genprism": "grey p 3 0 0 1 0 1 1",
    "gensurf": "grey s s t s*t 3 3",
    "genrev": "grey r t 1 3",
    "genworm": "grey w 0 0 t .1 3",
    "ies2rad": "",
}


@settings(max_examples=200, suppress_health_check=list(HealthCheck), deadline=None)
@given(PROGRAMS, st.booleans(), st.lists(PIECES, max_size=14))
def test_any_words_are_run_or_refused(program, started, words):
    begin = STARTS[program].split() if started else []

    def find(name):
        raise InputError(f'the file "{name}" is missing')

    message = ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ClerestoryWarning)
            made = GENERATORS[program](WordReader(begin + words, program), find)
        assert all(np.isfinite(item.reals).all() for item in made)
    except InputError as error:
        message = str(error)
    assert "\n" not in message
