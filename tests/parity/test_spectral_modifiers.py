"""Spectral modifiers of scene files in 20 bands against `rtrace -cs 20`.

A sky of light of each spectrum, seen directly, and a plastic under a white sky.
"""

import numpy as np
import pytest
from radiance import run

import clerestory as cl

BANDS = cl.band_set("20")
TABLE = "2\n0 1 2\n420 660 5\n.1 .4 .9 .3 .2  .2 .6 .5 .4 .8\n"
FUNCTIONS = "wave(nm) = .5 + .3*sin(nm/A3);\ndim(v, nm) = v*(1 - nm/1000);\n"
SPECTRA = {
    "spectrum": "void spectrum s 0 0 6 400 700 .1 .4 .9 .3\n",
    "descending": "void spectrum s 0 0 7 780 380 .1 .4 .9 .3 .2\n",
    "fine": "void spectrum s 0 0 83 380 780 "
    + " ".join(f"{0.5 + 0.4 * np.sin(k / 25):.4f}" for k in range(81))
    + "\n",
    "specfile": "void specfile s 1 line.dat 0 0\n",
    "specfunc": "void specfunc s 2 wave f.cal 0 3 380 780 300\n",
    "specdata": "void specdata s 4 dim table.dat f.cal .25 0 0\n",
    "nested": "void spectrum t 0 0 5 380 780 .2 .6 .9\n"
    "t spectrum s 0 0 6 400 700 .1 .4 .9 .3\n",
}
SKY = "s glow sky 0 0 4 .5 .5 .5 0\nsky source dome 0 0 4 0 0 1 360\n"
FLOOR = (
    "s plastic floor 0 0 5 .8 .8 .8 0 0\nfloor ring r 0 0 8 0 0 0 0 0 1 0 10\n"
    "void glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 360\n"
)


def files(folder, text):
    """A scene beside the data and function files that it uses."""
    (folder / "f.cal").write_text(FUNCTIONS)
    (folder / "line.dat").write_text("1\n380 780 5\n.1 .4 .9 .3 .6\n")
    (folder / "table.dat").write_text(TABLE)
    (folder / "scene.rad").write_text(text)
    return folder / "scene.rad"


def traced(folder, options, ray):
    run("oconv scene.rad > scene.oct", folder=folder)
    command = f"rtrace -h -w {options} scene.oct"
    return np.array(run(command, folder=folder, stdin=ray).split(), dtype=float)


@pytest.mark.parametrize("name", SPECTRA)
def test_light_has_the_bands_of_radiance(tmp_path, name):
    """Radiance keeps at most 24 values of a spectrum, which gives 1 % here."""
    file = files(tmp_path, SPECTRA[name] + SKY)
    theirs = traced(tmp_path, "-cs 20 -co+", "0 0 0 0 0 1")[::-1]
    ours = cl.in_bands(cl.read_rad(file), BANDS).materials["sky"].radiance
    rough = {"specfunc": 0.01, "fine": 0.01}.get(name, 2e-4)
    np.testing.assert_allclose(ours, theirs, rtol=rough, atol=1e-4)


@pytest.mark.parametrize("name", ["spectrum", "specfile", "nested"])
def test_surfaces_have_the_bands_of_radiance(tmp_path, name):
    """An open sky of radiance 1 over the floor: radiance equals reflectance."""
    file = files(tmp_path, SPECTRA[name] + FLOOR)
    options = "-cs 20 -co+ -ab 1 -ad 256"
    theirs = traced(tmp_path, options, "0 0 1 0 0 -1")[::-1]
    ours = cl.in_bands(cl.read_rad(file), BANDS).materials["floor"].reflectance
    np.testing.assert_allclose(ours, theirs, rtol=2e-3, atol=1e-4)


@pytest.mark.parametrize("name", ["fine", "descending", "spectrum"])
def test_rgb_is_that_of_a_fine_spectral_picture(tmp_path, name):
    """Within 2 % of the RGB that Radiance computes from 81 bands."""
    file = files(tmp_path, SPECTRA[name] + SKY)
    theirs = traced(tmp_path, "-cs 81", "0 0 0 0 0 1")
    ours = cl.read_rad(file).materials["sky"].radiance
    np.testing.assert_allclose(ours, theirs, rtol=0.02, atol=2e-3)
