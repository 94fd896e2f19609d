"""Daylight factor and sky view: irradiance of the grids under one sky."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.metrics.daylight_factor import daylight_factor
from clerestory.phases.rendering import irradiance
from clerestory.radiance.generated_sky import sky_scene
from clerestory.recipes.inputs import traced_effort
from clerestory.recipes.model import RecipeModel
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


def _relative(
    chosen: RecipeModel, sky: str, effort: Mapping[str, int], display: Display
) -> Values:
    # Illuminance of each sensor over that of a horizontal plane outdoors [%]
    scene = chosen.model.scene + window_panes(chosen.model) + sky_scene(sky)
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
        outdoors = gathered.bands.photometric(
            np.full(gathered.irradiance.shape[1], _IRRADIANCE)
        )
        factor = daylight_factor(gathered.illuminance(), outdoor_lux=float(outdoors))
        found[record.full_id] = 100 * factor
    return found
