"""Daylight factor, sky view and illuminance of the grids under one sky."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.metrics.daylight_factor import daylight_factor
from clerestory.phases.rendering import irradiance
from clerestory.radiance.generated_sky import sky_scene
from clerestory.recipes.inputs import traced_effort
from clerestory.recipes.model import RecipeModel
from clerestory.recipes.sky_text import sky_command
from clerestory.scene.model import Scene
from clerestory.study.job import Display
from clerestory.study.model_import import window_panes

# Horizontal irradiance of the skies [W/m²], and reflectance of the ground outdoors
_IRRADIANCE, _GROUND = 100.0, 0.2

Values = dict[str, Float[np.ndarray, " sensor"]]


def daylight_factors(
    chosen: RecipeModel, values: Mapping[str, Any], *, display: Display
) -> Values:
    """Return the daylight factor of each sensor under the CIE overcast sky [%]."""
    sky = f"gensky -ang 45 0 -c -B {_IRRADIANCE:g} -g {_GROUND:g}"
    effort = traced_effort(values["radiance-parameters"])
    return _relative(chosen, sky, effort, display)


def sky_views(
    chosen: RecipeModel, values: Mapping[str, Any], *, display: Display
) -> Values:
    """Return the share of the sky that each sensor receives light from [%].

    Directions are weighted by the cosine to the sensor and, for a cloudy sky, by the
    luminance of the CIE overcast sky. Light is transmitted by glass, but not reflected;
    100 % is the light on a horizontal plane outdoors.
    """
    kind = "-c" if values["cloudy-sky"] == "cloudy" else "-u"
    sky = f"gensky -ang 45 0 {kind} -B {_IRRADIANCE:g} -g 0"
    effort = traced_effort(values["radiance-parameters"]) | {"bounces": 1}
    return _relative(chosen, sky, effort, display)


def point_in_time(
    chosen: RecipeModel, values: Mapping[str, Any], *, display: Display
) -> Values:
    """Return the illuminance [lux] or irradiance [W/m²] of each sensor under a sky.

    Irradiance is that of visible light, illuminance over 179 lm/W.
    """
    effort = traced_effort(values["radiance-parameters"])
    sky = sky_scene(sky_command(values["sky"]))
    lux = _illuminance(chosen, sky, effort, display)
    scale = 1.0 if values["metric"] == "illuminance" else 1 / LUMINOUS_EFFICACY
    return {name: scale * found for name, found in lux.items()}


def _relative(
    chosen: RecipeModel, sky: str, effort: Mapping[str, int], display: Display
) -> Values:
    # Illuminance of each sensor over that of a horizontal plane outdoors [%]
    outdoors = LUMINOUS_EFFICACY * _IRRADIANCE
    lux = _illuminance(chosen, sky_scene(sky), effort, display)
    return {
        name: 100 * daylight_factor(found, outdoor_lux=outdoors)
        for name, found in lux.items()
    }


def _illuminance(
    chosen: RecipeModel, sky: Scene, effort: Mapping[str, int], display: Display
) -> Values:
    scene = chosen.model.scene + window_panes(chosen.model) + sky
    found: Values = {}
    for name, record in chosen.records.items():
        gathered = irradiance(
            scene,
            chosen.model.grids[name],
            samples=effort["samples"],
            bounces=effort["bounces"],
            seed=1,
            progress=display(record.name),
        )
        found[record.full_id] = gathered.illuminance()
    return found
