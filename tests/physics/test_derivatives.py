"""Derivatives of matrices by reflectances: closed forms and central differences."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import endless_ground, quad, sensor, window

import clerestory as cl
from clerestory.errors import InputError
from clerestory.scene.material_parameters import with_parameters
from clerestory.scene.model import (
    Glass,
    Light,
    Metal,
    Mirror,
    Plastic,
    Scene,
    Sphere,
    Trans,
)
from clerestory.scene.sensors import Sensors
from clerestory.spectral.band_sets import wavelength_bands

UP, NORTH, DOWN = (0, 0, 1), (0, 1, 0), (0, 0, -1)


def colour(*values):
    """A colour, or a grey for one value."""
    return np.broadcast_to(np.array(values, dtype=float), 3).copy()


def sums(matrix):
    """Sum of all coefficients in each channel, and its standard error."""
    return matrix.values.sum(axis=(1, 2)), error_of(matrix.components)


def error_of(components):
    """Standard error of the sum of all coefficients in each channel."""
    return np.sqrt(np.square(components.sum(axis=(2, 3), dtype=float)).sum(axis=0))


def agrees(matrix, expected, *, most):
    """Check a sum against a closed form, and that its error is small."""
    value, error = sums(matrix)
    assert (np.abs(value - expected) <= 4 * error + 2e-6 * np.abs(expected)).all()
    assert (error <= most * np.abs(expected)).all()


def coefficients(scene, position, direction, device, samples=1 << 15, **keywords):
    """Daylight coefficients of one sensor, with all derivatives."""
    return cl.daylight_coefficients(
        scene,
        sensors=sensor(position, direction),
        subdivision=1,
        derivatives=keywords.pop("derivatives", "all"),
        samples=samples,
        device=device,
        **keywords,
    )


def sheet(height, name):
    """An endless horizontal plane."""
    far = 1e5
    corners = (-far, -far), (far, -far), (far, far), (-far, far)
    return quad(*((x, y, height) for x, y in corners), material=name)


@pytest.mark.parametrize("samples", [4096])
def test_values_are_bitwise_those_without_derivatives(device, samples):
    scene = endless_ground(0.4)
    made = {"sensors": sensor((0, 0, 1), NORTH), "samples": samples, "device": device}
    plain = cl.daylight_coefficients(scene, subdivision=1, **made)
    other = cl.daylight_coefficients(scene, subdivision=1, derivatives="all", **made)
    assert np.array_equal(plain.values, other.values)
    assert np.array_equal(plain.components, other.components)
    assert plain.derivatives is None


def test_a_surface_that_an_open_sensor_does_not_see_has_no_derivative(device):
    matrix = coefficients(endless_ground(0.5), (0, 0, 1), UP, device)
    assert not matrix.derivative("wall").values.any()
    assert not matrix.second_derivative("wall", "wall").values.any()


def test_vertical_sensor_over_endless_ground(device):
    """E = (1 + ρ) π/2, so dE/dρ = π/2 and the second derivative is zero."""
    scene = endless_ground(0.3)
    coloured = Scene({"wall": Plastic("wall", colour(0.1, 0.3, 0.6))}, scene.surfaces)
    for each, value in ((scene, 0.3), (coloured, 0.2665)):
        matrix = coefficients(each, (0, 0, 1), NORTH, device)
        (parameter,) = matrix.derivatives.parameters
        assert parameter.value == pytest.approx(value)
        share = each.materials["wall"].reflectance[: len(matrix.values)] / value
        agrees(matrix.derivative("wall"), share * np.pi / 2, most=0.01)
        assert not matrix.second_derivative("wall", "wall").values.any()


def test_closed_furnace_of_translucent_walls(device):
    """Walls transmit τ = ρt and reflect ρ(1 − t): E = π τ Σ (ρ(1 − t))ⁿ.

    The faces are six materials. By linearity, the derivatives by all faces sum to the
    derivative of the series, and so do those by all pairs.
    """
    t, rho, size = 0.4, 0.75, 2.0
    z = size
    faces = {
        "floor": ((0, 0, 0), (z, 0, 0), (z, z, 0), (0, z, 0)),
        "roof": ((0, 0, z), (0, z, z), (z, z, z), (z, 0, z)),
        "west": ((0, 0, 0), (0, z, 0), (0, z, z), (0, 0, z)),
        "east": ((z, 0, 0), (z, 0, z), (z, z, z), (z, z, 0)),
        "north": ((0, z, 0), (z, z, 0), (z, z, z), (0, z, z)),
        "south": ((0, 0, 0), (0, 0, z), (z, 0, z), (z, 0, 0)),
    }
    wall = Trans("wall", colour(rho), transmission=t)
    scene = Scene(
        {name: replace(wall, name=name) for name in faces},
        tuple(quad(*face, material=name) for name, face in faces.items()),
    )
    matrix = coefficients(scene, (0.7, 1.1, 0.9), (0, 0.6, 0.8), device, 1 << 18)
    rest = 1 - rho * (1 - t)
    of = matrix.derivatives
    every = replace(
        matrix,
        values=of.first.sum(axis=0),
        components=of.components.sum(axis=1),
        derivatives=None,
    )
    agrees(matrix, np.pi * rho * t / rest, most=2e-3)
    agrees(every, np.pi * t / rest**2, most=4e-3)
    both = sum(
        of.second[of.pair(*pair)].sum() * (1 if pair[0] == pair[1] else 2)
        for pair in of.pairs
    )
    assert both == pytest.approx(2 * np.pi * t * (1 - t) / rest**3, rel=0.02)


def test_two_endless_planes_of_two_materials(device):
    """Under a sheet of τ = ct and r = c(1 − t), over ground ρ: E = π ct / (1 − ρr)."""
    rho, c, t = 0.6, 0.8, 0.3
    scene = Scene(
        {
            "ground": Plastic("ground", colour(rho)),
            "sheet": Trans("sheet", colour(c), transmission=t),
        },
        (sheet(0, "ground"), sheet(2, "sheet")),
    )
    matrix = coefficients(scene, (0, 0, 1), UP, device, 1 << 20)
    r = c * (1 - t)
    rest = 1 - rho * r
    agrees(matrix.derivative("ground"), np.pi * c * t * r / rest**2, most=0.01)
    agrees(matrix.derivative("sheet"), np.pi * t / rest**2, most=0.01)
    pairs = {
        ("ground", "ground"): 2 * c * t * r**2 / rest**3,
        ("ground", "sheet"): 2 * t * r / rest**3,
        ("sheet", "sheet"): 2 * t * rho * (1 - t) / rest**3,
    }
    for pair, expected in pairs.items():
        value = matrix.second_derivative(*pair).values.sum()
        assert value == pytest.approx(np.pi * expected, rel=0.03)


def pane_irradiance(tau, index):
    """Irradiance below a pane, of transmitted sky and reflected ground of radiance 1.

    By Fresnel's formulas, with all reflections between both sides of the pane.
    """
    x, w = np.polynomial.legendre.leggauss(200)
    cosine = 0.5 + 0.5 * x
    inner = np.sqrt(1 - (1 - cosine**2) / index**2)
    bulk, total = tau ** (1 / inner), 0
    for n, other in ((index * inner, cosine), (inner, index * cosine)):
        r = ((other - n) / (other + n)) ** 2
        passed = (1 - r) ** 2 * bulk / (1 - (r * bulk) ** 2)
        total = total + 0.5 * (passed + r + r * bulk * passed)
    return np.pi * np.sum(w * total * cosine)


def test_endless_pane_of_glass(device):
    """The derivative by the transmissivity is that of Fresnel's formulas."""
    tau, index, step = 0.85, 1.52, 1e-4
    scene = Scene({"pane": Glass("pane", colour(tau), index)}, (sheet(2, "pane"),))
    matrix = coefficients(scene, (0, 0, 1), UP, device, 1 << 17)
    less, more = (pane_irradiance(tau + d, index) for d in (-step, step))
    agrees(matrix, pane_irradiance(tau, index), most=2e-3)
    agrees(matrix.derivative("pane"), (more - less) / (2 * step), most=2e-3)


def test_endless_mirror(device):
    """A sensor that faces a mirror reads π ρ."""
    scene = Scene({"glass": Mirror("glass", colour(0.8))}, (sheet(0, "glass"),))
    agrees(coefficients(scene, (0, 0, 1), DOWN, device).derivative("glass"), np.pi,
           most=1e-3)  # fmt: skip


def test_smooth_plastic_reflects_less_colour(device):
    """The coat does not depend on the colour: dE/dρ is the share of diffuse light."""
    scene = endless_ground(0.5)
    wall = Plastic("wall", colour(0.5), specularity=0.1, roughness=0.1)
    matrix = coefficients(
        Scene({"wall": wall}, scene.surfaces), (0, 0, 1), DOWN, device, 1 << 17
    )
    agrees(matrix.derivative("wall"), 0.9 * np.pi, most=0.01)


def test_rows_of_a_daylight_matrix_that_see_the_ground(device):
    """A patch that sees the ground alone has the radiance ρ."""
    scene = endless_ground(0.3)
    opening = window(quad((0, 0, 1), (0, 0, 2), (1, 0, 2), (1, 0, 1)))
    matrix = cl.daylight_matrix(
        scene, opening, subdivision=1, derivatives=["wall"], samples=2048, device=device
    )
    total = matrix.derivative("wall").values.sum(axis=2)[0]
    assert np.isclose(total, 1, atol=0.02).any()
    assert np.all((total >= 0) & (total <= 1.02))


def room():
    """A room of many materials, and its window."""
    w, d, h = 3, 4, 3
    faces = {
        "floor": ((0, 0, 0), (w, 0, 0), (w, d, 0), (0, d, 0)),
        "ceiling": ((0, 0, h), (0, d, h), (w, d, h), (w, 0, h)),
        "metal": ((0, 0, 0), (0, d, 0), (0, d, h), (0, 0, h)),
        "mirror": ((w, 0, 0), (w, 0, h), (w, d, h), (w, d, 0)),
        "plastic": ((0, d, 0), (w, d, 0), (w, d, h), (0, d, h)),
        "glass": ((0.2, 1, 0.3), (2.8, 1, 0.3), (2.8, 1, 2.8), (0.2, 1, 2.8)),
        "trans": ((0.5, 1.5, 0.3), (1.5, 1.5, 0.3), (1.5, 1.5, 1.8), (0.5, 1.5, 1.8)),
        "film": ((1.8, 1.5, 0.3), (2.5, 1.5, 0.3), (2.5, 1.5, 1.8), (1.8, 1.5, 1.8)),
    }
    materials = (
        Plastic("floor", colour(0.3, 0.25, 0.2)),
        Plastic("ceiling", colour(0.8, 0.8, 0.7)),
        Metal("metal", colour(0.6, 0.5, 0.4), 0.7, 0.1),
        Mirror("mirror", colour(0.9, 0.85, 0.9)),
        Plastic("plastic", colour(0.5, 0.3, 0.5), 0.1, 0.0),
        Glass("glass", colour(0.9, 0.8, 0.85)),
        Trans("trans", colour(0.7, 0.7, 0.6), 0.05, 0.1, 0.5, 0.3),
        Trans("film", colour(0.7, 0.7, 0.6), 0.05, 0.0, 0.5, 0.3),
        Metal("ball", colour(0.8, 0.7, 0.4), 0.8, 0.0),
    )
    ball = Sphere(np.array([1.0, 3.0, 0.8]), 0.7, inward=False, material="ball")
    surfaces = tuple(quad(*face, material=name) for name, face in faces.items())
    opening = window(quad((0, 0, 0), (0, 0, h), (w, 0, h), (w, 0, 0)))
    return Scene({m.name: m for m in materials}, (*surfaces, ball)), opening


@pytest.fixture(scope="module")
def lit_room():
    scene, opening = room()
    points = Sensors(
        np.array([[1.5, 2.0, 0.8], [1.5, 3.0, 1.5]]),
        np.array([[0, 0, 1.0], [0, -1.0, 0]]),
    )
    trace = {"sensors": points, "samples": 1 << 19, "device": "cpu"}
    matrix = cl.view_matrix(scene, opening, derivatives="all", seed=1, **trace)
    return scene, opening, trace, matrix


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(room()[0].materials))
def test_every_material_agrees_with_central_differences(lit_room, name):
    """The third derivative changes central differences by less than a tenth of this."""
    scene, opening, trace, matrix = lit_room
    parameter = matrix.derivatives.parameters[matrix.derivatives.number(name)]
    change = 0.06 * parameter.value
    less, more = (
        cl.view_matrix(
            with_parameters(scene, {name: parameter.value + step}),
            opening,
            seed=seed,
            **trace,
        )
        for seed, step in ((2, -change), (3, change))
    )
    found, error = sums(matrix.derivative(name))
    (low, one), (high, other) = sums(less), sums(more)
    both = np.hypot(error, np.hypot(one, other) / (2 * change))
    assert (np.abs(found - (high - low) / (2 * change)) < 4 * both).all()
    assert (error < 0.02 * found).all()


def test_nine_bands_have_the_derivatives_of_each_band(device):
    """E = (1 + ρ_b) π/2 in each band; the coat of the plastic has no colour."""
    bands = wavelength_bands(range(380, 830, 45))
    share = np.linspace(0.1, 0.9, 9)
    wall = Plastic("wall", share, specularity=0.1, roughness=0.1)
    scene = Scene({"wall": wall}, endless_ground(0.5).surfaces, bands=bands)
    matrix = coefficients(scene, (0, 0, 1), DOWN, device, 1 << 15)
    (parameter,) = matrix.derivatives.parameters
    expected = 0.9 * np.pi * share / parameter.value
    agrees(matrix.derivative("wall"), expected, most=0.02)


@pytest.mark.parametrize(
    ("material", "words"),
    [
        (Light("lamp", colour(1.0)), "a light source"),
        (Plastic("lamp", colour(0.0)), "black"),
    ],
)
def test_materials_without_derivative_are_named(material, words):
    scene = Scene({"lamp": material}, (sheet(0, "lamp"),))
    with pytest.raises(InputError, match=f'"lamp": it is {words}'):
        coefficients(scene, (0, 0, 1), UP, "cpu", derivatives=["lamp"])
    with pytest.raises(InputError, match="expected"):
        coefficients(scene, (0, 0, 1), UP, "cpu", derivatives=["wall"])
