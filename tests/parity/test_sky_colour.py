"""Colour of sky patches against `gendaylit -C`, by the authors of the default model."""

import io

import numpy as np
import pytest
from radiance import run

from clerestory.sky.daylight_spectra import sky_colour_temperature
from clerestory.spectral.colour_temperature import colour_temperature

# RGB from X, Y and Z in perezlum_c.cal
RGB = [
    [2.5693, -1.1668, -0.3984],
    [-1.0221, 1.9783, 0.0438],
    [-0.0747, -0.2519, 1.1772],
]


def directions():
    """Directions over the dome, from 12° to 84° of altitude."""
    altitude = np.radians(np.repeat([12, 30, 48, 66, 84], 6))
    azimuth = np.radians(np.tile(np.arange(0, 360, 60), 5) + 7)
    across = np.cos(altitude) * np.array([np.sin(azimuth), np.cos(azimuth)])
    return np.column_stack([*across, np.sin(altitude)])


@pytest.mark.parametrize("irradiance", ["800 100", "850 70", "0 200"])
def test_colour_temperatures_are_those_of_gendaylit(tmp_path, irradiance):
    """At Radiance's luminances; it has its own daylight locus, near that of the CIE.

    gendaylit has no colours for intermediate skies (1.065 < ε < 4.5).
    """
    text = run(f"gendaylit -ang 40 -20 -W {irradiance} -O 2 -C", folder=tmp_path)
    clearness = float(text.split("skyfunc\n")[1].split()[-12])
    sky = "\nskyfunc glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 180\n"
    (tmp_path / "sky.rad").write_text(text + sky)
    run("oconv sky.rad > sky.oct", folder=tmp_path)
    rays = "".join(f"0 0 0 {x:g} {y:g} {z:g}\n" for x, y, z in directions())
    output = run("rtrace -h -ab 0 -w sky.oct", folder=tmp_path, stdin=rays)
    xyz = np.linalg.solve(np.array(RGB), np.loadtxt(io.StringIO(output)).T)
    luminance = xyz[1][:, None]
    found = sky_colour_temperature(luminance, np.array([clearness]))[:, 0]
    assert (clearness < 1.065) == (np.ptp(found) == 0)
    theirs = colour_temperature(xyz).kelvin
    inside = (found > 4000) & (found < 25_000)
    assert inside.sum() > 20
    np.testing.assert_allclose(found[inside], theirs[inside], rtol=0.01)
