"""Quantities of the criteria of EN 17037 of a space."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
import xarray as xr

from clerestory.metrics import view_out
from clerestory.metrics.compliance import (
    Quantity,
    Requirement,
    levels_reached,
    share,
)
from clerestory.metrics.en17037 import (
    GLARE_LIMITS,
    GLARE_SHARE,
    LEVELS,
    MINIMUM_AREA,
    MINIMUM_LUX,
    SUN_HOURS,
    TARGET_AREA,
    TARGET_LUX,
    daylight_provision,
)
from clerestory.metrics.procedure import requirement
from clerestory.metrics.replicates import errors_of, replicates
from clerestory.metrics.space import Space
from clerestory.metrics.spatial_metrics import RoomShare, area_share

# Windows are horizontal openings below this tilt, as cosine
_HORIZONTAL = np.cos(np.radians(15.0))

_TARGET = "50 % for level {}"
_MINIMUM = "95 % for level {}"
_FACTOR = "daylight_factor"

# DGP that each view of the view grids exceeds in 5 % of the occupied hours
_GRID_DGP = "grid_view_exceeded_dgp"


def provision(space: Space) -> Sequence[Quantity]:
    """Return the areas that reach each illuminance in half of the daylight hours."""
    lux = "{:.0f} lux in half of the daylight hours"
    targets, minima = ([lux.format(x) for x in t] for t in (TARGET_LUX, MINIMUM_LUX))
    if "daylight_hours" not in space.data or not space.data["daylight_hours"].any():
        return _areas(targets, [None] * 3, minima, [None] * 3, roof=False)
    hours = space.data["daylight_hours"].values.astype(bool)
    found = daylight_provision(
        space.data["illuminance"],
        hours,
        area=space.area,
        **errors_of(space.data),
    )
    return _areas(targets, found.target, minima, found.minimum, roof=roof_lit(space))


def provision_by_factor(space: Space) -> Sequence[Quantity]:
    """Return the areas that reach the daylight factor of each level.

    The limits follow from the median diffuse illuminance in the daylight hours.
    """
    median = float(space.data.attrs.get("median_diffuse_lux", np.nan))
    text = "daylight factor {:.1f} %"
    targets, minima = (
        [text.format(100 * x / median) for x in t] for t in (TARGET_LUX, MINIMUM_LUX)
    )
    if _FACTOR not in space.data or not median > 0:
        unknown = [f"daylight factor of level {level}" for level in LEVELS[1:]]
        return _areas(unknown, [None] * 3, unknown, [None] * 3, roof=False)
    found = daylight_provision(
        median * space.data[_FACTOR].expand_dims("time", axis=1),
        np.ones(1, dtype=bool),
        area=space.area,
        standard_error=median
        * space.data["daylight_factor_error"].expand_dims("time", 1),
        components=factor_components(space.data),
    )
    return _areas(targets, found.target, minima, found.minimum, roof=roof_lit(space))


def provision_level(values: Sequence[float], space: Space) -> int:
    """Level 0…3 of areas [%] that reach the target and the minimum of each level."""
    wanted = 100 * (MINIMUM_AREA if roof_lit(space) else TARGET_AREA)
    return min(
        levels_reached(values[:3], [wanted] * 3),
        levels_reached(values[3:], [100 * MINIMUM_AREA] * 3),
    )


def factor_components(data: xr.Dataset) -> xr.DataArray | None:
    """Error components of the daylight factor, over (sensor, component, time)."""
    name = "daylight_factor_components"
    return data[name].expand_dims("time", axis=2) if name in data else None


def view(space: Space) -> Sequence[Quantity]:
    """Return the areas with a view of each level, and medians of width and distance."""
    names = [f"view of level {level}" for level in LEVELS[1:]]
    limits = "75 % of the area"
    if "view_width" not in space.data:
        return tuple(share(name, None, limits) for name in names)
    found = view_of(space.data)
    levels = found.levels()
    areas = [
        share(name, RoomShare(area_share(levels >= k, space.area)), limits)
        for k, name in enumerate(names, start=1)
    ]
    far = float(np.median(found.distance))
    landscape = area_share(found.layers & view_out.LANDSCAPE > 0, space.area)
    return (
        *areas,
        Quantity(
            "width, median", float(np.median(found.width_deg)), "°", "14, 28, 54°"
        ),
        Quantity("distance, median", min(far, 1e6), "m", "6, 20, 50 m"),
        Quantity("landscape is seen", 100 * landscape, "%", "75 % of the area"),
    )


def view_of(data: xr.Dataset) -> view_out.ViewOut:
    """Return the view out of each sensor from the results of a run."""
    return view_out.ViewOut(
        data["view_width"].values.astype(float),
        data["view_distance"].values.astype(float),
        data["view_layers"].values.astype(int),
    )


def sunlight(space: Space) -> Sequence[Quantity]:
    """Return the hours in which the sun reaches any opening of the space."""
    limits = ", ".join(f"{hours:g}" for hours in SUN_HOURS) + " h"
    value = np.nan
    if "sun_reaches" in space.data and space.data.sizes["opening"]:
        reached = space.data["sun_reaches"].transpose("opening", "moment").values
        value = float(reached.astype(bool).any(axis=0).mean() * 24)
    return (Quantity("hours of sun on the day", value, "h", limits),)


def glare(space: Space) -> Sequence[Quantity]:
    """Return the DGP that is exceeded in 5 % of the occupied hours in the worst view.

    Views are those of the study and of its view grids. The errors of all hours of a
    view are assumed to be fully correlated.
    """
    limits = ", ".join(f"{limit:.2f}" for limit in GLARE_LIMITS)
    name = f"DGP exceeded in {100 * GLARE_SHARE:.0f} % of the hours, worst view"
    worst = [max(values) for values in zip(*_exceeded_dgp(space.data), strict=False)]
    if not worst:
        return (Quantity(name, np.nan, "", limits),)
    return (Quantity(name, worst[0], "", limits, tuple(worst[1:])),)


def _exceeded_dgp(data: xr.Dataset) -> Iterator[list[float]]:
    # DGP of the worst view, and of the worst view of the view grids, each with its
    # replicates
    used = data["occupied"].values.astype(bool)
    if "glare_dgp" in data and data.sizes["view"] and used.any():
        hours = data["glare_dgp"].transpose("view", "time").fillna(0.0)[:, used]
        error = None
        if "glare_dgp_error" in data:
            error = data["glare_dgp_error"].transpose("view", "time").fillna(0.0)
            error = error[:, used]
        each = (hours, *replicates(hours, error))
        yield [_exceeded(dgp) for dgp in each]
    if _GRID_DGP in data and data.sizes["grid_view"]:
        annual, error = data[_GRID_DGP], data.get(f"{_GRID_DGP}_error")
        if not np.isnan(annual.values).all():
            yield [float(dgp.max()) for dgp in (annual, *replicates(annual, error))]


def _exceeded(dgp: xr.DataArray) -> float:
    # Smallest limit that each view exceeds in at most 5 % of the time steps
    ranked = np.sort(dgp.values, axis=1)[:, ::-1]
    return float(ranked[:, int(GLARE_SHARE * ranked.shape[1])].max())


def roof_lit(space: Space) -> bool:
    """Whether all windows of a space are horizontal."""
    if "window_normal" not in space.data or not space.data.sizes["window"]:
        return False
    return bool((abs(space.data["window_normal"].values[:, 2]) > _HORIZONTAL).all())


def inputs_of_criteria(space: Space) -> Iterator[Requirement]:
    """Check that the results contain what each criterion is evaluated from."""
    data = space.data
    views = data.sizes.get("view", 0) if "glare_dgp" in data else 0
    views += data.sizes.get("grid_view", 0) if _GRID_DGP in data else 0
    named = partial(requirement, expected="at least one")
    yield named(
        "Views for glare",
        views > 0,
        f"{views or 'no'} views",
        change="add a [[view]] of 180° at the place where glare is worst, or a"
        " [[view_grid]]",
    )
    openings = data.sizes.get("opening", 0)
    yield named(
        "Openings for sunlight",
        openings > 0,
        f"{openings or 'no'} openings",
        change="add a [[window]], or file = of openings to a table [sunlight]",
    )
    yield named(
        "Openings for the view out",
        "view_width" in data,
        "openings" if "view_width" in data else "no openings",
        change="add a [[window]], or file = of openings to a table [sunlight]",
    )


def _areas(
    targets: Sequence[str],
    of_targets: Sequence[RoomShare | None],
    minima: Sequence[str],
    of_minima: Sequence[RoomShare | None],
    *,
    roof: bool,
) -> tuple[Quantity, ...]:
    # Areas with the target, then areas with the minimum illuminance of each level.
    # Under horizontal openings both are required on 95 % of the area
    first = [
        share(name, found, (_MINIMUM if roof else _TARGET).format(level))
        for name, found, level in zip(targets, of_targets, LEVELS[1:], strict=True)
    ]
    last = [
        share(name, found, _MINIMUM.format(level))
        for name, found, level in zip(minima, of_minima, LEVELS[1:], strict=True)
    ]
    return (*first, *last)
