"""Misspelt names of channels, sides and other choices are refused, one line each.

The table is complete: a public function with a new `Literal` argument must be added.
"""

import dataclasses
import inspect
import typing
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.errors import InputError
from clerestory.glazing.layer import Diffuser
from clerestory.glazing.pane import grey_pane
from clerestory.hemisphere.klems import klems
from clerestory.image.colour_scale import linear_scale

WRONG = "transmision_front"
DOWN = np.array([[0.0, 0.0, -1.0]])
UP = -DOWN
DIFFUSER = Diffuser(grey_pane(0.5, 0.2))


def layer():
    return lambertian(0.5, klems("quarter"))


def stacked():
    return clerestory.stack_layers([DIFFUSER], partition=klems("quarter"))


def sky(**changes):
    room = Path(__file__).parents[1] / "cli/room"
    day = clerestory.read_weather(room / "two_days.wea")
    return clerestory.sky_matrix(day, subdivision=1, **changes)


def picture(**changes):
    return clerestory.Picture(np.ones((40, 40, 3), np.float32), **changes)


def glare(**changes):
    view = clerestory.View(kind="angular", horizontal=180, vertical=180)
    return clerestory.evaluate_glare(picture(view=view), **changes)


# By "function argument": a call with a wrong name
CHANNELS = {
    "Bsdf.evaluate": lambda: layer().evaluate(DOWN, UP, channel="visibel"),
    "Bsdf.resolution": lambda: layer().resolution(DOWN, UP, channel="visibel"),
    "Bsdf.scattering": lambda: layer().scattering("reflection_back", channel="v"),
    "Bsdf.transmission_matrix": lambda: layer().transmission_matrix("v"),
    "StackedLayers channel": lambda: stacked().diffuse_absorptance(channel="v"),
    "StackedLayers side": lambda: stacked().diffuse_absorptance(side="room"),
}
CHOICES = {
    "DaylightSpectra sky": lambda: clerestory.DaylightSpectra(sky=WRONG),
    "DaylightSpectra sun": lambda: clerestory.DaylightSpectra(sun=WRONG),
    "Axis kind": lambda: clerestory.Axis("sensors", 3),
    "Bsdf functions": lambda: Bsdf(
        {("visible", WRONG): layer().function("transmission_front")}
    ),
    "Bsdf.diffuse function": lambda: layer().diffuse(WRONG),
    "Bsdf.direct_hemispherical function": lambda: layer().direct_hemispherical(WRONG),
    "Bsdf.function name": lambda: layer().function(WRONG),
    "Bsdf.has function": lambda: layer().has(WRONG),
    "Bsdf.hemispherical function": lambda: layer().hemispherical(DOWN, function=WRONG),
    "Bsdf.in_colour name": lambda: layer().in_colour(WRONG),
    "Bsdf.sample function": lambda: layer().sample(
        DOWN, np.full((1, 2), 0.5), function=WRONG
    ),
    "Bsdf.scattering name": lambda: layer().scattering(WRONG),
    "Bsdf.xyz name": lambda: layer().xyz(WRONG),
    "Picture quantity": lambda: picture(quantity="luminance"),
    "View kind": lambda: clerestory.View(kind="fisheye"),
    "evaluate_glare background": lambda: glare(background="mean"),
    "evaluate_glare position_model": lambda: glare(position_model="gut"),
    "false_colour style": lambda: clerestory.false_colour(
        picture(), linear_scale(picture()), style="line"
    ),
    "read_measurement function": lambda: clerestory.read_measurement(
        "a.txt", function=WRONG
    ),
    "read_measurement facing": lambda: clerestory.read_measurement(
        "a.txt", facing="in"
    ),
    "sky_matrix include": lambda: sky(include="suns"),
    "sky_matrix sun": lambda: sky(sun="point"),
    "sky_matrix sun_formula": lambda: sky(sun_formula="gendaymtx"),
    "sky_matrix quadrature": lambda: sky(quadrature="centre"),
    "sky_matrix spectrum": lambda: sky(spectrum="uv"),
    "stack_layers method": lambda: clerestory.stack_layers([DIFFUSER], method="band"),
    "walk_layers channels": lambda: clerestory.walk_layers(
        [DIFFUSER], channels=("uv",)
    ),
}
# Checked where they are used: on the compute device, and by slow or optional engines
ELSEWHERE = {
    "Cluster.resolve device",
    "Cluster.unit_size device",
    "Effort device",
    "cross_validate symmetry",
    "daylight_coefficients derivatives",
    "daylight_matrices derivatives",
    "daylight_matrix derivatives",
    "facade_matrices derivatives",
    "fit_measurement symmetry",
    "generate_bsdf basis",
    "generate_bsdf sides",
    "glare_changes materials",
    "illuminance_derivatives second",
    "material_parameters names",
    "thermal_figures basis",
    "thermal_figures wavelengths",
    "view_matrices derivatives",
    "view_matrix derivatives",
    "write_matrix encoding",
}


@pytest.mark.parametrize("call", [*CHANNELS.values(), *CHOICES.values()])
def test_a_wrong_name_is_refused_with_the_names_that_exist(call):
    with pytest.raises(InputError, match=r"expected|it has visible transmission"):
        call()


def test_a_function_that_a_channel_lacks_is_still_zero():
    part = layer().function("transmission_front")
    curtain = Bsdf({("visible", "transmission_front"): part})
    assert curtain.evaluate(DOWN, DOWN) == 0
    with pytest.raises(InputError, match="channel of BSDF '' is 'solar'; one of visib"):
        curtain.evaluate(DOWN, DOWN, channel="solar")


def choices(annotation):
    if typing.get_origin(annotation) is typing.Literal:
        return True
    return any(choices(part) for part in typing.get_args(annotation))


def arguments(name, function):
    hints = typing.get_type_hints(function)
    hints.pop("return", None)
    return {f"{name} {key}" for key, hint in hints.items() if choices(hint)}


def test_every_choice_of_the_public_interface_is_tested():
    found = set()
    for name in clerestory.__all__:
        item = getattr(clerestory, name)
        functions = {name: item}
        if inspect.isclass(item):
            methods = inspect.getmembers(item, inspect.isfunction)
            functions = {f"{name}.{key}": f for key, f in methods if key[0] != "_"}
            if dataclasses.is_dataclass(item):
                functions[name] = item.__init__
        for label, function in functions.items():
            if inspect.isfunction(function):
                try:
                    found |= arguments(label, function)
                except NameError:  # xarray is imported for the type checker only
                    assert "xr." in str(inspect.signature(function))
    assert found == set(CHOICES) | ELSEWHERE
