"""Checks of results.nc and run.json, which other programs may have written."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr
from pydantic import Field

from clerestory.checks import require
from clerestory.documents import Item, json_value, validated
from clerestory.errors import InputError, located
from clerestory.metrics.compliance import Requirement

# Axes of the variables of results.nc; NumPy's kinds of their values
_NUMBERS = {
    "illuminance": ("sensor", "time"),
    "standard_error": ("sensor", "time"),
    "occupied": ("time",),
    "position": ("sensor", "xyz"),
    "direction": ("sensor", "xyz"),
    "direct_sun_illuminance": ("sensor", "time"),
    "triangle": ("triangle", "corner", "xyz"),
    "triangle_colour": ("triangle", "channel"),
    "window_triangle": ("window_triangle", "corner", "xyz"),
    "window_index": ("window_triangle",),
    "window_centre": ("window", "xyz"),
    "window_normal": ("window", "xyz"),
    "window_up": ("window", "xyz"),
    "state": ("window", "time"),
    "facade_irradiance": ("window", "time"),
    "illuminance_by_state": ("sensor", "window", "state_number", "time"),
    "electric_illuminance": ("sensor", "time"),
    "sun_reaches": ("opening", "moment"),
    "room_hours_of_sun": (),
    "floor_area": ("sensor",),
    "height_above_floor": ("sensor",),
    "view_width": ("sensor",),
    "view_distance": ("sensor",),
    "view_layers": ("sensor",),
    "daylight_factor": ("sensor",),
    "daylight_factor_error": ("sensor",),
    "daylight_hours": ("time",),
    "verdict_area": ("verdict",),
    "verdict_level": ("verdict",),
    "verdict_replicates": ("verdict", "varied"),
    "quantity_value": ("quantity",),
    "quantity_replicates": ("quantity", "varied"),
    **dict.fromkeys(
        ("grid_view_dgp", "grid_view_dgp_error", "grid_view_illuminance"),
        ("grid_view", "time"),
    ),
    **dict.fromkeys(
        ("grid_view_exceeded_dgp", "grid_view_exceeded_dgp_error"), ("grid_view",)
    ),
    **dict.fromkeys(("grid_view_azimuth", "grid_view_number"), ("grid_view",)),
    **dict.fromkeys(
        ("grid_view_glare_share", "grid_view_glare_share_error"),
        ("grid_view", "dgp_limit"),
    ),
    "grid_view_position": ("grid_view", "xyz"),
    **dict.fromkeys(
        ("worst_dgp", "worst_dgp_error", "worst_view", "worst_step"),
        ("view_grid_name",),
    ),
    **dict.fromkeys(("disturbed_views", "disturbed_views_error"), ("view_grid_name",)),
    **dict.fromkeys(
        ("disturbed_positions", "disturbed_positions_error"), ("view_grid_name",)
    ),
    "grid_view_exceeded_dgp_by_state": ("shade_state", "grid_view"),
    "glare_dgp_by_state": ("view", "shade_state", "time"),
    "dgp_limit": ("dgp_limit",),
    **dict.fromkeys(
        ("sensitivity", "sensitivity_error"), ("parameter", "change", "figure", "place")
    ),
    "sensitivity_base": ("figure", "place"),
    "sensitivity_step": ("parameter", "change"),
    "sensitivity_value": ("parameter",),
    **dict.fromkeys(
        ("glare_sensitivity", "glare_sensitivity_error"),
        ("parameter", "change", "glare_figure", "view"),
    ),
    "glare_sensitivity_base": ("glare_figure", "view"),
    "glare_sensitivity_step": ("parameter", "change"),
}
_OF_VERDICTS = ("standard", "space", "criterion", "words", "levels")
_OF_QUANTITIES = ("standard", "space", "criterion", "name", "unit", "limits")
_OF_REQUIREMENTS = ("standard", "space", *Requirement._fields)
_NAMES = {
    "sensor": ("sensor",),
    "grid": ("sensor",),
    "window": ("window",),
    "state_name": ("window", "state_number"),
    "control": ("window",),
    "view": ("view",),
    "zone": ("zone",),
    "opening": ("opening",),
    "method": ("method",),
    "space": ("sensor",),
    "view_space": ("view",),
    "grid_view_space": ("grid_view",),
    "window_space": ("window",),
    "opening_space": ("opening",),
    **{f"verdict_{name}": ("verdict",) for name in _OF_VERDICTS},
    **{f"quantity_{name}": ("quantity",) for name in _OF_QUANTITIES},
    **{f"requirement_{name}": ("requirement",) for name in _OF_REQUIREMENTS},
    "grid_view": ("grid_view",),
    "view_grid": ("grid_view",),
    "view_grid_name": ("view_grid_name",),
    **dict.fromkeys(("parameter", "sensitivity_quantity"), ("parameter",)),
    "change": ("change",),
    "figure": ("figure",),
    "sensitivity_unit": ("figure",),
    "glare_figure": ("glare_figure",),
    "glare_sensitivity_unit": ("glare_figure",),
    "place": ("place",),
}
_TIMES = {"time": ("time",), "moment": ("moment",)}
_KINDS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "fiub": _NUMBERS,
    "UO": _NAMES,
    "M": _TIMES,
}
_REQUIRED = (
    *("illuminance", "standard_error", "occupied", "position", "direction"),
    *("sensor", "grid", "time"),
)
_SPATIAL = 3

# Variables that are required together
_TABLES = ("verdict_", "quantity_", "requirement_")

_TEXTS = ("title", "method", "place", "study")
_FIGURES = (
    *("target_lux", "latitude_deg", "longitude_deg", "utc_offset_hours"),
    *("step_minutes", "rotation_deg"),
)


class _TitleFacts(Item):
    # Title block of the report, with the logo in base64
    project: str = ""
    client: str = ""
    author: str = ""
    notes: str = ""
    logo: str = Field("", pattern=r"^(?:[A-Za-z0-9+/]{4})*(?:[A-Za-z0-9+/=]{4})?$")


class _RunFacts(Item):
    # What reports use of run.json
    report: _TitleFacts = _TitleFacts()
    seconds: dict[str, float] = Field({})
    warnings: list[str] = Field([])
    matrices: dict[str, dict[str, Any]] = Field({})
    files: dict[str, str] = Field({})


class _StudyFacts(Item):
    # What reports use of the study in results.nc
    sky: dict[str, Any] = Field({})
    schedule: dict[str, Any] = Field({})
    weather: dict[str, Any] = Field({})


def check_results(data: xr.Dataset, file: Path) -> None:
    """Require the variables and attributes of results.nc, with their axes and kinds."""
    with located(file=file):
        missing = [name for name in _REQUIRED if name not in data.variables]
        require(not missing, f"{', '.join(missing)} missing; results of a run expected")
        if any(str(name).startswith(_TABLES) for name in data.variables):
            of_tables = {n for n in (*_NUMBERS, *_NAMES) if n.startswith(_TABLES)}
            missing = sorted(of_tables - set(map(str, data.variables)))
            require(not missing, f"{', '.join(missing)} missing; verdicts expected")
        for kinds, axes in _KINDS.items():
            for name in axes.keys() & set(data.variables):
                _check_variable(data[name], axes[name], kinds)
        spatial = data.sizes.get("xyz", _SPATIAL)
        require(spatial == _SPATIAL, f"axis xyz has length {spatial}; 3 expected")
        for name in ("sensor", "time"):
            require(data.sizes[name], f"axis {name} is empty; one or more expected")
        require("title" in data.attrs, "attribute title missing; a text expected")
        for name in _TEXTS:
            value = data.attrs.get(name, "")
            require(
                isinstance(value, str), f"attribute {name} is {value!r}; text expected"
            )
        for name in _FIGURES:
            _check_number(data.attrs.get(name, 0.0), name)
    study = json_value(data.attrs.get("study", "{}"), file=file)
    validated(study, _StudyFacts, file=file)


def check_run(value: object, file: Path) -> None:
    """Require a JSON object, with times, warnings and matrices as in run.json."""
    expected = "is no run.json; a JSON object expected"
    require(isinstance(value, dict), expected, file=file)
    validated(value, _RunFacts, file=file)


def _check_variable(data: xr.DataArray, axes: tuple[str, ...], kinds: str) -> None:
    shown = ", ".join(axes) or "none"
    message = (
        f"variable {data.name} has axes {', '.join(map(str, data.dims)) or 'none'}"
    )
    require(data.dims == axes, f"{message}; {shown} expected")
    what = {"fiub": "numbers", "UO": "texts", "M": "times"}[kinds]
    found = f"variable {data.name} has values of type {data.dtype}"
    require(data.dtype.kind in kinds, f"{found}; {what} expected")


def _check_number(value: object, name: str) -> None:
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InputError(f"attribute {name} is {value!r}; a number expected") from None
