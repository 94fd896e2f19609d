"""A coloured room in 20 bands against `rtrace -cs 20` and `rcontrib -cs 20`."""

import io

import numpy as np
import pytest
from radiance import run

import clerestory as cl
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import DistantSource, Glow, Scene
from clerestory.spectra import Spectrum

BANDS = cl.band_set("20")
NM = np.linspace(380, 780, 401)
WALL = 0.5 + 0.3 * np.sin(NM / 50)
FLOOR = 0.1 + 0.5 / (1 + np.exp((600 - NM) / 20))
SKY = 1.5 - 0.9 * (NM - 380) / 400
# Enough for standard errors that are those of a normal distribution
RUNS = 64

# First patch of every row of the sky, from the horizon to the zenith
ROWS = np.cumsum([0, 30, 30, 24, 24, 18, 12, 6])

# A room 4 m × 5 m × 3 m without its south wall, and a floor
ROOM = """
void plastic wall 0 0 5 1 1 1 0 0
void plastic floor 0 0 5 1 1 1 0 0
floor polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0
wall polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3
wall polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3
wall polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0
wall polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3
"""
SENSORS = "2 1 0.8 0 0 1\n2 4 1.2 0 -1 0\n1 3 1.2 1 0 0\n"


def spectrum(name, values):
    """A primitive of Radiance with a value at every nanometre."""
    listed = " ".join(f"{value:.6g}" for value in values)
    return f"void spectrum {name} 0 0 {len(values) + 2} 380 780 {listed}\n"


def of_radiance(folder, program, more, sky_colour=None):
    """What a program gives in each run, for each sensor."""
    text = ROOM
    for name, values in {"wall": WALL, "floor": FLOOR}.items():
        text = text.replace(f"void plastic {name}", f"{name}_colour plastic {name}")
        text = spectrum(f"{name}_colour", values) + text
    coloured = sky_colour is not None
    text += spectrum("sky_colour", sky_colour) if coloured else ""
    text += f"{'sky_colour' if coloured else 'void'} glow sky 0 0 4 1 1 1 0\n"
    text += "sky source dome 0 0 4 0 0 1 360\n"
    (folder / "spectral.rad").write_text(text)
    run("oconv spectral.rad > room.oct", folder=folder)
    options = "-h -I+ -u+ -ab 3 -ad 1024 -lw 1e-7 -dt 0 -cs 20"
    command = f"{program} {options} {more} room.oct"
    output = run(command, folder=folder, stdin=SENSORS * RUNS)
    return np.loadtxt(io.StringIO(output)).reshape(RUNS, SENSORS.count("\n"), -1)


def coloured_room(folder):
    """The room in bands, and its sensors."""
    (folder / "room.rad").write_text(ROOM)
    (folder / "sensors.pts").write_text(SENSORS)
    colours = {"wall": Spectrum(NM, WALL), "floor": Spectrum(NM, FLOOR)}
    room = cl.in_bands(cl.read_rad(folder / "room.rad"), BANDS, spectra=colours)
    return room, cl.read_sensors(folder / "sensors.pts")


@pytest.mark.slow
def test_twenty_bands_are_those_of_rtrace(tmp_path):
    """Three reflections; every sensor and band within the standard errors.

    Irradiance carries three bands along a path, daylight coefficients all of them.
    """
    # Radiance's bands begin with the longest wavelength
    theirs = of_radiance(tmp_path, "rtrace", "-aa 0 -as 0 -co+", SKY)[..., ::-1]
    mean, spread = theirs.mean(axis=0), theirs.std(axis=0, ddof=1) / RUNS**0.5
    room, sensors = coloured_room(tmp_path)
    effort = {"bounces": 3, "samples": 1 << 13, "device": "cpu"}

    sky = Glow("sky", cl.band_means(Spectrum(NM, SKY), BANDS))
    dome = (DistantSource(np.array([0.0, 0.0, 1.0]), 360.0, "sky"),)
    lit = Scene({**room.materials, "sky": sky}, room.surfaces, dome, BANDS)
    found = irradiance(lit, sensors, **effort)
    within(found.irradiance, found.error, mean, spread)

    matrix = cl.daylight_coefficients(room, sensors=sensors, subdivision=1, **effort)
    scatter = np.square(matrix.components.sum(axis=-1)).sum(axis=0) ** 0.5
    total = matrix.values.sum(axis=-1).T * sky.radiance
    within(total, scatter.T * sky.radiance, mean, spread)


@pytest.mark.slow
def test_coefficients_in_twenty_bands_are_those_of_rcontrib(tmp_path):
    """Light of every row of sky patches, at each sensor and in each band."""
    bins = "-V- -e MF:1 -f reinhartb.cal -b rbin -bn Nrbins -m sky"
    theirs = of_radiance(tmp_path, "rcontrib", bins)
    theirs = theirs.reshape(*theirs.shape[:2], 145, len(BANDS))[..., ::-1]
    theirs = np.add.reduceat(theirs, ROWS, axis=2)
    mean, spread = theirs.mean(axis=0), theirs.std(axis=0, ddof=1) / RUNS**0.5
    room, sensors = coloured_room(tmp_path)
    effort = {"bounces": 3, "samples": 1 << 13, "device": "cpu"}
    matrix = cl.daylight_coefficients(room, sensors=sensors, subdivision=1, **effort)
    rows = np.add.reduceat(matrix.values[..., 1:], ROWS, axis=-1)
    parts = np.add.reduceat(matrix.components[..., 1:], ROWS, axis=-1)
    scatter = np.square(parts).sum(axis=0) ** 0.5
    ours, error = (np.moveaxis(each, 0, -1) for each in (rows, scatter))
    # Rows that give a sensor 5 % of its light
    seen = mean > 0.05 * mean.sum(axis=1, keepdims=True)
    assert seen.any(axis=1).all()
    within(ours[seen], error[seen], mean[seen], spread[seen], most=0.1)


def within(ours, error, theirs, spread, most=0.02):
    """Check agreement within standard errors, which must be below 2 %."""
    both = np.hypot(error, spread)
    assert (both < most * theirs).all()
    assert (np.abs(ours - theirs) < 4.5 * both).all()
