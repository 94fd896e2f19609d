"""What traced matrices must give where the answer is known without tracing."""

import numpy as np
import pytest
from physics_scenes import box, endless_ground, grey, quad, sensor, window
from scipy.spatial.transform import Rotation

import clerestory as cl
from clerestory.bsdf.analytic import clear_air, lambertian, thin_pane
from clerestory.scene.model import Glass, Scene
from clerestory.scene.sensors import Sensors

UP = (0, 0, 1)


def row_sum(matrix, channel=0):
    """Sums of the rows, with their standard errors."""
    values = matrix.values[channel].sum(axis=1)
    error = np.sqrt(np.square(matrix.components[:, channel].sum(axis=2)).sum(axis=0))
    return values, error


def assert_agrees(estimate, truth, error, *, precision):
    """Within four standard errors, which must be small enough to mean something."""
    assert np.all(error < precision)
    assert np.all(np.abs(estimate - truth) < 4 * error + 1e-6 * np.abs(truth))


def test_open_sensor_collects_pi(device):
    """A horizontal sensor under an open sky of unit radiance reads π."""
    matrix = cl.daylight_coefficients(
        Scene(), sensors=sensor((0, 0, 1), UP), samples=4096, device=device
    )
    assert matrix.values.sum() == pytest.approx(np.pi, rel=1e-6)


def test_open_sensor_weighs_patches_by_cosine(device):
    """Each sky patch sends the irradiance of its projected solid angle."""
    matrix = cl.daylight_coefficients(
        Scene(),
        sensors=sensor((0, 0, 1), UP),
        subdivision=1,
        samples=1 << 16,
        device=device,
    )
    projected = matrix.columns.partition.dome.projected_solid_angles()
    found, error = matrix.values[0, 0, 1:], matrix.standard_error[0, 0, 1:]
    assert_agrees(found, projected, error + 2e-6, precision=2e-3)


@pytest.mark.parametrize("reflectance", [0.0, 0.5, 1.0])
def test_vertical_sensor_sees_half_sky_and_half_ground(device, reflectance):
    """Over an endless ground of reflectance ρ, E = (1 + ρ)·π/2 per unit radiance."""
    matrix = cl.daylight_coefficients(
        endless_ground(reflectance),
        sensors=sensor((0, 0, 1), (0, 1, 0)),
        samples=1 << 15,
        device=device,
    )
    value, error = row_sum(matrix)
    truth = (1 + reflectance) * np.pi / 2
    assert_agrees(value, truth, error, precision=0.005)


def test_colours_stay_apart(device):
    """A coloured ground reflects each channel by its own reflectance."""
    colour = np.array([0.1, 0.4, 0.9])
    matrix = cl.daylight_coefficients(
        endless_ground(colour),
        sensors=sensor((0, 0, 1), (0, 0, -1)),
        samples=1 << 14,
        device=device,
    )
    assert matrix.values.sum(axis=(1, 2)) == pytest.approx(colour * np.pi, rel=1e-5)


def test_a_white_room_loses_no_light(device):
    """Behind white walls every sensor sees the window's radiance all around: E = π."""
    scene, south = box(4, 5, 3, 1.0)
    sensors = Sensors(
        np.array([[2, 4, 1], [0.3, 0.2, 0.1], [3, 2, 2.9]]),
        np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]),
    )
    matrix = cl.view_matrix(
        scene, south, sensors=sensors, samples=1 << 16, device=device
    )
    value, error = row_sum(matrix)
    assert_agrees(value, np.pi, error, precision=0.02)


def test_closed_white_room_is_dark(device):
    """No sky enters a closed room, however white."""
    scene, south = box(4, 5, 3, 0.8)
    closed = Scene(
        scene.materials, (*scene.surfaces, *(quad(*p.vertices) for p in south.polygons))
    )
    matrix = cl.daylight_coefficients(
        closed, sensors=sensor((2, 2, 1), UP), samples=1 << 16, device=device
    )
    assert matrix.values.sum() == 0


def rectangle_view(width, height, distance):
    """Irradiance on a plane from a parallel unit-radiance rectangle over its corner.

    Howell, Catalog of Radiation Heat Transfer Configuration Factors, B-3, times π.
    """
    x, y = width / distance, height / distance
    return 0.5 * (
        x / np.hypot(1, x) * np.arctan(y / np.hypot(1, x))
        + y / np.hypot(1, y) * np.arctan(x / np.hypot(1, y))
    )


@pytest.mark.parametrize("distance", [0.05, 0.5, 3.0, 30.0])
def test_direct_light_of_a_rectangle_is_its_configuration_factor(device, distance):
    """A sensor that faces a window's corner from near and far."""
    pane = window(quad((0, 0, 0), (0, 0, 1.5), (2, 0, 1.5), (2, 0, 0)))
    sensors = sensor((2, distance, 0), (0, -1, 0))
    matrix = cl.view_matrix(
        Scene(), pane, sensors=sensors, samples=1 << 14, device=device
    )
    value, error = row_sum(matrix)
    truth = rectangle_view(2, 1.5, distance)
    assert_agrees(value, truth, error, precision=2e-3 * truth)


def test_direct_light_of_triangles_is_that_of_their_rectangle(device):
    """A window cut into odd triangles shines like the whole."""
    whole = quad((0, 0, 0), (0, 0, 1.5), (2, 0, 1.5), (2, 0, 0))
    parts = (
        quad((0, 0, 0), (0, 0, 1.5), (2, 0, 1.5)),
        quad((0, 0, 0), (2, 0, 1.5), (2, 0, 0.4)),
        quad((0, 0, 0), (2, 0, 0.4), (2, 0, 0)),
    )
    sensors = sensor((1.2, 0.4, 0.3), (0.3, -1, 0.1))
    both = [
        cl.view_matrix(Scene(), group, sensors=sensors, samples=1 << 17, device=device)
        for group in (window(whole), window(*parts))
    ]
    error = np.hypot(both[0].standard_error, both[1].standard_error)
    lit = error > 0
    assert np.mean(error[lit]) < 0.02 * both[0].values[lit].mean()
    difference = np.abs(both[0].values - both[1].values)
    assert np.all(difference[lit] < 5 * error[lit])
    assert np.array_equal(both[0].values > 0, both[1].values > 0)


def test_mirror_shows_the_sky(device):
    """A sensor facing a perfect mirror reads π; the mirror is found by its own peak."""
    scene = endless_ground(0.0)
    mirror = grey(0.0, specularity=1.0, roughness=0.0)
    scene = Scene({"wall": mirror}, scene.surfaces)
    matrix = cl.daylight_coefficients(
        scene, sensors=sensor((0, 0, 1), (0, 0, -1)), samples=4096, device=device
    )
    assert matrix.values.sum() == pytest.approx(np.pi, rel=1e-5)


def pane_transmittance(cosine, transmissivity, index=1.52):
    """Transmittance of a thin pane from Fresnel's equations, both polarisations."""
    inner = np.sqrt(1 - (1 - cosine**2) / index**2)
    total = 0
    for r in (
        (cosine - index * inner) / (cosine + index * inner),
        (index * cosine - inner) / (index * cosine + inner),
    ):
        r, a = r**2, transmissivity ** (1 / inner)
        total = total + 0.5 * (1 - r) ** 2 * a / (1 - (r * a) ** 2)
    return total


def test_glass_passes_what_fresnel_says(device):
    """A sensor under an endless pane reads the cosine-weighted transmittance."""
    far = 1e5
    pane = quad((-far, -far, 2), (far, -far, 2), (far, far, 2), (-far, far, 2))
    scene = Scene({"wall": Glass("wall", np.full(3, 0.9))}, (pane,))
    matrix = cl.daylight_coefficients(
        scene, sensors=sensor((0, 0, 1), UP), samples=1 << 16, device=device
    )
    # What the pane reflects is ground: patch 0
    value = matrix.values[0, :, 1:].sum(axis=1)
    error = np.sqrt(np.square(matrix.components[:, 0, :, 1:].sum(axis=2)).sum(axis=0))
    cosine = (np.arange(20000) + 0.5) / 20000
    truth = np.mean(2 * np.pi * cosine * pane_transmittance(cosine, 0.9))
    assert_agrees(value, truth, error, precision=0.01)


def test_windows_shine_through_inner_glass(device):
    """A partition of glass before a window dims direct light by its transmittance."""
    pane = window(quad((0, 0, 0), (0, 0, 0.02), (0.02, 0, 0.02), (0.02, 0, 0)))
    glass = quad((-9, 1, -9), (9, 1, -9), (9, 1, 9), (-9, 1, 9), material="glass")
    scene = Scene({"glass": Glass("glass", np.full(3, 0.8))}, (glass,))
    sensors = sensor((0.01, 2, 0.01), (0, -1, 0))
    options = {"sensors": sensors, "samples": 4096, "device": device, "bounces": 1}
    clear = cl.view_matrix(Scene(), pane, **options).values.sum()
    dimmed = cl.view_matrix(scene, pane, **options).values.sum()
    assert dimmed / clear == pytest.approx(pane_transmittance(1.0, 0.8), rel=2e-3)


def test_rows_of_an_open_window_sum_to_one(device):
    """Before a window stand sky and ground only: nothing is lost."""
    _, south = box(4, 5, 3, 0.5)
    matrix = cl.daylight_matrix(Scene(), south, samples=1024, device=device)
    assert matrix.values.sum(axis=2) == pytest.approx(1, abs=1e-6)


def test_ground_returns_its_share(device):
    """Downward patches see the ground: their rows sum to its reflectance."""
    south = window(quad((0, 0, 1), (0, 0, 2), (2, 0, 2), (2, 0, 1)))
    matrix = cl.daylight_matrix(endless_ground(0.3), south, samples=4096, device=device)
    sums = matrix.values[0].sum(axis=1)
    arriving = -south.partition.centres()[:, 1]
    low = np.degrees(np.arcsin(arriving)) < -20
    high = np.degrees(np.arcsin(arriving)) > 20
    assert sums[low] == pytest.approx(0.3, abs=1e-5)
    assert sums[high] == pytest.approx(1, abs=1e-6)


def test_lambertian_window_halves_the_furnace(device):
    """A diffuser of transmittance ½ before a white room under a uniform sky: π/2."""
    scene, south = box(4, 5, 3, 1.0)
    view = cl.view_matrix(
        scene, south, sensors=sensor((2, 3, 1), UP), samples=1 << 15, device=device
    )
    daylight = cl.daylight_matrix(Scene(), south, samples=1024, device=device)
    diffuser = lambertian(0.5, south.partition).transmission_matrix()
    value, error = row_sum(view @ diffuser @ daylight)
    assert_agrees(value, np.pi / 2, error, precision=0.01)


def test_clear_air_is_no_window_at_all(device):
    """V·1·D through clear air equals daylight coefficients through the open wall."""
    scene, south = box(4, 5, 3, 0.5)
    sensors = Sensors(np.array([[2, 1, 1.0], [2, 4, 1]]), np.tile([0, 0, 1.0], (2, 1)))
    options = {"samples": 1 << 17, "device": device}
    view = cl.view_matrix(scene, south, sensors=sensors, **options)
    daylight = cl.daylight_matrix(scene, south, subdivision=1, **options)
    air = clear_air(south.partition).transmission_matrix()
    open_wall = cl.daylight_coefficients(
        scene, sensors=sensors, subdivision=1, **options
    )
    through, error = row_sum(view @ air @ daylight)
    directly, error_directly = row_sum(open_wall)
    assert_agrees(through, directly, np.hypot(error, error_directly), precision=0.02)


def test_matrix_pane_is_the_glass_it_stands_for(device):
    """V·T·D with a pane's matrix against glass in the opening, under a uniform sky.

    Klems patches average the pane's transmittance: half a percent of difference.
    """
    scene, south = box(4, 5, 3, 0.0)
    sensors = sensor((2, 1.5, 1), UP)
    options = {"samples": 1 << 16, "device": device}
    view = cl.view_matrix(scene, south, sensors=sensors, **options)
    daylight = cl.daylight_matrix(Scene(), south, subdivision=1, **options)
    pane = thin_pane(0.9, south.partition).transmission_matrix()
    [opening] = south.polygons
    glazed = Scene(
        {**scene.materials, "glass": Glass("glass", np.full(3, 0.9))},
        (*scene.surfaces, quad(*opening.vertices, material="glass")),
    )
    glass = cl.daylight_coefficients(glazed, sensors=sensors, subdivision=1, **options)
    through, error = row_sum(view @ pane @ daylight)
    directly, error_directly = row_sum(glass)
    assert np.hypot(error, error_directly) < 0.002 * directly
    assert through == pytest.approx(directly, rel=0.005)


@pytest.mark.parametrize("extent", [10.0, 400.0, 1e5])
@pytest.mark.parametrize("height", [1e-3, 1.0])
def test_tilted_planes_do_not_shade_themselves(device, extent, height):
    """A sensor facing a tilted plane of reflectance ½ reads π/2, however large it is.

    Coordinates of a large tilted face are rounded coarsely: paths must leave it
    without meeting it again.
    """
    turn = Rotation.from_euler("xyz", [33, 21, 58], degrees=True).as_matrix()
    flat = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * extent
    scene = Scene({"wall": grey(0.5)}, (quad(*(flat @ turn.T + [3, 2, 1])),))
    normal = turn[:, 2]
    above = sensor(np.array([3, 2, 1]) + height * normal, -normal)
    matrix = cl.daylight_coefficients(
        scene, sensors=above, samples=1 << 14, device=device
    )
    # From its height h, the sensor sees past the rim by less than (h / extent)²
    seen = (height / extent) ** 2
    assert matrix.values.sum() == pytest.approx(np.pi / 2, rel=1e-5 + seen)
