"""Single BSDF values, integrals and panes against Radiance's library and renderer."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import glass_properties
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems

pyradiance = pytest.importorskip("pyradiance")
library = pytest.importorskip("pyradiance.bsdf")
HOME = Path(pyradiance.__file__).parent

# Radiance keeps what it loads in a list of its own; Python must not free it meanwhile
LOADED = []


def load(path):
    LOADED.append(library.load_file(str(path)))
    return LOADED[-1]


def asymmetric_bsdf(partition, functions=FUNCTIONS):
    """Different functions without any symmetry."""
    rng = np.random.default_rng(2)
    shape = (len(partition), len(partition))
    return Bsdf(
        {
            ("visible", name): ScatteringMatrix(
                rng.random(shape) * 0.2, partition, partition
            )
            for name in functions
        }
    )


def angles_deg(direction):
    """Polar angle and azimuth [°]."""
    x, y, z = direction
    theta, phi = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)
    return float(np.degrees(theta)), float(np.degrees(phi))


def assert_values_equal_radiances(path, bsdf):
    rng = np.random.default_rng(6)
    incident, leaving = rng.normal(size=(2, 1500, 3))
    incident /= np.linalg.norm(incident, axis=-1, keepdims=True)
    leaving /= np.linalg.norm(leaving, axis=-1, keepdims=True)
    data = load(path)
    theirs = [
        library.query(data, *angles_deg(i), *angles_deg(o))[1]
        for i, o in zip(incident, leaving, strict=True)
    ]
    ours = bsdf.evaluate(incident, leaving)
    # Radiance 6 ripples each value of a matrix by up to 3e-4 on purpose, by its place
    np.testing.assert_allclose(ours, theirs, rtol=3.1e-4, atol=1e-6)
    assert np.ptp(ours) > 0.01


def test_values_of_all_four_functions(tmp_path):
    bsdf = asymmetric_bsdf(klems("full"))
    write_bsdf(tmp_path / "four_functions.xml", bsdf)
    assert_values_equal_radiances(tmp_path / "four_functions.xml", bsdf)


@pytest.mark.parametrize("side", ["transmission_front", "transmission_back"])
def test_values_by_reciprocity(tmp_path, side):
    bsdf = asymmetric_bsdf(klems("quarter"), functions=(side,))
    write_bsdf(tmp_path / f"{side}.xml", bsdf)
    assert_values_equal_radiances(tmp_path / f"{side}.xml", bsdf)


@pytest.mark.parametrize("name", ["blinds.xml", "ven45.xml"])
def test_values_of_tutorial_files(shared_data, name):
    path = shared_data / "tutorial_room" / "matrices" / "tmtx" / name
    assert_values_equal_radiances(path, read_bsdf(path))


def test_direct_hemispherical_values(tmp_path):
    """All that is scattered, from both sides, at patch centres: `bsdf.direct_hemi`."""
    full = klems("full")
    bsdf = asymmetric_bsdf(full)
    path = tmp_path / "hemispherical.xml"
    write_bsdf(path, bsdf)
    data = load(path)
    centres = full.centres()
    for side, source in (("front", -centres), ("back", centres * [-1, -1, 1])):
        share = bsdf.direct_hemispherical(f"transmission_{side}")
        share = share + bsdf.direct_hemispherical(f"reflection_{side}")
        for patch in (0, 3, 30, 77, 144):
            angles = angles_deg(source[patch])
            theirs = library.direct_hemi(data, *angles, library.SAMPLE_ALL)
            assert share[patch] == pytest.approx(theirs, rel=1e-3)


@pytest.mark.parametrize("panes", [1, 2])
def test_panes_equal_radiances_glass(tmp_path, panes):
    """`rtrace` through polygons of glass to a uniform sky, at six angles."""
    scene = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
    scene += "void glass pane 0 0 4 .9 .9 .9 1.6\n"
    for z in np.arange(panes) / 1000:
        corners = f"-99 -99 {z} 99 -99 {z} 99 99 {z} -99 99 {z}"
        scene += f"pane polygon p{z} 0 0 12 {corners}\n"
    theta = np.radians([0, 20, 40, 60, 75, 85])
    rays = "".join(f"0 0 -1 {np.sin(t)} 0 {np.cos(t)}\n" for t in theta)
    octree = tmp_path / "scene.oct"
    octree.write_bytes(pyradiance.oconv(stdin=scene.encode(), warning=False))
    out = subprocess.run(
        [HOME / "bin" / "rtrace", "-h", "-ab", "0", "-lr", "60", "-lw", "1e-8", octree],
        input=rays.encode(),
        env={**os.environ, "RAYPATH": str(HOME / "lib")},
        check=True,
        capture_output=True,
    ).stdout
    theirs = np.array([float(line.split()[1]) for line in out.splitlines()])
    ours, _ = glass_properties(
        np.cos(theta), transmissivity=0.9, index=1.6, panes=panes
    )
    np.testing.assert_allclose(ours, theirs, rtol=1e-4)
