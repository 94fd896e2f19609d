"""Direct sun behind a blind near its cut-off angle, where Radiance differs from us.

A sensor that faces a layer without end receives T(ω) cos θ. Radiance's renderer jitters
the direction of view by the width of the cell that contains it (`-ss`), which is wider
in the large cells around a bright one: its default receives more or less than the file
says. Without jitter, `-ss 0`, it receives what the file says, as we do.
"""

import numpy as np
import pytest
from radiance import run

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.directions import Frame
from clerestory.hemisphere.klems import klems
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

FAR, REPEATS, SUN_RADIANCE = 200.0, 64, 1e6
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))
CORNERS = FAR * np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1.0]])
FRAME = Frame.from_normal_up(np.array([0, 1.0, 0]), np.array([0, 0, 1.0]))
AXES = np.stack([FRAME.right, FRAME.up, FRAME.normal], axis=-1)

# Slats of 45° let the sun through below a profile angle of about 13°
ALTITUDES_DEG = np.array([11, 12, 13, 18, 21, 24, 33])


@pytest.fixture(scope="module")
def suns():
    azimuth, altitude = np.radians(185), np.radians(ALTITUDES_DEG)
    flat = np.cos(altitude)
    parts = flat * np.sin(azimuth), flat * np.cos(azimuth), np.sin(altitude)
    return np.stack(parts, axis=-1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, suns):
    """A tree of one transmission, which Radiance and we look up alike."""
    made = tmp_path_factory.mktemp("cutoff")
    slats = venetian(slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.5)
    tree = generate_bsdf(
        slats, basis="tree4", halvings=4, sides="front", samples=500, geometry=False
    )
    write_bsdf(made / "blind.xml", tree)
    lights = "".join(
        f"void light sun{i} 0 0 3 {SUN_RADIANCE} {SUN_RADIANCE} {SUN_RADIANCE}\n"
        f"sun{i} source disc{i} 0 0 4 {x:.9g} {y:.9g} {z:.9g} 0.533\n"
        for i, (x, y, z) in enumerate(suns)
    )
    corners = " ".join(f"{x:g}" for x in CORNERS.ravel())
    (made / "blind.rad").write_text(
        f"{lights}void BSDF layer 6 0 blind.xml 0 0 1 . 0 0\n"
        f"layer polygon pane 0 0 12 {corners}\n"
    )
    run("oconv blind.rad > blind.oct", folder=made)
    return made


def by_radiance(folder, count, options):
    """Irradiance of the sensor for each sun, and the standard error over repeats."""
    names = " ".join(f"-m sun{i}" for i in range(count))
    found = run(
        "rcontrib -n 2 -h- -w- -V+ -lw 1e-9 -dc 1 -dt 0 -dj 1 -I+ -ab 1 -ad 1024"
        f" {options} {names} blind.oct",
        folder=folder,
        stdin="0 0.01 0 0 -1 0\n" * REPEATS,
    )
    each = np.array(found.split(), float).reshape(REPEATS, count, 3)[:, :, 1]
    each /= SUN_SR * SUN_RADIANCE
    return each.mean(axis=0), each.std(axis=0, ddof=1) / np.sqrt(REPEATS)


def test_near_the_cut_off_the_file_is_right_and_jitter_is_not(folder, suns):
    blind = read_bsdf(folder / "blind.xml")
    local = suns @ AXES
    share = blind.hemispherical(local, function="transmission_front")
    expected = share * -local[:, 2]
    window = Window("pane", (Polygon(CORNERS, "x", "pane"),), FRAME, klems("full"))
    for peak in (False, True):
        ours = sun_coefficients(
            Scene({}, ()), [window], "pane", blind, suns=suns, samples=8192, peak=peak,
            sensors=Sensors(np.array([[0, 0.01, 0]]), np.array([[0, -1.0, 0]])), seed=3,
        )  # fmt: skip
        assert ours.values[0, 0] == pytest.approx(expected, rel=0.006)
    exact, error = by_radiance(folder, len(suns), "-ss 0")
    assert np.all(abs(exact - expected) < 4 * error + 0.002 * expected)
    jittered, error = by_radiance(folder, len(suns), "")
    apart = jittered / expected - 1
    assert apart.max() > 0.06
    assert (abs(jittered - expected) / error).max() > 4
