"""Pictures of the views of a model under one sky."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from clerestory.escaping import file_stems
from clerestory.files import make_folder, write_text
from clerestory.image.picture_files import write_picture
from clerestory.phases.rendering import render, render_irradiance
from clerestory.radiance.generated_sky import sky_scene
from clerestory.recipes.inputs import traced_effort
from clerestory.recipes.model import RecipeModel
from clerestory.recipes.sky_text import sky_command
from clerestory.study.job import Display
from clerestory.study.model_import import window_panes


def point_in_time_view(
    chosen: RecipeModel, values: Mapping[str, Any], folder: Path, display: Display
) -> None:
    """Write a picture of each view, of radiance or of the irradiance of surfaces.

    The samples are paths per pixel. Luminance and illuminance are 179 lm/W
    times the values of the pixels.
    """
    sky = sky_scene(sky_command(values["sky"]))
    scene = chosen.model.scene + window_panes(chosen.model) + sky
    effort = traced_effort(values["radiance-parameters"], per_ray=1)
    seen = values["metric"] in ("luminance", "radiance")
    trace = render if seen else render_irradiance
    stems = file_stems(chosen.model.views)
    results = make_folder(folder / "results")
    for name, view in chosen.model.views.items():
        columns, rows = view.size_for(values["resolution"])
        made = trace(
            scene,
            view,
            columns=columns,
            rows=rows,
            samples=effort["samples"],
            bounces=effort["bounces"],
            seed=1,
            progress=display(name),
        )
        write_picture(made.picture, results / f"{stems[name]}.HDR")
    info = [{"name": name, "identifier": stems[name]} for name in chosen.model.views]
    write_text(results / "views_info.json", json.dumps(info, indent=2))
