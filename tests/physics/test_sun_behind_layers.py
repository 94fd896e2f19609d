"""Direct sun behind an endless layer: its directional-hemispherical transmittance.

A sensor that faces a layer without end receives all light that leaves it: E = T cos θ
for direct normal irradiance 1, with T of the file and θ of the sun. This holds on each
side of a blind's cut-off angle, whether or not unscattered light is separated.
"""

import numpy as np
import pytest
from physics_scenes import quad, window
from test_sun_through_trees import over_disc, towards

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors

FAR = 200.0
SOUTH = window(quad((-FAR, 0, -FAR), (-FAR, 0, FAR), (FAR, 0, FAR), (FAR, 0, -FAR)))
AXES = np.stack([SOUTH.frame.right, SOUTH.frame.up, SOUTH.frame.normal], axis=-1)
FACING = Sensors(np.array([[0, 0.01, 0]]), np.array([[0, -1.0, 0]]))

# Slats of 45°, 80 mm wide and 72 mm apart: direct light until a profile angle of 12°
ALTITUDES_DEG = np.arange(6.0, 50, 1.5)


@pytest.fixture(scope="module", params=["full", "tree4"])
def blind(request, tmp_path_factory):
    slats = venetian(slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.5)
    keywords = {"halvings": 4} if request.param == "tree4" else {}
    made = generate_bsdf(
        slats, basis=request.param, samples=500, sides="front", geometry=False, seed=2,
        **keywords,
    )  # fmt: skip
    path = tmp_path_factory.mktemp("blind") / "blind.xml"
    write_bsdf(path, made)
    return read_bsdf(path)


def transmitted(blind, suns):
    """T(ω) cos θ, mean over each disc; and the suns on the edge of no cell."""
    low, high, mean = [], [], []
    for sun in suns:
        near = over_disc(sun, 40) @ AXES
        wide = near + 3 * (near - sun @ AXES)
        wide /= np.linalg.norm(wide, axis=1, keepdims=True)
        share = blind.hemispherical(near, function="transmission_front")
        around = blind.hemispherical(wide, function="transmission_front")
        low.append(around.min()), high.append(around.max())
        mean.append((share * -near[:, 2]).mean())
    return np.array(mean), np.subtract(high, low) < 1e-9


@pytest.mark.parametrize("peak", [False, True], ids=["spread", "sharp"])
def test_direct_sun_behind_an_endless_blind(device, blind, peak):
    suns = np.stack([towards(190, altitude) for altitude in ALTITUDES_DEG])
    expected, inner = transmitted(blind, suns)
    assert inner.sum() > 8
    assert expected.max() > 2 * expected.min()
    found = sun_coefficients(
        Scene({}, ()), [SOUTH], "south", blind, sensors=FACING, suns=suns,
        samples=32768, peak=peak, device=device, seed=4,
    )  # fmt: skip
    ratio = found.values[0, 0] / expected
    error = found.standard_error[0, 0] / expected
    assert error[inner].max() < 0.004
    assert np.all(abs(ratio - 1)[inner] < 4 * error[inner] + 0.001)
