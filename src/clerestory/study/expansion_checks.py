"""Checks of the expansion of illuminance: draws that are traced again.

The first draw has the largest second-order terms; the others are far from it and from
each other. Only materials are checked, as the other quantities act linearly.
"""

import warnings
from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.errors import ClerestoryWarning
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.study.job import Job
from clerestory.study.retracing import Situation, retraced, whole_illuminance
from clerestory.study.uncertain_figures import (
    FIGURES,
    FigureModel,
    grid_figures,
    light,
)
from clerestory.study.unknown_quantities import UnknownQuantities
from clerestory.uncertainty.draws import Draws

# The expansion fails if its error is above this share of the standard deviation of a
# figure, above this share of its value, above twice the error of the simulation, and
# in shares of the area above that of one sensor
_WRONG, _RELATIVE = 0.1, 0.01

# Number of draws from which those to check are chosen
_CHECKED = 512


def far_draws(
    draws: Float[np.ndarray, "draw unknown"],
    columns: Sequence[int],
    count: int,
    *,
    curvature: Float[np.ndarray, " draw"] | None = None,
) -> list[int]:
    """Return the numbers of draws to check: far from the middle and from each other.

    Among the 95 % of draws nearest to the middle, the first one has the largest
    `curvature` (by default: distance from the middle); each next one is the farthest
    from those chosen.

    >>> far_draws(np.linspace(-1, 1, 101)[:, None], [0], 2)
    [2, 98]
    """
    own = draws[:, columns]
    scaled = (own - own.mean(axis=0)) / np.maximum(own.std(axis=0), 1e-12)
    from_middle = (scaled**2).sum(axis=1)
    allowed = from_middle <= np.quantile(from_middle, 0.95)
    chosen: list[int] = []
    distance = from_middle if curvature is None else curvature
    for _ in range(min(count, int(allowed.sum()))):
        chosen.append(int(np.argmax(np.where(allowed, distance, -1.0))))
        nearest = ((scaled - scaled[chosen[-1]]) ** 2).sum(axis=1)
        distance = nearest if len(chosen) == 1 else np.minimum(distance, nearest)
    return chosen


def _curvature(
    model: FigureModel, draws: Float[np.ndarray, "draw unknown"], count: int
) -> Float[np.ndarray, " draw"]:
    # Largest share of the second-order terms in the mean illuminance of a grid
    whole, linear = (
        model.figures(draws, order=order)[:count:FIGURES] for order in (2, 1)
    )
    return np.asarray((np.abs(whole - linear) / np.abs(whole)).max(axis=0))


def checks(
    job: Job,
    situation: Situation,
    unknowns: UnknownQuantities,
    model: FigureModel,
    draws: Draws,
    found: xr.Dataset,
    count: int,
) -> xr.Dataset:
    """Return draws that are traced again, and their figures; empty without materials.

    Without materials the expansion is exact.
    """
    columns = [draws.names.index(name) for name in unknowns.materials]
    if not columns or not count:
        return xr.Dataset()
    some = draws.alternating[:_CHECKED]
    figures = FIGURES * len(dict.fromkeys(model.grid.tolist()))
    curvature = _curvature(model, some, figures)
    values = some[far_draws(some, columns, count, curvature=curvature)].copy()
    if unknowns.weather:
        values[:, draws.names.index(unknowns.weather)] = 0
    hours = np.flatnonzero(_hours(job, situation))
    rows = []
    for one in values:
        named = dict(zip(draws.names, one.tolist(), strict=True))
        changed = retraced(job, unknowns.of_materials(named), situation.at(hours))
        lux = whole_illuminance(changed, unknowns, named)
        metrics = light(lux, model.target_lux)[:, None]
        rows.append([float(own[0]) for own in grid_figures(metrics, model.grid)])
    traced = np.array(rows)
    expanded = model.figures(values)[: traced.shape[1]].T
    fails = failing(traced, expanded, found, one_sensor=_one_sensor(model.grid))
    _warn(traced, expanded, fails, found)
    axes = ("check", "checked_figure")
    return xr.Dataset(
        {
            "check_traced": (axes, traced),
            "check_expanded": (axes, expanded),
            "check_values": (("check", "unknown"), values),
            "check_fails": (axes, fails),
        }
    )


def _hours(job: Job, situation: Situation) -> np.ndarray:
    # Whether each time step is within the occupied hours of the study
    from_hour, to_hour = job.study.schedule.from_hour, job.study.schedule.to_hour
    return occupied_hours(situation.skies.times, from_hour=from_hour, to_hour=to_hour)


def _one_sensor(grid: np.ndarray) -> np.ndarray:
    # Share of one sensor in the area of its grid [%], for the last figure of each grid
    each = [(grid == name).sum() for name in dict.fromkeys(grid.tolist())]
    return np.array([share for n in each for share in (0, 0, 0, 0, 100 / n)])


def failing(
    traced: Float[np.ndarray, "check figure"],
    expanded: Float[np.ndarray, "check figure"],
    found: xr.Dataset,
    *,
    one_sensor: Float[np.ndarray, " figure"] | float = 0.0,
) -> Bool[np.ndarray, "check figure"]:
    """Return whether the expansion fails for each check and figure.

    `one_sensor` is the share of a sensor in figures that count sensors [%].
    """
    count = traced.shape[1]
    spread = found["known_figure_deviation"].values[:count]
    noise = found["known_figure_error"].values[:count]
    gap = np.abs(traced - expanded)
    scale = np.abs(found["known_figure_value"].values[:count])
    limits = _WRONG * spread, _RELATIVE * scale, 2 * noise, 1.01 * one_sensor
    return np.asarray(gap > np.max(np.broadcast_arrays(*limits), axis=0))


def _warn(
    traced: np.ndarray, expanded: np.ndarray, wrong: np.ndarray, found: xr.Dataset
) -> None:
    if not wrong.any():
        return
    gap = np.where(wrong, np.abs(traced - expanded), 0.0)
    relative = gap / found["known_figure_deviation"].values[: gap.shape[1]]
    check, figure = np.unravel_index(int(np.nanargmax(relative)), gap.shape)
    name, place, unit = (
        str(found[f"known_figure_{part}"].values[figure])
        for part in ("name", "place", "unit")
    )
    warnings.warn(
        "uncertainty: far from the model the expansion fails in"
        f" {wrong.any(axis=1).sum()} of {len(wrong)} checks: {name} of {place} is"
        f" {expanded[check, figure]:.4g} {unit} by the expansion and"
        f" {traced[check, figure]:.4g} {unit} if traced again; narrower distributions"
        " of materials expected",
        ClerestoryWarning,
        stacklevel=2,
    )
