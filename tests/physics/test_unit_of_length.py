"""Light does not depend on the unit of length, nor on the place of a scene.

A room is scaled by 1e-6 to 1e9 and moved by up to 1e9 m. Reference is the same room in
metres at the origin, traced with the same seed, and closed forms.
"""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import quad

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.engine.unusual_lengths import in_usual_lengths, scene_factor
from clerestory.hemisphere.klems import klems
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.phases.traced_matrices import view_job
from clerestory.phases.unscattered_light import sun_visible
from clerestory.scene.model import (
    Dielectric,
    Glass,
    Light,
    Plastic,
    Scene,
    Sphere,
    TriangleMesh,
)
from clerestory.scene.scaling import scaled
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import transformed
from clerestory.scene.transform import Transform
from clerestory.scene.window import window_of

# A ball of glass has no technique of its own for the lamp
pytestmark = pytest.mark.filterwarnings("ignore:.*is found by chance")

EFFORT = cl.Effort(samples=4096, bounces=4, seed=3)
UP = np.array([0.0, 0.0, 1.0])


def rectangle(corner, u, v, material):
    a, u, v = (np.array(x, dtype=float) for x in (corner, u, v))
    return quad(a, a + u, a + u + v, a + v, material=material)


def room(*more):
    """A room of 4 × 6 × 3 m with a window of 2 × 1.5 m to the south, on the ground."""
    walls = [
        rectangle((0, 0, 0), (4, 0, 0), (0, 6, 0), "dark"),
        rectangle((0, 0, 3), (0, 6, 0), (4, 0, 0), "wall"),
        rectangle((0, 0, 0), (0, 6, 0), (0, 0, 3), "wall"),
        rectangle((4, 0, 0), (0, 0, 3), (0, 6, 0), "wall"),
        rectangle((0, 6, 0), (4, 0, 0), (0, 0, 3), "wall"),
        rectangle((0, 0, 0), (0, 0, 3), (1, 0, 0), "wall"),
        rectangle((3, 0, 0), (0, 0, 3), (1, 0, 0), "wall"),
        rectangle((1, 0, 0), (0, 0, 1), (2, 0, 0), "wall"),
        rectangle((1, 0, 2.5), (0, 0, 0.5), (2, 0, 0), "wall"),
        rectangle((-50, -50, -0.1), (100, 0, 0), (0, 100, 0), "dark"),
    ]
    materials = {
        "wall": Plastic("wall", np.full(3, 0.5)),
        "dark": Plastic("dark", np.full(3, 0.3)),
        "glass": Glass("glass", np.full(3, 0.96)),
        "lamp": Light("lamp", np.full(3, 100.0)),
        "solid": Dielectric("solid", np.ones(3), 1.5),
    }
    return Scene(materials, (*walls, *more))


PANE = rectangle((1, 0, 1), (0, 0, 1.5), (2, 0, 0), "glass")
LAMP = rectangle((1.5, 3, 2.95), (0, 1, 0), (1, 0, 0), "lamp")
BALL = Sphere(np.array([1.5, 3.2, 1.5]), 0.4, False, "solid")
SOUTH = window_of((PANE,), name="south", partition=klems("quarter"))
DESKS = Sensors(
    np.array([[2, 1, 0.8], [2, 3, 0.8], [0.5, 5, 0.8]]), np.tile(UP, (3, 1))
)
SUNS = np.array([[0.1, -0.8, 0.6]]) / np.sqrt(1.01)
LOOK = cl.View(position=np.array([2, 5.5, 1.5]), direction=np.array([0, -1, -0.3]))
PLAN = cl.View(
    kind="parallel",
    position=np.array([2.0, 3, 2.9]),
    direction=-UP,
    up=np.array([0.0, 1, 0]),
    horizontal=4,
    vertical=4,
)


def moved(value, factor, offset):
    """A scene, window, sensors or view, scaled and moved."""
    value, shift = scaled(value, factor), np.asarray(offset, dtype=float)
    move = Transform(np.vstack([np.eye(4)[:3], [*shift, 1]]))
    if isinstance(value, Scene):
        surfaces = tuple(transformed(surface, move) for surface in value.surfaces)
        return replace(value, surfaces=surfaces)
    if isinstance(value, cl.Window):
        polygons = tuple(transformed(polygon, move) for polygon in value.polygons)
        return replace(value, polygons=polygons)
    return replace(value, position=value.position + shift)


def view_matrix(place):
    matrix = cl.view_matrix(
        place(room()), place(SOUTH), sensors=place(DESKS), effort=EFFORT
    )
    return matrix.values.sum(axis=2)[0]


def daylight_matrix(place):
    matrix = cl.daylight_matrix(
        place(room()), place(SOUTH), subdivision=1, effort=EFFORT
    )
    return matrix.values[0].sum(axis=1)


def daylight_coefficients(place):
    matrix = cl.daylight_coefficients(
        place(room(PANE)), sensors=place(DESKS), subdivision=1, effort=EFFORT
    )
    return matrix.values.sum(axis=2)[0]


def irradiance(place):
    """A lamp above a ball of glass."""
    scene = place(room(PANE, LAMP, BALL))
    return cl.irradiance(scene, sensors=place(DESKS), effort=EFFORT).irradiance[:, 0]


def direct_sun(place):
    layer = lambertian(0.5, klems("quarter"))
    matrix = sun_coefficients(
        place(room()),
        [place(SOUTH)],
        "south",
        layer,
        sensors=place(DESKS),
        suns=SUNS,
        samples=4096,
        seed=3,
    )
    return matrix.values[0, :, 0]


def sun_on_the_floor(place):
    grid = np.stack(np.meshgrid(np.arange(0.2, 4, 0.4), np.arange(0.1, 3, 0.4)), -1)
    points = np.concatenate(
        [grid.reshape(-1, 2), np.full((grid[..., 0].size, 1), 0.1)], 1
    )
    sensors = place(Sensors(points, np.tile(UP, (len(points), 1))))
    return sun_visible(place(room()), sensors.position, SUNS, device="cpu").mean()


def picture(place, view):
    scene = place(room(PANE, LAMP))
    effort = replace(EFFORT, samples=256)
    made = cl.render(scene, place(view), columns=12, rows=9, effort=effort)
    return made.picture.radiance[..., 0].mean(axis=1)


QUANTITIES = {
    "V": (view_matrix, 1e-3),
    "D": (daylight_matrix, 1e-3),
    "C": (daylight_coefficients, 1e-3),
    "irradiance": (irradiance, 0.02),
    "C_ds": (direct_sun, 1e-3),
    "sunlit points": (sun_on_the_floor, 1e-9),
    "picture": (lambda place: picture(place, LOOK), 0.02),
    "parallel picture": (lambda place: picture(place, PLAN), 0.02),
}


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_light_is_the_same_at_every_scale_and_place(quantity):
    light, tolerance = QUANTITIES[quantity]
    truth = light(lambda value: value)
    assert np.all(truth > 0)
    for factor, offset in (
        (1e-6, (0, 0, 0)),
        (1e-3, (50, -70, 0)),
        (1e3, (0, 0, 0)),
        (1e6, (0, 0, 0)),
        (1e9, (1e12, 0, 1e12)),
        (1.0, (4e6, -7e6, 300)),
        (0.3048, (1e5, 1e5, 0)),
    ):
        found = light(lambda value, f=factor, o=offset: moved(value, f, o))
        np.testing.assert_allclose(found, truth, rtol=tolerance, err_msg=f"{factor}")


@pytest.mark.parametrize("factor", [0.0254, 0.3048, 10.0])
def test_materials_keep_their_lengths_relative_to_the_scene(factor):
    """A ball of glass with a transmissivity of 0.2 per metre of the first scene."""
    tinted = Dielectric("solid", np.full(3, 0.2), 1.5)
    scene = room(PANE, LAMP, BALL)
    scene = replace(scene, materials={**scene.materials, "solid": tinted})
    found = [
        cl.render(
            scaled(scene, scale), scaled(PLAN, scale), columns=12, rows=9, effort=EFFORT
        )
        for scale in (1.0, factor)
    ]
    mean, error = (
        np.array([np.mean(f(made)) for made in found])
        for f in (lambda m: m.picture.radiance, lambda m: m.error)
    )
    assert abs(mean[1] - mean[0]) < error.max()
    passed = scaled(scene, factor).materials["solid"].transmissivity
    assert passed**factor == pytest.approx(np.full(3, 0.2))


@pytest.mark.parametrize("factor", [1e-6, 1e-3, 1.0, 1e3, 1e9])
def test_a_closed_lamp_gives_its_radiance_times_pi(factor):
    """Inside a ball that shines with 2 W/(m²·sr), every irradiance is 2 π."""
    ball = Sphere(np.zeros(3), 3.0, True, "lamp")
    shining = Scene({"lamp": Light("lamp", np.full(3, 2.0))}, (ball,))
    sensors = Sensors(np.array([[0.5, 1.0, -1.0]]), np.array([[0.3, 0.2, 0.9]]))
    found = cl.irradiance(
        scaled(shining, factor), sensors=scaled(sensors, factor), effort=EFFORT
    )
    assert found.irradiance[0] == pytest.approx(2 * np.pi, rel=0.01)


@pytest.mark.parametrize("factor", [1e-6, 1.0, 9e7])
def test_a_trapezium_far_away_is_no_rectangle(factor):
    """A window with one slanted edge, 10 000 km from the origin of its coordinates."""
    corners = np.array([[0.0, 0, 0], [0, 0, 2], [1, 0, 2], [2, 0, 0]])
    offset = np.array([1e7, 1e7, 0]) * factor
    sensors = Sensors(np.array([[1.0, 1, 0.5]]), np.array([[0.0, -1, 0]]))
    values = []
    for shift in (0 * offset, offset):
        gap = window_of(
            (quad(*(corners * factor + shift)),), name="g", partition=klems("quarter")
        )
        eye = replace(sensors, position=sensors.position * factor + shift)
        matrix = cl.view_matrix(Scene(), gap, sensors=eye, effort=EFFORT)
        values.append(matrix.values.sum())
    assert values[1] == pytest.approx(values[0], rel=2e-3)


@pytest.mark.parametrize("factor", [1e-6, 1e-3, 1e9])
def test_a_shading_system_scatters_alike_in_every_unit(factor):
    """Slats of 16 mm, every 12 mm, at 45°, in a periodic cell."""
    cut = 0.016 * np.sqrt(0.5)
    slat = quad((0, 0, 0), (0.05, 0, 0), (0.05, -cut, -cut), (0, -cut, -cut))
    cell = np.array([[0, -cut, -cut], [0.05, 0.012 - cut, 0]])
    grey = Scene({"wall": Plastic("wall", np.full(3, 0.6))}, (slat,))
    shares = []
    for scale in (1.0, factor):
        area = SampleArea(cell * scale, periodic=True)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="the system is .* wide")
            made = cl.generate_bsdf(
                scaled(grey, scale), area=area, basis="quarter", samples=512, seed=2
            )
        shares.append(made.diffuse("transmission_front"))
    assert shares[1] == pytest.approx(shares[0], rel=5e-3)


def test_scenes_of_usual_size_are_traced_as_they_are():
    """Also a room in a terrain of 1000 km, and a street of rooms."""
    job = view_job(room(), [SOUTH], DESKS, EFFORT)
    assert in_usual_lengths(job) is job
    land = np.array([[-5e5, -5e5, -1], [5e5, -5e5, -1], [5e5, 5e5, -1]])
    terrain = TriangleMesh(land, np.array([[0, 1, 2]]), "dark")
    assert scene_factor(room(terrain)) == 1
    for factor in (0.0254, 0.3048, 1e3, 1e5):
        assert scene_factor(scaled(room(), factor)) == 1
    assert scene_factor(scaled(room(), 1e-6)) == 2.0**22
    assert scene_factor(Scene()) == 1
