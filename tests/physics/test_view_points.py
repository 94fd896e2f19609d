"""Annual glare at view points against closed forms and pictures."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import box
from scipy.sparse import csc_array

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.directions import unit
from clerestory.errors import InputError, MatrixError
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.dgp import dgp
from clerestory.glare.eye_directions import SUN_SOLID_ANGLE
from clerestory.glare.point_glare import views_around
from clerestory.glare.position_index import position_index
from clerestory.glare.representative_steps import representative_steps
from clerestory.glare.source_table import GlareSources
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.view_point_tracer import trace_view_point
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.phases.direct_light import blackened
from clerestory.phases.matrix_equation import Skies, WindowMatrices
from clerestory.phases.methods import FIVE_PHASE, THREE_PHASE
from clerestory.phases.picture_matrices import reflected_view_matrices
from clerestory.phases.picture_series import luminance_over_time
from clerestory.phases.shaded_windows import (
    ShadedWindow,
    ShadeState,
    receiving_matrices,
)
from clerestory.phases.traced_matrices import daylight_matrix
from clerestory.phases.window_paths import picture_window_paths
from clerestory.scene.view import View
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import sun_matrix
from clerestory.sky.weather import Weather

EYE = np.array([2.0, 2.0, 1.5])
SOUTH = View(
    "angular", EYE, np.array([0, -1.0, 0]), np.array([0, 0, 1.0]), 180, 180
)  # fmt: skip


def weather(hours=8, normal=600.0, diffuse=120.0):
    """Sunny hours of one day in Oakland."""
    times = np.datetime64("2023-12-21T08:30") + np.arange(hours) * np.timedelta64(
        1, "h"
    )
    return Weather(
        place="Oakland",
        latitude_deg=37.73,
        longitude_deg=-122.22,
        elevation=0.0,
        utc_offset_hours=-8.0,
        times=times.astype("datetime64[m]"),
        step_minutes=60.0,
        direct_normal=np.full(hours, normal),
        diffuse_horizontal=np.full(hours, diffuse),
        source="a test",
    )


def even_sky(*radiance):
    """Skies of one radiance in all directions, ground included."""
    sky = sky_matrix(weather(len(radiance)), subdivision=1)
    even = np.tile(np.array(radiance, np.float32), (len(sky.partition), 1))
    return Skies(
        replace(
            sky,
            diffuse=even,
            colour=np.ones_like(sky.colour),
            sun=csc_array(even.shape),
        )
    )


def skies(data=None, subdivision=1):
    """S, S_ds and S_sun."""
    data = weather() if data is None else data
    sky, sun = (
        sky_matrix(data, subdivision=subdivision, include=part)
        for part in ("all", "sun")
    )
    return Skies(sky, sun, sun_matrix(data))


def clear_air():
    """A layer that lets everything pass straight, known on Klems patches."""
    patches = klems("full")
    value = np.diag(1 / patches.projected_solid_angles())
    part = ScatteringMatrix(value, patches, patches)
    return Bsdf({("visible", "transmission_front"): part})


def shaded(scene, south, *layers, peak=False, subdivision=1, samples=2048, seed=11):
    """A window with one state for each layer."""
    how = {"subdivision": subdivision, "samples": samples, "device": "cpu"}
    D = daylight_matrix(scene, south, seed=seed, **how)
    D_d = daylight_matrix(blackened(scene), south, bounces=0, seed=seed + 1, **how)
    states = []
    for layer in layers:
        T = layer.transmission_matrix(partition=south.partition, window=south.name)
        states.append(ShadeState(whole=(T, D), direct=(T, D_d), bsdf=layer, peak=peak))
    return ShadedWindow(south, tuple(states))


# --- closed forms -------------------------------------------------------------------


def test_even_sky_behind_a_diffusing_window(device):
    """Ev = π τ L F, with the configuration factor F of a parallel rectangle."""
    scene, south = box(4, 5, 3, 0.0)
    tau, radiance = 0.6, np.array([30.0, 60.0])
    room = shaded(scene, south, lambertian(tau, klems("full")))
    point = trace_view_point(
        scene, [room], EYE, skies=even_sky(*radiance), terms=THREE_PHASE,
        views=[SOUTH], samples=64, device=device,
    )  # fmt: skip
    found = point.glare(quantities=["dgp", "illuminance", "source_solid_angle"])
    a, b = 2 / 2, 1.5 / 2  # half width and half height over the distance
    x, y = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
    quarter = (a / x * np.arctan(b / x) + b / y * np.arctan(a / y)) / (2 * np.pi)
    level = 179 * tau * radiance
    np.testing.assert_allclose(
        found.illuminance[0], np.pi * level * 4 * quarter, rtol=2e-3
    )
    omega = 4 * np.arcsin(a * b / (x * y))
    np.testing.assert_allclose(found.source_solid_angle[0], omega, rtol=0.03)
    # The window seen in a picture of 800 × 800 pixels
    rays = SOUTH.rays(800, 800)
    towards = rays.direction[rays.valid]
    across, up = (towards[:, axis] / -towards[:, 1] for axis in (0, 2))
    inside = (towards[:, 1] < 0) & (abs(across) < a) & (abs(up) < b)
    pixels = np.zeros((2, *rays.valid.shape))
    pixels[:, rays.valid] = inside * level[:, None]
    expected = annual_glare(pixels, SOUTH)
    np.testing.assert_allclose(found.dgp[0], expected.dgp, atol=0.002)


def test_the_suns_disc_through_clear_air(device):
    """A disc of DNI/Ω where the line to the sun meets the window, and DGP of it."""
    scene, south = box(4, 5, 3, 0.0)
    sky = skies()
    room = shaded(scene, south, clear_air(), peak=True)
    point = trace_view_point(
        scene, [room], EYE, skies=sky, views=[SOUTH], samples=16, device=device
    )
    every = np.arange(len(sky.times))
    disc = point.sun_disc([0 * every], every)
    normal = sky.suns.direct_normal.tocoo()
    sun, step = normal.coords
    towards = sky.suns.directions[sun]
    across, up = (towards[:, axis] / -towards[:, 1] * 2 for axis in (0, 2))
    inside = (towards[:, 1] < 0) & (abs(across) < 2) & (abs(up) < 1.5)
    assert 0 < inside.sum() < len(every)
    np.testing.assert_allclose(
        disc.solid_angle[step], inside * SUN_SOLID_ANGLE, rtol=1e-6
    )
    seen = step[inside]
    np.testing.assert_allclose(
        disc.luminance[seen], 179 * normal.data[inside] / SUN_SOLID_ANGLE, rtol=2e-3
    )
    np.testing.assert_allclose(disc.direction[seen], towards[inside])
    # The disc decides; sources of the sky add little
    found = point.glare(quantities=["dgp", "illuminance"]).isel(view=0)
    for number in np.flatnonzero(inside):
        at, look = step[number], towards[number]
        beam = disc.luminance[at] * SUN_SOLID_ANGLE * -look[1]
        rest = float(found.illuminance[at]) - beam
        assert 0 < rest < beam
        sigma = np.arccos([-look[1]])
        tau = np.arccos([unit(look * [1, 0, 1])[2]])
        alone = GlareSources.of(
            luminance=[disc.luminance[at]],
            solid_angle=[SUN_SOLID_ANGLE],
            position_index=position_index(sigma, tau, np.array([False])),
        )
        least = dgp(alone, illuminance=beam + rest)
        assert float(found.dgp[at]) == pytest.approx(least, abs=0.02)


# --- consistency ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def lit_room():
    """A grey room with a clear and a diffusing state, five phases."""
    scene, south = box(4, 5, 3, 0.5)
    layers = clear_air(), lambertian(0.4, klems("full"))
    return scene, shaded(scene, south, *layers, subdivision=2), skies(subdivision=2)


@pytest.fixture(scope="module")
def lit_point(lit_room):
    scene, room, sky = lit_room
    return trace_view_point(
        scene, [room], EYE, skies=sky, views=views_around(4, position=EYE),
        samples=128, seed=3, device="cpu",
    )  # fmt: skip


@pytest.mark.parametrize("state", [0, 1])
def test_dgp_is_that_of_pictures(lit_room, lit_point, state):
    scene, room, sky = lit_room
    states = [np.full(len(sky.times), state)]
    found = lit_point.glare(states)
    for number in (1, 2):
        view = lit_point.views[number]
        camera, given = Camera(view, 200, 200), (scene, [room.window])
        V = reflected_view_matrices(*given, camera, samples=32, seed=7, device="cpu")
        paths = picture_window_paths(*given, camera, samples=64, seed=8, device="cpu")
        matrices = receiving_matrices([room], V, paths, sky.suns.directions)
        series = luminance_over_time(matrices, FIVE_PHASE, camera, sky, states)
        expected = annual_glare(np.stack(list(series)), view)
        off = found.dgp[number].values - expected.dgp.values
        assert np.abs(off).mean() < 0.005
        assert np.abs(off).max() < 0.02
        np.testing.assert_allclose(
            found.illuminance[number], expected.illuminance, rtol=0.02
        )


def test_steps_may_be_asked_for_by_themselves(lit_point):
    count = len(lit_point.skies.times)
    states = [np.arange(count) % 2]
    whole, some = lit_point.glare(states), np.array([1, 2, 5])
    part = lit_point.glare(states, steps=some)
    for name in ("dgp", "illuminance", "dgp_error"):
        np.testing.assert_allclose(part[name], whole[name][:, some], rtol=1e-4)
    assert np.all((whole.dgp_error > 0) | (whole.dgp == 1))


@pytest.mark.slow
@pytest.mark.parametrize(
    "layer", [lambertian(0.2, klems("full")), clear_air()], ids=["diffusing", "clear"]
)
def test_dgp_scatters_over_seeds_as_its_error_says(layer):
    """All matrices are traced anew with every seed, T excepted."""
    scene, south = box(4, 5, 3, 0.5)
    sky, found = skies(subdivision=2), []
    for seed in range(1, 13):
        room = shaded(scene, south, layer, subdivision=2, samples=512, seed=10 * seed)
        point = trace_view_point(
            scene, [room], EYE, skies=sky, views=views_around(4, position=EYE),
            refinement=Refinement(tolerance=0.05, most=1024), samples=32,
            sun_samples=32, seed=100 * seed, device="cpu",
        )  # fmt: skip
        found.append(point.glare())
    dgp, error = (
        np.array([one[name].values for one in found]) for name in ("dgp", "dgp_error")
    )
    below = dgp.max(axis=0) < 0.97
    assert below.sum() >= 10
    scatter = dgp.var(axis=0, ddof=1)[below].mean()
    assert 0.8 < np.sqrt(np.square(error)[:, below].mean() / scatter) < 1.25


def test_the_cells_cover_the_sphere_and_are_few(lit_point):
    assert lit_point.samples.solid_angle.sum() == pytest.approx(4 * np.pi)
    assert lit_point.samples.count <= Refinement().most


def test_steps_that_stand_for_the_year_have_its_suns():
    data = weather(8)
    chosen = representative_steps(skies(data), count=4)
    assert 2 <= len(chosen) <= 4
    assert len(set(chosen.tolist())) == len(chosen)


# --- bad input -----------------------------------------------------------------------


def test_bad_input_is_named(lit_room, lit_point):
    scene, room, sky = lit_room
    with pytest.raises(InputError, match="no window given"):
        trace_view_point(scene, [], EYE, skies=sky)
    with pytest.raises(InputError, match="no views"):
        trace_view_point(scene, [room], EYE, skies=sky, views=[])
    with pytest.raises(InputError, match="view point"):
        trace_view_point(scene, [room], EYE * np.nan, skies=sky)
    with pytest.raises(InputError, match="glare quantity is 'glow'"):
        lit_point.glare(quantities=["glow"])
    with pytest.raises(MatrixError, match=r"shade states \[2\]"):
        lit_point.glare([np.full(len(sky.times), 2)])
    plain = replace(room, states=(replace(room.states[0], bsdf=None),))
    with pytest.raises(MatrixError, match="no BSDF"):
        trace_view_point(scene, [plain], EYE, skies=sky, samples=1, device="cpu")


def test_windows_without_sun_are_those_of_three_phases(lit_point):
    assert all(isinstance(each, WindowMatrices) for each in lit_point.windows)
