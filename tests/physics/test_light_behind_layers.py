"""Transmission or reflection at BSDF layers, chosen by the light on both sides."""

import numpy as np
import pytest
from physics_scenes import quad

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.engine.work_units import Local
from clerestory.hemisphere.klems import klems
from clerestory.phases.rendering import irradiance
from clerestory.phases.traced_matrices import daylight_coefficients
from clerestory.scene.model import BsdfSurface, DistantSource, Light, Scene
from clerestory.scene.sensors import Sensors

TRANSMITTANCE, REFLECTANCE, RADIANCE = 0.05, 0.85, 100.0
SENSORS, SAMPLES, FAR = 40, 512, 200.0


def under_a_layer(*, upside_down):
    """A large Lambertian layer above dark ground, below a uniform sky."""
    patches = klems("quarter")
    even = np.full((len(patches), len(patches)), 1 / np.pi)
    share = {"transmission": TRANSMITTANCE, "reflection": REFLECTANCE}
    functions = {
        ("visible", f"{kind}_{side}"): ScatteringMatrix(even * of_all, patches, patches)
        for kind, of_all in share.items()
        for side in ("front", "back")
    }
    up = np.array([0.0, 1.0, 0.0])
    a = FAR
    corners = [(-a, -a, 1.0), (-a, a, 1.0), (a, a, 1.0), (a, -a, 1.0)]
    sheet = quad(*(corners[::-1] if upside_down else corners), material="layer")
    materials = {
        "layer": BsdfSurface("layer", Bsdf(functions), 0.0, up),
        "sky": Light("sky", np.full(3, RADIANCE)),
    }
    sky = DistantSource(np.array([0.0, 0.0, 1.0]), 180.0, "sky")
    return Scene(materials, (sheet,), (sky,))


@pytest.mark.parametrize("upside_down", [False, True])
def test_paths_pass_a_layer_to_the_bright_side(device, upside_down):
    """E = π τ L, with a fraction of the error of paths that mostly reflect.

    Sampled by the BSDF alone, a path passes with the probability τ/(τ + ρ), and the
    error of independent paths is √(ρ/τ/n); that of Sobol' points is 0.36 of it.
    """
    scene = under_a_layer(upside_down=upside_down)
    place, up = np.zeros((SENSORS, 3)), np.tile([0.0, 0.0, 1.0], (SENSORS, 1))
    found = irradiance(scene, Sensors(place, up), samples=SAMPLES, device=device)
    value, error = found.irradiance[:, 0], found.error[:, 0]
    expected = np.pi * TRANSMITTANCE * RADIANCE
    scatter = value.std(ddof=1)
    assert value.mean() == pytest.approx(expected, abs=4 * scatter / SENSORS**0.5)
    assert np.sqrt(np.mean(error**2)) == pytest.approx(scatter, rel=0.35)
    alone = np.sqrt(REFLECTANCE / TRANSMITTANCE / SAMPLES)
    assert scatter < 0.15 * alone * expected


def test_other_jobs_do_not_depend_on_pictures_before_them(device):
    """An executor keeps scenes; the light measured for one job stays with its kind."""
    scene = under_a_layer(upside_down=False)
    sensors = Sensors(np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]))
    found = []
    for before in (False, True):
        effort = {"samples": 256, "device": device, "executor": Local()}
        if before:
            irradiance(scene, sensors, **effort)
        C = daylight_coefficients(scene, sensors=sensors, subdivision=1, **effort)
        found.append(C.values)
    assert np.array_equal(*found)
