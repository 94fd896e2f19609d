"""Diffusing blinds behind the windows of a model, as a second state of each window.

The blinds of IES LM-83: sheets that transmit a small part of the light diffusely, and a
smaller part straight on.
"""

from dataclasses import replace

import numpy as np

from clerestory.escaping import file_stem
from clerestory.formats.building_model import ApertureGroup
from clerestory.metrics.honeybee_writer import Arrays
from clerestory.recipes.annual import AnnualLight
from clerestory.recipes.model import RecipeModel
from clerestory.scene.model import Trans
from clerestory.study.model_import import window_bsdf

# Diffuse reflectance of the blinds on the side of the room
_REFLECTANCE = 0.5

_CLOSED = "blinds"


def with_blinds(chosen: RecipeModel, *, diffuse: float, specular: float) -> RecipeModel:
    """Return a model with blinds behind all windows of one state.

    `diffuse` and `specular` are the transmittances of the blinds. Behind a window they
    are multiplied by the hemispherical transmittance of the window.
    """
    windows = tuple(
        _shaded(group, diffuse, specular) if len(group.states) == 1 else group
        for group in chosen.model.windows
    )
    return replace(chosen, model=replace(chosen.model, windows=windows))


def _shaded(group: ApertureGroup, diffuse: float, specular: float) -> ApertureGroup:
    pane = window_bsdf(group.states[0][1]).diffuse("transmission_front")
    passed = pane * min(diffuse + specular, 1.0)
    grey = (passed + _REFLECTANCE) / max(passed + _REFLECTANCE, 1.0)
    sheet = Trans(
        _CLOSED,
        np.full(3, grey),
        transmission=passed / (passed + _REFLECTANCE),
        transmitted_specular=specular / (diffuse + specular),
    )
    return replace(group, states=(*group.states, (_CLOSED, sheet)))


def through_blinds(
    light: AnnualLight, chosen: RecipeModel, *, specular: float
) -> AnnualLight:
    """Return light whose direct part behind closed blinds is transmitted straight on.

    Light that the blinds scatter is not direct light, see LM-83. `chosen` is the model
    before blinds were added.
    """
    added = {
        file_stem(group.name) for group in chosen.model.windows if len(group.states) < 2
    }
    paths = {}
    for path, states in light.paths.items():
        paths[path] = dict(states)
        if path in added:
            unshaded, closed = states
            direct = {
                name: specular * lux for name, lux in states[unshaded]["direct"].items()
            }
            arrays: Arrays = {"total": states[closed]["total"], "direct": direct}
            paths[path][closed] = arrays
    return replace(light, paths=paths)
