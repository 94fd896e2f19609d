"""Interfaces of the recipes by name: inputs, paths of the outputs, and functions."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, final

from clerestory.recipes import (
    breeam_credits,
    en17037_levels,
    grid_glare,
    leed_credits,
    outputs,
    view_outputs,
)
from clerestory.recipes.inputs import Input
from clerestory.recipes.model import RecipeModel
from clerestory.study.job import Display

_ANNUAL = "-ab 2 -ad 5000 -lw 2e-05 -dr 0"
_GATHERED = "-ab 2 -aa 0.1 -ad 2048 -ar 64"
_METRICS = ("illuminance", "irradiance")
_SEEN = ("luminance", "radiance")
_TURN, _COMPASS = (-360.0, 360.0), (0.0, 360.0)

_CPUS = Input("cpu-count", "whole number", 50, limits=(1, 1e9))

Run = Callable[[RecipeModel, Mapping[str, Any], Path, Display], None]


@final
@dataclass(frozen=True)
class Recipe:
    """A recipe: inputs, paths of the outputs by name, and function.

    `window_groups`: whether all windows are separate light paths, by room. `shown` are
    the outputs with a value for each sensor that the scene for viewers shows, by label.
    """

    inputs: tuple[Input, ...]
    outputs: Mapping[str, str]
    run: Run
    window_groups: bool = False
    shown: Mapping[str, str] = field(default_factory=dict)


def _model(sensors: int = 500) -> tuple[Input, ...]:
    # Inputs of every recipe; the two counts have no effect
    return (
        Input("model", "file", required=True),
        Input("grid-filter", "text", "*"),
        _CPUS,
        Input("min-sensor-count", "whole number", sensors, limits=(1, 1e9)),
    )


def _radiance(default: str) -> Input:
    return Input("radiance-parameters", "text", default)


_WEATHER = Input("wea", "file", required=True)
_NORTH = Input("north", "number", 0.0, limits=_TURN)


def _weather(north: tuple[float, float] = _TURN) -> tuple[Input, ...]:
    return (
        _WEATHER,
        Input("north", "number", 0.0, limits=north),
        Input("timestep", "whole number", 1, limits=(1, 60)),
    )


_DAYLIGHT_OUTPUTS = {
    "results": "results",
    "metrics": "metrics",
    "da": "metrics/da",
    "cda": "metrics/cda",
    "udi": "metrics/udi",
    "udi-lower": "metrics/udi_lower",
    "udi-upper": "metrics/udi_upper",
    "grid-summary": "grid_summary.csv",
}
_DAYLIGHT_SHOWN = {
    "Daylight autonomy [%]": "metrics/da",
    "Continuous daylight autonomy [%]": "metrics/cda",
    "Useful illuminance [%]": "metrics/udi",
    "Useful illuminance: below [%]": "metrics/udi_lower",
    "Useful illuminance: above [%]": "metrics/udi_upper",
}
_THRESHOLDS = Input("thresholds", "text", "-t 300 -lt 100 -ut 3000")

_DAYLIGHT = Recipe(
    (
        *_model(),
        *_weather(),
        _radiance(_ANNUAL),
        Input("schedule", "file"),
        Input("grid-metrics", "file"),
        _THRESHOLDS,
    ),
    _DAYLIGHT_OUTPUTS,
    outputs.annual_daylight,
    shown=_DAYLIGHT_SHOWN,
)

_GLARE = Recipe(
    (
        *_model(),
        _WEATHER,
        Input("north", "number", 0.0, limits=_COMPASS),
        _radiance("-ab 2 -ad 5000 -lw 2e-05"),
        Input("schedule", "file"),
        Input("glare-threshold", "number", 0.4, limits=(0, 1)),
        Input("luminance-factor", "number", 2000.0, limits=(2000, 2000)),
    ),
    {"results": "results", "ga": "metrics/ga"},
    grid_glare.annual_glare,
    shown={"Glare autonomy [%]": "metrics/ga"},
)

RECIPES: Mapping[str, Recipe] = {
    "annual-daylight": _DAYLIGHT,
    "annual-daylight-enhanced": _DAYLIGHT,
    "annual-glare": _GLARE,
    "imageless-annual-glare": _GLARE,
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
        shown={
            "Mean irradiance [W/m²]": "metrics/average_irradiance",
            "Peak irradiance [W/m²]": "metrics/peak_irradiance",
            "Radiation [kWh/m²]": "metrics/cumulative_radiation",
        },
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
        shown={
            "Radiation [kWh/m²]": "results/cumulative_radiation",
            "Mean irradiance [W/m²]": "results/average_irradiance",
        },
    ),
    "direct-sun-hours": Recipe(
        (*_model(), *_weather(_COMPASS)),
        {
            "direct-sun-hours": "results/direct_sun_hours",
            "cumulative-sun-hours": "results/cumulative",
        },
        outputs.direct_sun_hours,
        shown={"Direct sun [h]": "results/cumulative"},
    ),
    "daylight-factor": Recipe(
        (*_model(), _radiance(_GATHERED), Input("grid-metrics", "file")),
        {"results": "results", "grid-summary": "grid_summary.csv"},
        outputs.daylight_factor,
        shown={"Daylight factor [%]": "results"},
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
        shown={"Point in time [lux or W/m²]": "results/pit"},
    ),
    "annual-daylight-en17037": Recipe(
        (
            *_model(),
            Input("epw", "file", required=True),
            _NORTH,
            _radiance("-ab 2 -ad 5000 -lw 2e-05"),
            Input("grid-metrics", "file"),
            _THRESHOLDS,
        ),
        _DAYLIGHT_OUTPUTS
        | {
            "daylight-hours": "daylight_hours.json",
            "en17037": "en17037",
            "summary": "en17037/summary.json",
            "summary-grid": "en17037/summary_grid.json",
        },
        en17037_levels.annual_daylight_en17037,
        shown=_DAYLIGHT_SHOWN,
    ),
    "breeam-daylight-4b": Recipe(
        (*_model(), _WEATHER, _NORTH, _radiance(_ANNUAL)),
        {
            "results": "results",
            "breeam-folder": "breeam_summary",
            "summary": "breeam_summary/summary.json",
            "program-summary": "breeam_summary/program_summary.json",
        },
        breeam_credits.breeam_daylight_4b,
    ),
    "leed-daylight-option-one": Recipe(
        (
            *_model(1000),
            _WEATHER,
            _NORTH,
            _radiance(_ANNUAL),
            Input("diffuse-transmission", "number", 0.05, limits=(1e-4, 1)),
            Input("specular-transmission", "number", 1e-4, limits=(1e-4, 1)),
        ),
        {
            "results": "results",
            "leed-summary": "leed_summary",
            "credit-summary": "leed_summary/summary.json",
            "space-summary": "leed_summary/summary_grid.json",
            "daylight-autonomy": "leed_summary/results/da",
            "ase-hours-above": "leed_summary/results/ase_hours_above",
            "hourly-percentage-above": (
                "leed_summary/datacollections/ase_percentage_above"
            ),
            "dynamic-schedule": "leed_summary/states_schedule.json",
            "dynamic-schedule-err": "leed_summary/states_schedule_err.json",
        },
        leed_credits.leed_daylight_option_one,
        window_groups=True,
    ),
    "point-in-time-view": Recipe(
        (
            Input("model", "file", required=True),
            Input("view-filter", "text", "*"),
            _CPUS,
            Input("sky", "text", required=True),
            Input("metric", "text", "luminance", choices=(*_METRICS, *_SEEN)),
            Input("resolution", "whole number", 800, limits=(1, 8192)),
            Input(
                "skip-overture",
                "text",
                "overture",
                choices=("overture", "skip-overture"),
            ),
            _radiance("-ab 2 -aa 0.25 -ad 512 -ar 16"),
        ),
        {"results": "results"},
        view_outputs.point_in_time_view,
    ),
    "sky-view": Recipe(
        (
            *_model(),
            _radiance("-aa 0.1 -ad 2048 -ar 64"),
            Input("cloudy-sky", "text", "uniform", choices=("cloudy", "uniform")),
        ),
        {"results": "results/sky_view"},
        outputs.sky_view,
        shown={"Sky view [%]": "results/sky_view"},
    ),
}
