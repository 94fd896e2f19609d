"""Texts of skies as commands of gensky and gendaylit."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.radiance.generated_sky import sky_scene
from clerestory.recipes.sky_text import sky_command

CHICAGO = "-lat 41.78 -lon -87.75 -tz -6"


def sun(command):
    [found] = [s for s in sky_scene(command).distant if s.name in ("sun", "solar")]
    return found.direction


@pytest.mark.parametrize(
    ("text", "command"),
    [
        (f"cie 21 Jun 12:00 {CHICAGO} -type 0", "gensky 6 21 12 +s"),
        (f"cie 9 Mar 15:30 {CHICAGO} -type 0", "gensky 3 9 15.5 +s"),
    ],
)
def test_the_sun_is_where_gensky_has_it(text, command):
    """gensky takes longitude and meridian positive west."""
    given = f"{command} -a 41.78 -o 87.75 -m 90"
    assert np.allclose(sun(sky_command(text)), sun(given), atol=1e-5)


def test_north_turns_the_sun():
    """North 90° counter-clockwise from +y is -x: a sun in the south is in +x."""
    east = sun(sky_command("cie -alt 30 -az 180 -n 90"))
    assert np.allclose(east, [np.cos(np.pi / 6), 0, 0.5], atol=1e-6)
    south = sun(sky_command("climate-based -alt 30 -az 180 -dni 500 -dhi 50"))
    assert np.allclose(south, [0, -np.cos(np.pi / 6), 0.5], atol=1e-6)


def test_time_without_zone_is_solar_time():
    noon = sun(sky_command("cie 5 Nov 12:00 -lat 50 -lon 170"))
    assert noon[0] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "kind of sky is ''; one of cie"),
        ("sunny", "kind of sky is 'sunny'"),
        ("cie -alt 20", "lacks -az; a number expected"),
        ("cie 21 Foo 12:00 -lat 3 -lon 4", "time of the sky is"),
        ("cie 21 -lat 3 -lon 4 -g 0", "time of the sky is"),
        ("cie 21 Jun 25:00 -lat 3 -lon 4", 'such as "21 Jun 12:00" expected'),
        ("cie 21 Jun 1:00 -lat 50 -lon 4", "the sun is below the horizon"),
        ("cie -alt 20 -az", "lacks a value; a number expected"),
        ("cie -alt 200 -az 3", "-alt is 200"),
        ("cie -alt x -az 3", "-alt of the sky is 'x'; a number expected"),
        ("cie -alt 20 -az 3 -dni 3", "option of the sky is '-dni'"),
        ("climate-based -alt 20 -az 3 -dni 3", "lacks -dhi"),
        ("illuminance", "lacks a value"),
        ("irradiance nan", "irradiance is nan"),
    ],
)
def test_unknown_skies_are_refused(text, message):
    with pytest.raises(InputError) as caught:
        sky_command(text)
    assert message in str(caught.value)
