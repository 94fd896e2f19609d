"""Changes of glare by reflectances against rooms that are traced with them."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import box, grey
from test_view_points import EYE, clear_air, shaded, skies, weather

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.errors import InputError
from clerestory.glare.glare_changes import glare_changes
from clerestory.glare.point_glare import views_around
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.view_point_tracer import trace_view_point
from clerestory.hemisphere.klems import klems
from clerestory.phases.methods import FIVE_PHASE, THREE_PHASE
from clerestory.scene.model import Scene

CELLS = Refinement(tolerance=0.02, most=1500)
VALUES = {"floor": 0.3, "wall": 0.6}


def room():
    """A room of a dark floor and light walls, and its window."""
    scene, south = box(4, 5, 3, 0.6)
    floor, *others = scene.surfaces
    materials = {n: replace(grey(v), name=n) for n, v in VALUES.items()}
    return Scene(materials, (replace(floor, material="floor"), *others)), south


@pytest.fixture(scope="module")
def sky():
    return skies(weather(normal=300.0), subdivision=1)


def of_point(scene, shade, sky, terms, seed):
    """DGP over (view, time), by a trace of its own."""
    point = trace_view_point(
        scene, [shade], EYE, skies=sky, terms=terms, seed=seed, samples=1024,
        sun_samples=256, refinement=CELLS, device="cpu",
        views=views_around(4, position=EYE),
    )  # fmt: skip
    return point.glare(quantities=["dgp"], errors=False)["dgp"].values


@pytest.mark.slow
@pytest.mark.parametrize(
    ("terms", "layer"),
    [
        pytest.param(THREE_PHASE, lambertian(0.3, klems("full")), id="three phases"),
        pytest.param(FIVE_PHASE, clear_air(), id="five phases"),
    ],
)
def test_changes_of_glare_are_those_of_rooms_with_other_surfaces(terms, layer, sky):
    """Mean DGP in four views, within 4 s.e. of central differences over seeds.

    The expansion of V leaves out terms of third order in the step h: h² r²/(1 − r ρ)²
    of the change in surroundings of reflectance r, below a hundredth.
    """
    step, seeds = 0.05, (31, 47, 59)
    scene, south = room()
    shade = shaded(scene, south, layer, peak=terms is FIVE_PHASE)
    found = glare_changes(
        scene, [shade], views_around(4, position=EYE), skies=sky, terms=terms,
        step=step, refinement=CELLS, samples=2048, seed=5, device="cpu",
    ).sel(glare_figure="mean DGP")  # fmt: skip
    assert (found["glare_sensitivity_error"] > 0).all()
    for name, value in VALUES.items():
        ends = [cl.with_parameters(scene, {name: value + s}) for s in (-step, step)]
        low, high = (
            np.array([of_point(end, shade, sky, terms, seed) for seed in seeds])
            for end in ends
        )
        each = (high - low).mean(axis=2)
        expected, error = each.mean(axis=0), each.std(axis=0, ddof=1) / np.sqrt(3)
        one = found.sel(parameter=name)
        change = one["glare_sensitivity"].sel(change="more").values
        change = change - one["glare_sensitivity"].sel(change="less").values
        both = np.hypot(one["glare_sensitivity_error"].sum("change").values, error)
        assert (np.abs(change - expected) < 4 * both + 0.01 * np.abs(expected)).all()
        # Errors of a fifth of the change at most, in the view of the largest change
        largest = np.argmax(np.abs(expected))
        assert both[largest] < 0.2 * np.abs(expected[largest])


def test_a_view_away_from_the_window_gets_brighter_in_a_lighter_room(sky):
    scene, south = room()
    shade = shaded(scene, south, lambertian(0.3, klems("full")), samples=256)
    found = glare_changes(
        scene, [shade], views_around(1, position=EYE), skies=sky, terms=THREE_PHASE,
        refinement=Refinement(tolerance=0.05, most=1024), samples=256, device="cpu",
    )  # fmt: skip
    mean = found.sel(glare_figure="mean DGP")
    change, error = mean["glare_sensitivity"], mean["glare_sensitivity_error"]
    # Away from the window, DGP is 0.16 and 5.87e-5 of the vertical illuminance
    assert (change.sel(change="more") > 3 * error.sel(change="more")).all()
    assert (change.sel(change="less") < -3 * error.sel(change="less")).all()
    assert (mean["glare_sensitivity_step"].values == [[-0.05, 0.05]] * 2).all()


def test_a_material_that_the_room_does_not_have_is_named(sky):
    scene, south = room()
    shade = shaded(scene, south, lambertian(0.3, klems("full")), samples=64)
    with pytest.raises(InputError, match="door"):
        glare_changes(
            scene, [shade], views_around(1, position=EYE), skies=sky,
            terms=THREE_PHASE, materials=["door"],
        )  # fmt: skip
