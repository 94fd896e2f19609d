"""Standard errors of sensors' direct-sun coefficients at the edge of a shadow."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import box, quad
from test_sun_through_trees import towards

from clerestory.bsdf.analytic import clear_air
from clerestory.constants import SUN_DIAMETER
from clerestory.hemisphere.klems import klems
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.scene.sensors import Sensors

# Shares of the solar disc that the sensors see, and seeds of the runs
SHARES, SEEDS = np.array([0.15, 0.4, 0.6, 0.85, 1.0]), 40


def height_of(share):
    """Height over the centre of the disc, in radii, below which lies a share of it."""
    heights = np.linspace(-1, 1, 20001)
    below = 0.5 + (heights * np.sqrt(1 - heights**2) + np.arcsin(heights)) / np.pi
    return np.interp(share, below, heights)


def shaded():
    """An open window under a far edge, and sensors that see shares of the sun."""
    room, south = box(4, 5, 3, 0.0)
    sun, middle, far = towards(180, 35), np.array([2.0, 1.2, 1.0]), 60.0
    edge, side = middle + far * sun, np.array([50.0, 0, 0])
    high = np.array([0, 0, 60.0])
    roof = quad(edge - side, edge + side, edge + side + high, edge - side + high)
    # A sensor below the middle sees more of the sun below the edge
    below = np.tan(height_of(SHARES) * SUN_DIAMETER / 2)[:, None]
    points = middle - far * below * np.cross([-1.0, 0, 0], sun)
    return replace(room, surfaces=(*room.surfaces, roof)), south, sun, points


@pytest.mark.slow
def test_error_of_sensors_at_a_shadow_is_the_scatter_over_seeds():
    """Deviations of 40 runs have the variance that their errors state."""
    scene, south, sun, points = shaded()
    sensors = Sensors(points, np.tile([0, 0, 1.0], (len(points), 1)))
    air = clear_air(klems("full"))
    found, stated = [], []
    for seed in range(SEEDS):
        C_ds = sun_coefficients(
            scene, [south], "south", air, sensors=sensors, suns=sun[None], peak=True,
            samples=1024, seed=seed, device="cpu",
        )  # fmt: skip
        found.append(C_ds.values[0, :, 0])
        stated.append(C_ds.standard_error[0, :, 0])
    found, stated = np.array(found), np.sqrt(np.square(stated).mean(axis=0))
    error = found.std(axis=0, ddof=1) / np.sqrt(SEEDS)
    np.testing.assert_array_less(
        abs(found.mean(axis=0) - SHARES * sun[2]), 4 * error + 2e-3
    )
    edge = SHARES < 1
    assert found.std(axis=0, ddof=1)[edge] == pytest.approx(stated[edge], rel=0.4)
    assert np.all(stated < 0.02)
