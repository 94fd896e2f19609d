"""Fitted measurements as layers of rooms: read from files, seen by rays."""

import numpy as np
import pytest

import clerestory as cl
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.fit_storage import write_fits
from clerestory.gonio.fitted_measurement import fit_measurement, measured_bsdf
from clerestory.gonio.layer_file import read_layer
from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors
from goniometer import Goniophotometer, pane, rings


@pytest.fixture(scope="module")
def fitted():
    directions = rings(azimuths_deg=[0.0], step_deg=20.0)
    return fit_measurement(Goniophotometer(points=500).measure(pane, directions))


def test_a_file_of_fits_is_the_layer_itself(tmp_path, fitted):
    path = tmp_path / "pane.nc"
    write_fits(path, [fitted])
    layer, same = read_layer(path), measured_bsdf([fitted])
    source = np.array([0.3, 0.2, -np.sqrt(0.87)])
    leaving = from_degrees(np.array([10.0, 30, 50]), np.array([200.0, 215, 230]))
    pairs = np.broadcast_to(source, leaving.shape)
    assert layer.evaluate(pairs, leaving) == pytest.approx(
        same.evaluate(pairs, leaving)
    )
    assert layer.source == str(path)


def test_kernels_look_it_up_in_a_tree(fitted):
    table = measured_bsdf([fitted]).tabulated().scattering("transmission_front")
    assert isinstance(table, ScatteringTree)
    source = from_degrees(35.0, 20.0) * [1, 1, -1]
    share = fitted.interpolant.hemispherical(source)
    assert table.hemispherical(source) == pytest.approx(share, rel=0.02)


def test_a_point_behind_it_gets_its_share_of_a_uniform_sky(tmp_path, fitted):
    """Close behind a wide pane under a sky of radiance 1: π times the diffuse share."""
    write_fits(tmp_path / "pane.nc", [fitted])
    (tmp_path / "pane.rad").write_text(
        "void BSDF film\n6 0 pane.nc 0 1 0 .\n0\n0\n"
        "film polygon roof\n0\n0\n12 50 -50 1 -50 -50 1 -50 50 1 50 50 1\n"
    )
    (tmp_path / "sky.rad").write_text(
        "void glow bright\n0\n0\n4 1 1 1 0\nbright source dome\n0\n0\n4 0 0 1 180\n"
    )
    scene = cl.read_rad(tmp_path / "pane.rad", tmp_path / "sky.rad")
    sensor = Sensors(np.array([[0.0, 0, 0]]), np.array([[0.0, 0, 1]]))
    found = irradiance(scene, sensor, samples=1 << 15, seed=3)
    share = measured_bsdf([fitted]).diffuse("transmission_front")
    lux = float(found.illuminance()[0])
    assert lux / (LUMINOUS_EFFICACY * np.pi) == pytest.approx(share, rel=0.03)
