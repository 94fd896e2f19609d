"""Direct sun and the five-phase method against closed forms and path tracing."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import box, quad, sensor, window

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.errors import InputError, MatrixError
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.phases.direct_light import blackened
from clerestory.phases.facade_matrices import facade_daylight, facade_matrices
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import FIVE_PHASE, THREE_PHASE, five_phase
from clerestory.phases.picture_matrices import (
    picture_view_matrices,
    reflected_view_matrices,
)
from clerestory.phases.picture_series import luminance_over_time, pictures_over_time
from clerestory.phases.rendering import irradiance, render
from clerestory.phases.shaded_windows import (
    ShadedWindow,
    ShadeState,
    receiving_matrices,
)
from clerestory.phases.sun_coefficients import (
    picture_sun_coefficients,
    sun_coefficients,
)
from clerestory.phases.traced_matrices import (
    daylight_matrices,
    daylight_matrix,
    view_matrix,
)
from clerestory.phases.window_paths import picture_window_paths
from clerestory.scene.model import BsdfSurface, DistantSource, Light, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.sky.weather import Weather

SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))


def towards(azimuth_deg, altitude_deg):
    """Unit vector to a sun."""
    azimuth, altitude = np.radians([azimuth_deg, altitude_deg])
    flat = np.cos(altitude)
    return np.array([np.sin(azimuth) * flat, np.cos(azimuth) * flat, np.sin(altitude)])


def clear_air():
    """A layer that lets everything pass straight, known on Klems patches."""
    patches = klems("full")
    value = np.diag(1 / patches.projected_solid_angles())
    part = ScatteringMatrix(value, patches, patches)
    return Bsdf({("visible", "transmission_front"): part})


def weather_at(*moments):
    """Clear sunshine without any sky, in Oakland."""
    times = np.array(moments, dtype="datetime64[m]")
    count = len(times)
    return Weather(
        place="Oakland",
        latitude_deg=37.73,
        longitude_deg=-122.22,
        elevation=0.0,
        utc_offset_hours=-8.0,
        times=times,
        step_minutes=60.0,
        direct_normal=np.full(count, 800.0),
        diffuse_horizontal=np.full(count, 1.0),
        source="a test",
    )


def sunlit(scene, window, bsdf, sun, *, peak=False):
    """The scene with the layer in its window, under one sun of unit irradiance."""
    layer = BsdfSurface("layer", bsdf, 0.0, np.array([0, 0, 1.0]), peak=peak)
    panes = tuple(replace(pane, material="layer") for pane in window.polygons)
    light = Light("sun", np.full(3, 1 / SUN_SR))
    source = DistantSource(sun, 0.533, "sun", "sun")
    return scene + Scene({"layer": layer}, panes) + Scene({"sun": light}, (), (source,))


def test_diffusing_window_shines_evenly(device):
    """E = DNI · cos α · τ/π · ∫cos θ dω over the window, which V_d holds."""
    scene, south = box(4, 5, 3, 0.5)
    sun = towards(170, 35)
    points = Sensors(
        np.array([[2, 1, 0.8], [1, 3, 0.8]], dtype=float), np.array([[0, 0, 1.0]] * 2)
    )
    frosted = lambertian(0.6, klems("full"))
    direct = sun_coefficients(
        scene, [south], "south", frosted,
        sensors=points, suns=sun[None], samples=4096, device=device,
    )  # fmt: skip
    seen = view_matrix(
        blackened(scene), south, sensors=points, bounces=1, samples=65536, device=device
    )
    slant = -sun @ south.frame.normal
    expected = slant * 0.6 / np.pi * seen.values[0].sum(axis=1)
    error = direct.standard_error[0, :, 0]
    assert np.all(error < 0.02 * expected)
    assert np.all(abs(direct.values[0, :, 0] - expected) < 4 * error + 2e-3 * expected)


def test_clear_window_keeps_the_sun_sharp(device):
    """Through clear air a sensor in the sun receives cos θ, in the shade nothing."""
    scene, south = box(4, 5, 3, 0.5)
    sun = towards(180, 45)
    # The window's upper edge at 3 m casts its shadow on y = 3 − z: here at 2 m
    points = Sensors(
        np.array([[2, 1.9, 1], [2, 2.1, 1], [2, 2.0, 1]], dtype=float),
        np.array([[0, 0, 1.0]] * 3),
    )
    direct = sun_coefficients(
        scene, [south], "south", clear_air(),
        sensors=points, suns=sun[None], samples=8192, peak=True, device=device,
    )  # fmt: skip
    received = direct.values[0, :, 0]
    assert received[0] == pytest.approx(sun[2], rel=1e-3)
    assert received[1] == pytest.approx(0, abs=1e-4)
    # At the edge half of the disc is seen
    assert received[2] == pytest.approx(sun[2] / 2, abs=4 * 0.5 / 8192**0.5)


def test_sun_behind_the_wall_does_not_count(device):
    scene, south = box(4, 5, 3, 0.5)
    suns = np.stack([towards(180, 45), towards(0, 45)])
    direct = sun_coefficients(
        scene, [south], "south", lambertian(0.5, klems("full")),
        sensors=sensor((2, 1, 0.8), (0, 0, 1)), suns=suns, samples=64, device=device,
    )  # fmt: skip
    assert direct.values[0, 0, 0] > 0
    assert np.all(direct.values[..., 1] == 0)
    assert np.all(direct.standard_error[..., 1] == 0)


@pytest.mark.parametrize("peak", [False, True], ids=["spread", "sharp"])
def test_direct_sun_equals_path_tracing(device, peak):
    """Two kernels that share no code but the tables: C_ds, and pixels' path tracing."""
    scene, south = box(4, 5, 3, 0.0)
    mixed = clear_air().functions["visible", "transmission_front"].values * 0.5
    patches = klems("full")
    half = Bsdf(
        {
            ("visible", "transmission_front"): ScatteringMatrix(
                mixed + 0.3 / np.pi, patches, patches
            )
        }
    )
    sun = towards(160, 30)
    points = Sensors(
        np.array([[2, 1, 0.8], [1, 3, 0.8], [3.5, 2, 1.5]], dtype=float),
        np.array([[0, 0, 1.0], [0, 0, 1.0], [0, -1.0, 0]]),
    )
    direct = sun_coefficients(
        scene, [south], "south", half,
        sensors=points, suns=sun[None], samples=8192, peak=peak, device=device,
    )  # fmt: skip
    traced = irradiance(
        sunlit(scene, south, half, sun, peak=peak), points,
        samples=65536, seed=5, device=device,
    )  # fmt: skip
    difference = direct.values[0, :, 0] - traced.irradiance[:, 1]
    error = np.hypot(direct.standard_error[0, :, 0], traced.error[:, 1])
    assert np.all(error < 0.02 * traced.irradiance[:, 1])
    assert np.all(abs(difference) < 4 * error + 1e-6)


def phases(scene, south, bsdf, points, weather, device, **options):
    """The five phases of a room, and its skies: sun alone."""
    transmission = bsdf.transmission_matrix(window="south")
    black = blackened(scene)
    shared = {"device": device, "samples": options.pop("samples", 16384)}
    whole = window_chain(
        view_matrix(scene, south, sensors=points, seed=1, **shared),
        transmission,
        daylight_matrix(scene, south, subdivision=4, seed=2, **shared),
    )
    direct = window_chain(
        view_matrix(black, south, sensors=points, bounces=1, seed=3, **shared),
        transmission,
        daylight_matrix(black, south, subdivision=4, bounces=0, seed=4, **shared),
    )
    suns = sun_matrix(weather)
    sun = sun_coefficients(
        scene, [south], "south", bsdf, sensors=points, suns=suns.directions,
        samples=4096, device=device, **options,
    )  # fmt: skip
    sky = sky_matrix(weather, subdivision=4, include="sun")
    return WindowMatrices(whole, direct, MatrixChain((sun,))), sky, suns


@pytest.mark.parametrize("reflectance", [0.0, 0.5], ids=["black", "grey"])
def test_five_phases_equal_path_tracing(device, reflectance):
    """Sun through a diffusing window: sharp direct light, and all reflections.

    What is reflected comes from the three-phase part, whose sun is spread over four
    patches of the sky, 8° apart: its flux through the window is right within 1 %.
    """
    scene, south = box(4, 5, 3, reflectance)
    points = Sensors(
        np.array([[2, 1, 0.8], [1, 3, 0.8], [3, 4.5, 1.2]], dtype=float),
        np.array([[0, 0, 1.0], [0, 0, 1.0], [0, -1.0, 0]]),
    )
    weather = weather_at("2023-03-21T10:30", "2023-03-21T13:30")
    frosted = lambertian(0.6, klems("full"))
    parts, sky, suns = phases(scene, south, frosted, points, weather, device)
    result = five_phase([parts], sky, sky, suns)
    normal = suns.direct_normal.toarray()
    for step in range(2):
        [number] = np.flatnonzero(normal[:, step])
        traced = irradiance(
            sunlit(scene, south, frosted, suns.directions[number]), points,
            samples=65536, seed=6, device=device,
        )  # fmt: skip
        expected = traced.illuminance() * normal[number, step]
        found = result["illuminance"].values[:, step]
        error = result["standard_error"].values[:, step]
        noise = np.hypot(error, traced.error[:, 1] * 179 * normal[number, step])
        assert np.all(noise < 0.03 * expected)
        assert np.all(abs(found - expected) < 4 * noise + 0.01 * reflectance * expected)


def test_direct_part_is_taken_away_whole(device):
    """In a black room V T D S_ds and V_d T D_d S_ds are the same light."""
    scene, south = box(4, 5, 3, 0.0)
    points = sensor((2, 2, 0.8), (0, 0, 1))
    weather = weather_at("2023-03-21T12:30")
    parts, sky, suns = phases(scene, south, clear_air(), points, weather, device)
    result = five_phase([parts], sky, sky, suns)
    whole = float(result["three_phase"][0, 0])
    taken = float(result["direct_in_patches"][0, 0])
    error = float(result["standard_error"][0, 0])
    assert whole > 0
    assert abs(whole - taken) < 4 * error
    total = result["three_phase"] - result["direct_in_patches"] + result["direct_sun"]
    assert np.allclose(result["illuminance"], total)


@pytest.mark.slow
def test_six_phases_equal_path_tracing_behind_an_overhang(device):
    """In a black room, sun past the edge of a black overhang, from a box of ports.

    What F takes from the spread sun is taken away again whole, and the true sun throws
    a sharp shadow.
    """
    scene, south = box(4, 5, 3, 0.0)
    overhang = quad((0.1, -0.9, 2.4), (3.9, -0.9, 2.4), (3.9, 0, 2.4), (0.1, 0, 2.4))
    shaded = Scene(scene.materials, (*scene.surfaces, overhang))
    corners = {"left": ((0, 3), (0, 0)), "below": ((0, 0), (4, 0))}
    corners |= {"right": ((4, 0), (4, 3)), "above": ((4, 3), (0, 3))}
    sides = [
        window(
            quad((x1, -1, z1), (x2, -1, z2), (x2, 0, z2), (x1, 0, z1)),
            name=name,
            up=(0, 1, 0) if z1 == z2 else (0, 0, 1),
        )
        for name, ((x1, z1), (x2, z2)) in corners.items()
    ]
    front = quad((0, -1, 0), (0, -1, 3), (4, -1, 3), (4, -1, 0))
    ports = [window(front, name="front"), *sides]

    points = Sensors(
        np.array([[2, 0.5, 0.8], [1, 2, 0.8]], dtype=float), np.array([[0, 0, 1.0]] * 2)
    )
    weather = weather_at("2023-03-21T12:30")
    frosted = lambertian(0.6, klems("full"))
    sky = sky_matrix(weather, subdivision=4, include="sun")
    plain, _, suns = phases(shaded, south, frosted, points, weather, device)
    shared = {"samples": 4096, "device": device}

    def behind(scene, part, seed, **options):
        options |= shared
        F = facade_matrices(scene, south, ports, seed=seed, **options)
        D = daylight_matrices(Scene(), ports, subdivision=4, seed=seed + 1, **options)
        return window_chain(*part.receiving, part.factors[0][0], facade_daylight(F, D))

    whole = behind(shaded, plain.whole, 5)
    direct = behind(blackened(shaded), plain.direct, 25, bounces=0)
    six = WindowMatrices(whole, direct, plain.sun)
    result = five_phase([six], sky, sky, suns)
    [number] = np.flatnonzero(suns.direct_normal.toarray()[:, 0])
    traced = irradiance(
        sunlit(shaded, south, frosted, suns.directions[number]), points,
        samples=65536, seed=6, device=device,
    )  # fmt: skip
    normal = suns.direct_normal.toarray()[number, 0]
    expected = traced.illuminance() * normal
    found = result["illuminance"].values[:, 0]
    error = result["standard_error"].values[:, 0]
    noise = np.hypot(error, traced.error[:, 1] * 179 * normal)
    assert np.all(result["three_phase"].values > 0)
    assert np.all(noise < 0.05 * expected)
    assert np.all(abs(found - expected) < 4 * noise)


def test_skies_of_other_times_are_refused(device):
    scene, south = box(4, 5, 3, 0.5)
    points = sensor((2, 2, 0.8), (0, 0, 1))
    noon, one = weather_at("2023-03-21T12:30"), weather_at("2023-03-21T13:30")
    frosted = lambertian(0.6, klems("full"))
    parts, sky, suns = phases(scene, south, frosted, points, noon, device, samples=64)
    later = sky_matrix(one, subdivision=4, include="sun")
    with pytest.raises(MatrixError, match="equal steps expected"):
        five_phase([parts], sky, later, suns)


def test_window_that_is_not_there_is_refused():
    scene, south = box(4, 5, 3, 0.5)
    with pytest.raises(InputError, match="window is 'north'; one of south expected"):
        sun_coefficients(
            scene, [south], "north", clear_air(),
            sensors=sensor((2, 2, 1), (0, 0, 1)), suns=towards(180, 45)[None],
        )  # fmt: skip


def test_picture_shows_the_sun_patch_and_the_sun(device):
    """Five phases of a picture against path tracing: floor in the sun, the window.

    Only direct light is put in its true place: beside the sun patch, what the spread
    patch of the three-phase part reflects once more is up to a tenth of the light.
    """
    scene, south = box(4, 5, 3, 0.5)
    weather = weather_at("2023-03-21T12:30")
    suns = sun_matrix(weather)
    # Half looks to the window, half to the sun patch on the floor
    view = View(
        kind="angular",
        position=np.array([2, 4, 1.2]), direction=np.array([0, -1, -0.3]),
        horizontal=120, vertical=120,
    )  # fmt: skip
    camera = Camera(view, 24, 24)
    patches = klems("full")
    half = Bsdf(
        {
            ("visible", "transmission_front"): ScatteringMatrix(
                clear_air().functions["visible", "transmission_front"].values * 0.5
                + 0.3 / np.pi,
                patches,
                patches,
            )
        }
    )
    transmission = half.transmission_matrix(window="south")
    shared = {"samples": 4096, "device": device}
    whole = window_chain(
        picture_view_matrices(scene, [south], camera, seed=1, **shared)["south"],
        transmission,
        daylight_matrix(scene, south, subdivision=4, seed=2, **shared),
    )
    direct = window_chain(
        picture_view_matrices(scene, [south], camera, direct=True, seed=3, **shared)[
            "south"
        ],
        transmission,
        daylight_matrix(
            blackened(scene), south, subdivision=4, bounces=0, seed=4, **shared
        ),
    )
    sun = picture_sun_coefficients(
        scene, [south], "south", half, camera,
        suns=suns.directions, peak=True, samples=256, device=device,
    )  # fmt: skip
    sky = sky_matrix(weather, subdivision=4, include="sun")
    skies = Skies(sky, sky, suns)
    windows = [WindowMatrices(whole, direct, MatrixChain((sun,)))]
    [five] = pictures_over_time(windows, FIVE_PHASE, camera, skies)
    [three] = pictures_over_time(windows, THREE_PHASE, camera, skies)
    traced = render(
        sunlit(scene, south, half, suns.directions[0], peak=True), view,
        columns=24, rows=24, samples=2048, device=device,
    )  # fmt: skip
    expected = traced.picture.luminance() * suns.direct_normal.toarray()[0, 0]

    # Means over blocks of pixels: five phases within a few per cent everywhere, three
    # not where the sun shines
    def blocks(picture):
        return picture.reshape(6, 4, 6, 4).mean(axis=(1, 3))

    bright = blocks(expected) > 0.02 * expected.max()
    wrong = abs(blocks(five.luminance()) / blocks(expected) - 1)[bright]
    before = abs(blocks(three.luminance()) / blocks(expected) - 1)[bright]
    assert np.median(wrong) < 0.03
    assert wrong.max() < 0.12
    assert before.max() > 0.5
    assert five.luminance().mean() == pytest.approx(expected.mean(), rel=0.03)


def test_pixels_are_brighter_than_their_reflected_light(device):
    """V, V_d and C_ds share paths: few paths leave no pixel beside a sun patch black.

    The sky is the sun alone and nothing reflects outside, so D is D_d, and
    V T D S - V_d T D_d S_ds is (V - V_d) T D S.
    """
    scene, south = box(4, 5, 3, 0.2)
    weather = weather_at("2023-12-21T12:30")
    suns = sun_matrix(weather)
    view = View(
        kind="angular", horizontal=180, vertical=180,
        position=np.array([2, 4, 1.2]), direction=np.array([0, -1, -0.3]),
    )  # fmt: skip
    camera, patches = Camera(view, 48, 48), klems("full")
    clear = clear_air().functions["visible", "transmission_front"].values
    glass = Bsdf(
        {("visible", "transmission_front"): ScatteringMatrix(clear, patches, patches)}
    )
    T = glass.transmission_matrix(window="south")
    D = daylight_matrix(scene, south, subdivision=4, samples=256, device=device)
    state = ShadeState(whole=(T, D), direct=(T, D), bsdf=glass, peak=True)
    shared = {"samples": 8, "device": device}
    V = reflected_view_matrices(scene, [south], camera, seed=1, **shared)
    paths = picture_window_paths(scene, [south], camera, seed=2, **shared)
    sky = sky_matrix(weather, subdivision=4, include="sun")
    windows = receiving_matrices(
        [ShadedWindow(south, (state,))], V, paths, suns.directions
    )
    skies = Skies(sky, sky, suns)
    [found] = luminance_over_time(windows, FIVE_PHASE, camera, skies)
    chain = window_chain(V["south"], T, D)
    [reflected] = luminance_over_time(
        [WindowMatrices(chain)], THREE_PHASE, camera, skies
    )
    assert found.mean() > 2 * reflected.mean() > 0
    assert np.all(found >= 0.98 * reflected)
