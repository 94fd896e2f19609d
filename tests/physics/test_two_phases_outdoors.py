"""Two phases with the exact sun outdoors, where every hour has a closed form.

Outdoors, the sun spread over sky patches is subtracted as it was added: what is left is
the sky, Σ L_p Λ_p for a horizontal sensor, and the sun at its place, E_n cos θ.
"""

import numpy as np
import pytest
from physics_scenes import box, quad
from test_phase_methods import on_floor

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.glare.glazed_view_points import glazed_view_glare
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.image.camera import Camera
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import MatrixChain, Skies, WindowMatrices
from clerestory.phases.methods import METHODS
from clerestory.phases.picture_series import luminance_over_time
from clerestory.phases.separate_coefficients import separate_coefficients
from clerestory.phases.sky_views import sky_view_matrices, sun_view_coefficients
from clerestory.phases.unscattered_light import unscattered_sun
from clerestory.scene.model import BsdfSurface, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix

TERMS = METHODS["2-phase"].terms(corrected=True)
UP = Sensors(np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, 1.0]]))


def clear_days():
    """Every daylit hour of two clear days."""
    hours = np.arange(8, 17)
    days = np.array(["2023-03-21", "2023-06-21"], "M8[m]")
    times = (days[:, None] + hours * np.timedelta64(60, "m")).ravel()
    return cl.Weather(
        place="Oakland", latitude_deg=37.73, longitude_deg=-122.22, elevation=0.0,
        utc_offset_hours=-8.0, times=times, step_minutes=60.0,
        direct_normal=np.full(len(times), 800.0),
        diffuse_horizontal=np.full(len(times), 90.0), source="a test",
    )  # fmt: skip


@pytest.fixture(scope="module")
def skies():
    weather = clear_days()
    S, S_ds = (sky_matrix(weather, include=part) for part in ("all", "sun"))
    return Skies(S, S_ds, sun_matrix(weather))


def lux_of_sky(skies, weights):
    """Illuminance by the sky without the sun, of the patches' weights [sr]."""
    whole, sun = (sky.values for sky in (skies.whole, skies.sun))
    photopic = skies.whole.bands.weights
    return np.einsum("b,p,bpt->t", photopic, weights, whole - sun)


def beam(skies, normal):
    """Illuminance by the sun at its place [lux]."""
    found = skies.suns.direct_normal.T @ np.maximum(skies.suns.directions @ normal, 0)
    return skies.whole.bands.weights.sum() * found


def open_weights():
    """Λ of the sky patches on a horizontal sensor; none of the ground."""
    return np.append(0, reinhart(4).dome.projected_solid_angles())


def test_open_sensor_has_the_sky_and_the_sun_of_every_hour(skies, device):
    C, C_d = separate_coefficients(
        Scene(), sensors=UP, samples=1 << 14, seed=5, device=device
    )
    C_ds = unscattered_sun(
        Scene(), sensors=UP, suns=skies.suns.directions, samples=256, device=device
    )
    window = WindowMatrices(*(MatrixChain((matrix,)) for matrix in (C, C_d, C_ds)))
    found = illuminance([window], TERMS, skies)
    lux, error = found["illuminance"].values[0], found["standard_error"].values[0]
    expected = lux_of_sky(skies, open_weights()) + beam(skies, np.array([0, 0, 1.0]))
    assert np.all(error < 0.003 * expected)
    assert np.all(abs(lux - expected) < 4 * error + 1e-3 * expected)


def test_standard_error_outdoors_holds_over_seeds(skies, device):
    """C and C_d have the same paths: their deviations cancel, and so do the errors."""
    few = skies.select(np.arange(4))
    found = []
    for seed in range(40):
        C, C_d = separate_coefficients(
            Scene(), sensors=UP, samples=1 << 11, seed=seed, device=device
        )
        window = WindowMatrices(MatrixChain((C,)), MatrixChain((C_d,)))
        data = illuminance([window], TERMS[:2], few)
        found.append((data["illuminance"].values[0], data["standard_error"].values[0]))
    lux, error = np.moveaxis(found, 1, 0)
    stated = np.sqrt(np.square(error).mean(axis=0))
    assert lux.std(axis=0, ddof=1) == pytest.approx(stated, rel=0.4)
    assert np.all(stated < 0.02 * lux.mean(axis=0))


def test_diffusing_window_of_a_black_room_leaves_no_patches(skies, device):
    """Behind a Lambertian window in a black room, all light is direct: C equals C_d."""
    room, south = box(4, 5, 3, 0.0)
    layer = lambertian(0.5, klems("full"))
    shade = BsdfSurface("shade", layer, 0.0, south.frame.up)
    panes = tuple(quad(*each.vertices, material="shade") for each in south.polygons)
    scene = room + Scene({"shade": shade}, panes)
    C, C_d = separate_coefficients(
        scene, sensors=on_floor(1.0), windows=("shade",), samples=1 << 12,
        device=device,
    )  # fmt: skip
    assert C.values.max() > 0
    np.testing.assert_allclose(C.values, C_d.values)
    mirrored, _ = box(4, 5, 3, 0.5)
    C, C_d = separate_coefficients(
        mirrored + Scene({"shade": shade}, panes), sensors=on_floor(1.0),
        windows=("shade",), samples=1 << 12, device=device,
    )  # fmt: skip
    assert C.values.sum() > 1.1 * C_d.values.sum()


def test_pixels_of_the_open_sky_have_its_luminance_in_every_hour(skies, device):
    view = View(
        "angular", direction=np.array([0, 1.0, 0.5]), horizontal=90, vertical=90
    )
    camera = Camera(view, 12, 12)
    C, C_d = sky_view_matrices(Scene(), camera, samples=4, device=device)
    suns = skies.suns.directions
    C_ds = sun_view_coefficients(Scene(), camera, suns=suns, samples=2, device=device)
    window = WindowMatrices(*(MatrixChain((matrix,)) for matrix in (C, C_d, C_ds)))
    found = list(luminance_over_time([window], TERMS, camera, skies, None))
    # The same pixels under the sky without the sun
    expected = C.values[0] @ lux_by_patch(skies)
    for step, picture in enumerate(found):
        np.testing.assert_allclose(picture.ravel(), expected[:, step], rtol=1e-3)


def lux_by_patch(skies):
    """Luminance of the sky patches without the sun (patch, step)."""
    whole, sun = (sky.values for sky in (skies.whole, skies.sun))
    return np.einsum("b,bpt->pt", skies.whole.bands.weights, whole - sun)


def test_eye_outdoors_has_the_sky_and_the_sun_of_every_hour(skies, device):
    """Vertical illuminance at an eye that looks up, whose cells see sky alone."""
    eye = View(
        "angular", UP.position[0], UP.direction[0], np.array([0, 1.0, 0]), 180, 180
    )
    found = glazed_view_glare(
        Scene(), [eye], skies=skies, samples=64, quantities=("illuminance",),
        device=device,
    )  # fmt: skip
    expected = lux_of_sky(skies, open_weights()) + beam(skies, UP.direction[0])
    assert found.illuminance.values[0] == pytest.approx(expected, rel=0.01)
