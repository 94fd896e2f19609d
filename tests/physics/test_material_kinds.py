"""Derivatives by every kind of material, and of façade matrices: closed forms."""

import numpy as np
import pytest
from physics_scenes import endless_ground, grey, quad, sensor, window

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.hemisphere.klems import klems
from clerestory.phases.facade_matrices import facade_daylight, facade_matrices
from clerestory.scene.model import BsdfSurface, Scene

UP, DOWN = (0, 0, 1), (0, 0, -1)

# Materials of an endless ground, their value, and irradiance by their light over π for
# a value of 1: reflectance, or the scale of all that they reflect
KINDS = {
    "plastic": ("void plastic wall 0 0 5 .6 .6 .6 0 0", 0.6, 1.0),
    "rough metal": ("void metal wall 0 0 5 .6 .6 .6 .5 .3", 0.6, None),
    "smooth metal": ("void metal wall 0 0 5 .6 .6 .6 0 0", 0.6, 1.0),
    "trans": ("void trans wall 0 0 7 .6 .6 .6 0 0 .25 0", 0.6, 1.0),
    "mirror": ("void mirror wall 0 0 3 .6 .6 .6", 0.6, 1.0),
    "pattern": (
        "void brightfunc half 2 if(Px,1,0) . 0 0\nhalf plastic wall 0 0 5 .6 .6 .6 0 0",
        0.6,
        0.5,
    ),
    "texture": (
        "void texfunc bumps 4 .2*sin(Px) .1 0 . 0 0\n"
        "bumps plastic wall 0 0 5 .6 .6 .6 0 0",
        0.6,
        None,
    ),
    "mixture": (
        "void plastic light 0 0 5 .7 .7 .7 0 0\nvoid plastic dark 0 0 5 .2 .2 .2 0 0\n"
        "void mixfunc wall 4 light dark .3 . 0 0",
        1.0,
        0.3 * 0.7 + 0.7 * 0.2,
    ),
    "BRTDfunc": (
        "void BRTDfunc wall 10 .3 .3 .3 0 0 0 0 0 0 . 0 9 .2 .2 .2 .1 .1 .1 0 0 0",
        1.0,
        0.5,
    ),
}


def coefficients(scene, direction):
    return cl.daylight_coefficients(
        scene, sensors=sensor((0, 0, 1), direction), subdivision=1,
        derivatives=["wall"], samples=1 << 15, seed=3, device="cpu",
    )  # fmt: skip


def total(matrix):
    """Sum of all coefficients in each channel, and its standard error."""
    parts = matrix.components.sum(axis=(2, 3), dtype=float)
    return matrix.values.sum(axis=(1, 2)), np.sqrt(np.square(parts).sum(axis=0))


def agrees(matrix, expected, *, most):
    value, error = total(matrix)
    assert (np.abs(value - expected) <= 4 * error + 2e-6 * np.abs(expected)).all()
    assert (error <= most * np.abs(expected)).all()


@pytest.mark.parametrize("kind", KINDS)
def test_all_light_of_an_endless_ground_is_reflected_once(kind, tmp_path):
    """E is proportional to the value: dE/dρ = E/ρ, which has a closed form for most.

    Bumps and glossy metal lose some light below the horizon, so that only E/ρ of the
    same paths is known.
    """
    text, value, share = KINDS[kind]
    file = tmp_path / "ground.rad"
    corners = "-1e5 -1e5 0 1e5 -1e5 0 1e5 1e5 0 -1e5 1e5 0"
    file.write_text(f"{text}\nwall polygon ground 0 0 12 {corners}\n")
    matrix = coefficients(cl.read_rad(file), DOWN)
    (parameter,) = matrix.derivatives.parameters
    assert parameter.value == pytest.approx(value)
    slope = matrix.derivative("wall")
    assert slope.values == pytest.approx(matrix.values / value, rel=1e-3, abs=1e-6)
    if share is not None:
        agrees(slope, np.pi * share, most=0.01)
    # Roughness and bumps keep most of the light
    assert (total(slope)[0] > 0.9 * np.pi * (share or 1)).all()
    assert np.abs(matrix.second_derivative("wall", "wall").values).max() < 1e-3


@pytest.mark.parametrize("direction", [UP, DOWN], ids=["below", "above"])
def test_bsdf_surfaces_are_scaled(direction):
    """A Lambertian sheet between sky and ground: E = π (τ + ρ), one of them of sky."""
    layer = lambertian(0.3, klems("quarter"), reflectance=0.4)
    material = BsdfSurface("wall", layer, 0.0, np.array([0, 1.0, 0]))
    far, z = 1e5, 2.0 if direction == UP else 0.0
    corners = ((-far, -far), (far, -far), (far, far), (-far, far))
    sheet = quad(*((x, y, z) for x, y in corners))
    matrix = coefficients(Scene({"wall": material}, (sheet,)), direction)
    (parameter,) = matrix.derivatives.parameters
    assert (parameter.value, parameter.quantity) == (1.0, "scale")
    slope = matrix.derivative("wall")
    agrees(slope, np.pi * 0.7, most=0.01)
    ground = np.pi * (0.4 if direction == UP else 0.3)
    assert slope.values[0, 0, 0] == pytest.approx(ground, rel=0.03)


def test_facade_matrices_have_derivatives_by_the_surfaces_outside():
    """A shelf below the window reflects once: F D is linear in its reflectance.

    So the derivative times the reflectance is F D without F D of a black shelf.
    """
    pane = window(quad((0, 0, 1), (0, 0, 2), (1, 0, 2), (1, 0, 1)), basis="quarter")
    ports = [
        window(
            quad((-500, -2, low), (-500, -2, high), (500, -2, high), (500, -2, low)),
            name=name,
            basis="quarter",
        )
        for name, low, high in (("lower", -500, 1.2), ("upper", 1.2, 500))
    ]
    shelf = quad((-1, -1.5, 0.9), (2, -1.5, 0.9), (2, -0.1, 0.9), (-1, -0.1, 0.9))
    whole = {"samples": 1 << 14, "device": "cpu", "bounces": 1}
    made = []
    D = cl.daylight_matrices(endless_ground(0.2), ports, subdivision=1, **whole)
    for reflectance, chosen in ((0.5, ["wall"]), (1e-6, [])):
        room = Scene({"wall": grey(reflectance)}, (shelf,))
        F = facade_matrices(room, pane, ports, derivatives=chosen, seed=5, **whole)
        made.append(facade_daylight(F, D))
    light, dark = made
    slope, error = total(light.derivative("wall"))
    values = [total(each) for each in (light, dark)]
    expected = (values[0][0] - values[1][0]) / 0.5
    both = np.hypot(error, np.hypot(values[0][1], values[1][1]) / 0.5)
    assert (np.abs(slope - expected) < 4 * both).all()
    assert (error < 0.02 * slope).all()
    # Both ports are estimated from the same paths, in batches of their own
    assert len(light.derivatives.components) == len(light.components)
