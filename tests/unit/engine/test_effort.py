"""One effort, checked: unknown keywords, limits, and which value replaces which."""

from dataclasses import fields

import numpy as np
import pytest

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.directions import Frame
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.phases.facade_matrices import facade_matrix
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.sun_coefficients import (
    picture_sun_coefficients,
    sun_coefficients,
)
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window

SENSORS = Sensors(np.zeros((1, 3)), np.array([[0, 0, 1.0]]))
VIEW = View(kind="angular", horizontal=180, vertical=180)
CAMERA = Camera(VIEW, 4, 4)
SUN = np.array([[0, 0, 1.0]])
PANE = Polygon(np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1.0]]), "", "")
FRAME = Frame.from_normal_up(-np.eye(3)[1], np.eye(3)[2])
WINDOW = Window("south", (PANE,), FRAME, klems("quarter"))
PORT = Window("port", (PANE,), FRAME, klems("quarter"))
BSDF = Bsdf({})

SUN_CALL = (Scene(), [WINDOW], "south", BSDF)
CALLS = {
    "view": lambda **k: cl.view_matrix(Scene(), WINDOW, sensors=SENSORS, **k),
    "views": lambda **k: cl.view_matrices(Scene(), [WINDOW], sensors=SENSORS, **k),
    "daylight": lambda **k: cl.daylight_matrix(Scene(), WINDOW, **k),
    "daylights": lambda **k: cl.daylight_matrices(Scene(), [WINDOW], **k),
    "coefficients": lambda **k: cl.daylight_coefficients(Scene(), sensors=SENSORS, **k),
    "facade": lambda **k: facade_matrix(Scene(), WINDOW, PORT, **k),
    "pictures": lambda **k: picture_view_matrices(Scene(), [WINDOW], CAMERA, **k),
    "sun": lambda **k: sun_coefficients(*SUN_CALL, sensors=SENSORS, suns=SUN, **k),
    "sun pictures": lambda **k: picture_sun_coefficients(
        *SUN_CALL, CAMERA, suns=SUN, **k
    ),
    "render": lambda **k: cl.render(Scene(), VIEW, columns=4, rows=4, **k),
    "irradiance picture": lambda **k: cl.render_irradiance(
        Scene(), VIEW, columns=4, rows=4, **k
    ),
    "irradiance": lambda **k: cl.irradiance(Scene(), SENSORS, **k),
    "emitters": lambda **k: cl.precompute_illums(Scene(), Scene(), **k),
    "bsdf": lambda **k: generate_bsdf(Scene(), **k),
}


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize(
    ("wrong", "closest"), [("sampels", "samples"), ("sead", "seed")]
)
def test_a_misspelt_keyword_is_refused_with_the_closest_one(call, wrong, closest):
    with pytest.raises(InputError, match=f"no keyword '{wrong}'; '{closest}' is the"):
        CALLS[call](**{wrong: 3})


def test_a_misspelt_keyword_may_be_one_of_the_function_itself():
    with pytest.raises(InputError, match=r"daylight_matrix\(\) .*'subdivision' is"):
        CALLS["daylight"](subdivison=1)


@pytest.mark.parametrize("call", ["sun", "sun pictures"])
def test_direct_sun_takes_samples_only(call):
    with pytest.raises(InputError, match="no keyword 'relative_error'"):
        CALLS[call](relative_error=0.1)
    with pytest.raises(InputError, match="bounces is set, but"):
        CALLS[call](effort=Effort(bounces=1))


def test_keywords_replace_fields_of_an_effort():
    effort = Effort(samples=64, seed=3)
    found = effort_of(CALLS["view"], {"effort": effort, "seed": 4}, default=Goal(1))
    assert (found.samples, found.seed) == (64, 4)
    assert found.executor is effort.executor


def test_an_effort_has_one_goal():
    with pytest.raises(InputError, match="both samples and relative_error"):
        Effort(samples=64, relative_error=0.1)
    with pytest.raises(InputError, match="both samples and relative_error"):
        effort_of(
            CALLS["view"],
            {"effort": Effort(samples=64), "relative_error": 0.1},
            default=Goal(1),
        )


def test_the_default_goal_applies_where_none_is_given():
    default = Goal(None, 0.02)
    assert effort_of(CALLS["view"], {}, default=default).relative_error == 0.02
    assert effort_of(CALLS["view"], {"samples": 8}, default=default).goal == Goal(8)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("samples", 0),
        ("samples", 1 << 27),
        ("relative_error", float("nan")),
        ("relative_error", 0.0),
        ("bounces", -1),
        ("seed", 1 << 32),
        ("batches", 1),
    ],
)
def test_numbers_out_of_range_are_refused(field, value):
    with pytest.raises(InputError, match=f"{field} is "):
        Effort(**{field: value})


def test_the_keywords_are_the_fields():
    names = {field.name for field in fields(Effort)}
    assert set(EffortKeywords.__annotations__) == {"effort", *names}
