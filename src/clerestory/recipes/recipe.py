"""Recipes by name: their inputs, their outputs and the function that runs them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from clerestory.checks import one_of
from clerestory.progress import silent
from clerestory.recipes import outputs
from clerestory.recipes.inputs import Input, read_inputs, traced_effort
from clerestory.recipes.model import RecipeModel, read_model
from clerestory.study.job import Display

_ANNUAL = "-ab 2 -ad 5000 -lw 2e-05 -dr 0"
_GATHERED = "-ab 2 -aa 0.1 -ad 2048 -ar 64"
_METRICS = ("illuminance", "irradiance")
_TURN, _COMPASS = (-360.0, 360.0), (0.0, 360.0)

Run = Callable[[RecipeModel, Mapping[str, Any], Path, Display], None]


@final
@dataclass(frozen=True)
class Recipe:
    """A recipe: inputs, paths of the outputs by name, and function."""

    inputs: tuple[Input, ...]
    outputs: Mapping[str, str]
    run: Run


def _model(sensors: int = 500) -> tuple[Input, ...]:
    # Inputs of every recipe; the two counts have no effect
    return (
        Input("model", "file", required=True),
        Input("grid-filter", "text", "*"),
        Input("cpu-count", "whole number", 50, limits=(1, 1e9)),
        Input("min-sensor-count", "whole number", sensors, limits=(1, 1e9)),
    )


def _radiance(default: str) -> Input:
    return Input("radiance-parameters", "text", default)


def _weather(north: tuple[float, float] = _TURN) -> tuple[Input, ...]:
    return (
        Input("wea", "file", required=True),
        Input("north", "number", 0.0, limits=north),
        Input("timestep", "whole number", 1, limits=(1, 60)),
    )


_DAYLIGHT = Recipe(
    (
        *_model(),
        *_weather(),
        _radiance(_ANNUAL),
        Input("schedule", "file"),
        Input("grid-metrics", "file"),
        Input("thresholds", "text", "-t 300 -lt 100 -ut 3000"),
    ),
    {
        "results": "results",
        "metrics": "metrics",
        "da": "metrics/da",
        "cda": "metrics/cda",
        "udi": "metrics/udi",
        "udi-lower": "metrics/udi_lower",
        "udi-upper": "metrics/udi_upper",
        "grid-summary": "grid_summary.csv",
    },
    outputs.annual_daylight,
)

RECIPES: Mapping[str, Recipe] = {
    "annual-daylight": _DAYLIGHT,
    "annual-daylight-enhanced": _DAYLIGHT,
    "annual-irradiance": Recipe(
        (
            *_model(),
            *_weather(),
            _radiance(_ANNUAL),
            Input("output-type", "text", "solar", choices=("visible", "solar")),
        ),
        {
            "results": "results/total",
            "results-direct": "results/direct",
            "average-irradiance": "metrics/average_irradiance",
            "peak-irradiance": "metrics/peak_irradiance",
            "cumulative-radiation": "metrics/cumulative_radiation",
        },
        outputs.annual_irradiance,
    ),
    "cumulative-radiation": Recipe(
        (
            *_model(),
            *_weather(),
            _radiance("-ab 2 -ad 5000 -lw 2e-05"),
            Input("sky-density", "whole number", 1, limits=(1, 6)),
        ),
        {
            "average-irradiance": "results/average_irradiance",
            "cumulative-radiation": "results/cumulative_radiation",
        },
        outputs.cumulative_radiation,
    ),
    "direct-sun-hours": Recipe(
        (*_model(), *_weather(_COMPASS)),
        {
            "direct-sun-hours": "results/direct_sun_hours",
            "cumulative-sun-hours": "results/cumulative",
        },
        outputs.direct_sun_hours,
    ),
    "daylight-factor": Recipe(
        (*_model(), _radiance(_GATHERED), Input("grid-metrics", "file")),
        {"results": "results", "grid-summary": "grid_summary.csv"},
        outputs.daylight_factor,
    ),
    "point-in-time-grid": Recipe(
        (
            *_model(),
            Input("sky", "text", required=True),
            Input("metric", "text", "illuminance", choices=_METRICS),
            _radiance(_GATHERED),
        ),
        {"results": "results/pit"},
        outputs.point_in_time_grid,
    ),
    "sky-view": Recipe(
        (
            *_model(),
            _radiance("-aa 0.1 -ad 2048 -ar 64"),
            Input("cloudy-sky", "text", "uniform", choices=("cloudy", "uniform")),
        ),
        {"results": "results/sky_view"},
        outputs.sky_view,
    ),
}


def run_recipe(
    name: str,
    inputs: str | Path,
    *,
    folder: str | Path,
    display: Display | None = None,
) -> dict[str, Path]:
    """Run a recipe, and return the paths of its outputs by name.

    Parameters
    ----------
    name : name of the recipe, such as "annual-daylight"
    inputs : JSON file with the inputs of the recipe
    folder : project folder; the results are in a folder with the name of the recipe,
        words separated by underscores
    display : function that starts the progress display of a phase, given its name

    Raises
    ------
    InputError : the recipe or an input is unknown, or an input is invalid
    """
    one_of(name, "recipe", choices=RECIPES)
    recipe = RECIPES[name]
    values = read_inputs(inputs, recipe.inputs)
    if "radiance-parameters" in values:
        traced_effort(values["radiance-parameters"])
    chosen = read_model(values["model"], grid_filter=values["grid-filter"])
    place = Path(folder) / name.replace("-", "_")
    recipe.run(chosen, values, place, display or silent)
    return {key: place / path for key, path in recipe.outputs.items()}
