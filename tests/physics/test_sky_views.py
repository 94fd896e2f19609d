"""Radiance of cells in scenes with glazing against closed forms and path tracing."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import box, endless_ground, grey, quad
from test_view_points import weather

import clerestory as cl
from clerestory.bsdf.analytic import glass_properties
from clerestory.constants import SUN_DIAMETER
from clerestory.directions import unit
from clerestory.errors import InputError
from clerestory.glare.glazed_view_points import glazed_view_glare
from clerestory.glare.sphere_samples import regular_samples
from clerestory.phases.matrix_equation import Skies
from clerestory.phases.rendering import irradiance
from clerestory.phases.sky_views import (
    sky_view_matrices,
    sun_disc,
    sun_view_coefficients,
)
from clerestory.radiance.generated_sky import sky_at
from clerestory.scene.model import Glass, Metal, Plastic, Scene, Trans
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix

EYE = np.array([0.0, 0.0, 2.0])
SUNS = unit(np.array([[0.2, -0.5, 0.6], [-0.7, 0.1, 0.3]]))
REFLECTANCE, TRANSMISSIVITY = 0.4, 0.8


def cells(position=EYE, level=3):
    """Cells around a point, and the directions of their middles."""
    samples = regular_samples(level).centred()
    return samples.cells(position), samples.direction


def pane_over_ground():
    """A wide pane between the eye and the ground."""
    far = 300
    corners = np.array([(-far, -far, 0), (far, -far, 0), (far, far, 0), (-far, far, 0)])
    ground, pane = (
        quad(*corners),
        quad(*(corners + np.array([0, 0, 1])), material="pane"),
    )
    glass = Glass("pane", np.full(3, TRANSMISSIVITY), 1.52)
    return Scene({"wall": grey(REFLECTANCE), "pane": glass}, (ground, pane))


def passed(cosine):
    """Transmittance of the pane."""
    share, _ = glass_properties(
        np.abs(cosine), transmissivity=TRANSMISSIVITY, index=1.52, panes=1
    )
    return share


def test_ground_under_open_sky_reflects_it(device):
    """ρ under a uniform sky, all of it direct; ρ/π cos θ in the sun."""
    receivers, direction = cells()
    ground = endless_ground(REFLECTANCE)
    C, C_d = sky_view_matrices(
        ground, receivers, subdivision=1, samples=256, device=device
    )
    # Cells at the horizon see both
    whole, below = abs(direction[:, 2]) > 0.4, direction[:, 2] < 0
    expected = np.where(below, REFLECTANCE, 1)[whole]
    assert C.values[0, whole].sum(axis=1) == pytest.approx(expected, abs=1e-3)
    assert C.values == pytest.approx(C_d.values)
    C_ds = sun_view_coefficients(ground, receivers, suns=SUNS, device=device)
    expected = np.where(below, REFLECTANCE / np.pi, 0)[:, None] * SUNS[:, 2]
    assert C_ds.values[0, whole] == pytest.approx(expected[whole], rel=0.01)


def test_sunlight_passes_a_pane_twice(device):
    """To the ground, and from there to the eye; the pane itself mirrors no sun."""
    receivers, direction = cells(level=4)
    C_ds = sun_view_coefficients(
        pane_over_ground(), receivers, suns=SUNS, samples=512, device=device
    )
    down = direction[:, 2] < -0.5
    lit = REFLECTANCE / np.pi * SUNS[:, 2] * passed(SUNS[:, 2])
    # Means over the directions of each cell
    parts = regular_samples(7).centred().direction
    cell = regular_samples(4).containing(parts)
    through = np.bincount(cell, passed(parts[:, 2])) / np.bincount(cell)
    expected = through[down, None] * lit
    found, error = C_ds.values[0, down], C_ds.components[0, 0, down]
    assert found == pytest.approx(expected, rel=0.2)
    assert found.mean(axis=0) == pytest.approx(expected.mean(axis=0), rel=0.01)
    assert abs((found - expected) / abs(error).mean()).max() < 8


def test_direct_light_is_scattered_once_at_most(device):
    """Between pane and ground, light that is reflected to and fro is not direct."""
    receivers, direction = cells()
    C, C_d = sky_view_matrices(
        pane_over_ground(), receivers, subdivision=1, samples=8192, device=device
    )
    down = direction[:, 2] < -0.75
    share = passed(np.sqrt((np.arange(4096) + 0.5) / 4096)).mean()
    expected = REFLECTANCE * share * passed(direction[down, 2])
    direct = C_d.values[0, down].sum(axis=1)
    assert direct == pytest.approx(expected, rel=0.05)
    assert direct.mean() == pytest.approx(expected.mean(), rel=0.005)
    assert np.all(C.values[0, down].sum(axis=1) > direct)


def test_half_of_the_disc_is_seen_beside_a_wall():
    """The wall's edge is on the middle of the sun; a pane dims what is left."""
    sun = unit(np.array([[0.0, -1.0, 0.5]]))
    hit = EYE + sun[0] * (4 / -sun[0, 1])
    corners = (0, 0, -1), (1, 0, -1), (1, 0, 1), (0, 0, 1)
    wall = quad(*(hit + 9 * np.array(c) for c in corners))
    scene = Scene({"wall": grey(0.5)}, (wall,))
    share, through = sun_disc(scene, EYE, sun)
    assert share == pytest.approx(0.5, abs=0.05)
    assert through == pytest.approx(1)
    pane = quad((-9, -1, -9), (9, -1, -9), (9, -1, 9), (-9, -1, 9), material="pane")
    glass = Glass("pane", np.full(3, TRANSMISSIVITY), 1.52)
    both = Scene({**scene.materials, "pane": glass}, (wall, pane))
    dimmed = sun_disc(both, EYE, sun)
    assert dimmed[0] == pytest.approx(share)
    assert dimmed[1] == pytest.approx(passed(sun[:, 1]), rel=1e-3)
    behind = sun_disc(scene, EYE, -sun)
    assert behind[0] == pytest.approx(1)
    assert SUN_DIAMETER < 0.01


def facade_room(glazing):
    """A room with glazing in its south wall, and a glossy façade opposite."""
    room, south = box(4, 5, 3, 0.5)
    panes = tuple(replace(each, material="pane") for each in south.polygons)
    opposite = quad(
        (-6, -6, 0), (-6, -6, 9), (10, -6, 9), (10, -6, 0), material="facade"
    )
    metal = Metal("facade", np.full(3, 0.3), 0.5, 0.05)
    ground = Plastic("ground", np.full(3, 0.2))
    lawn = quad((-9, -9, -0.01), (12, -9, -0.01), (12, 9, -0.01), (-9, 9, -0.01))
    return Scene(
        {**room.materials, "pane": glazing, "facade": metal, "ground": ground},
        (*room.surfaces, *panes, opposite, replace(lawn, material="ground")),
    )


@pytest.mark.parametrize(
    "glazing",
    [
        Glass("pane", np.full(3, TRANSMISSIVITY), 1.52),
        Trans("pane", np.full(3, 0.8), 0.05, 0.05, 0.5, 0.4),
    ],
    ids=["glass", "trans"],
)
def test_illuminance_at_an_eye_agrees_with_path_tracing(glazing, device):
    """Under Perez's continuous sky and the sun's disc, in the morning and at noon."""
    scene = facade_room(glazing)
    eye = View(
        "angular", np.array([2.0, 2.0, 1.2]), np.array([0, -1.0, 0]),
        np.array([0, 0, 1.0]), 180, 180,
    )  # fmt: skip
    hours = weather()
    S, S_ds = (
        sky_matrix(hours, include=part, sun_formula="radiance")
        for part in ("all", "sun")
    )
    skies = Skies(S, S_ds, sun_matrix(hours, sun_formula="radiance"))
    found = glazed_view_glare(scene, [eye], skies=skies, samples=2048, device=device)
    sensor = Sensors(eye.position[None], eye.direction[None])
    for step in (1, 4):
        lit = scene + sky_at(hours, hours.times[step].item())
        truth = irradiance(lit, sensor, samples=1 << 16, seed=3, device=device)
        error = truth.illuminance_error[0] / truth.illuminance()[0]
        assert error < 0.01
        ratio = found.illuminance.values[0, step] / truth.illuminance()[0]
        assert ratio == pytest.approx(1, abs=0.02 + 4 * error)
    assert np.all(found.dgp_error.values < 0.05)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"views": []}, "no views; at least one expected"),
        ({"skies": None}, "skies without S_ds or S_sun"),
        ({"views": "apart"}, "views from different points"),
    ],
)
def test_wrong_input_is_refused(change, message):
    hours = weather(1)
    sky = sky_matrix(hours, subdivision=1)
    views = [
        View("angular", EYE + np.array([n, 0, 0]), np.array([0, 1.0, 0]))
        for n in (0, 1)
    ]
    given = {"views": views[:1], "skies": Skies(sky, sky, sun_matrix(hours))} | change
    if given["views"] == "apart":
        given["views"] = views
    if given["skies"] is None:
        given["skies"] = Skies(sky)
    with pytest.raises(InputError, match=message):
        glazed_view_glare(cl.Scene(), **given)
