"""Total uncertainty of a study: what is not known, carried to its figures of merit.

Quasi-random draws of the unknown quantities give the distribution of each figure and
its Sobol' indices. Draws far from the model are traced again, to check the expansion.
"""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.errors import ClerestoryWarning
from clerestory.metrics.compliance import Assessment
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.phases.matrix_equation import States
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.illuminance_expansion import (
    direct_expansion,
    illuminance_expansion,
    situations,
)
from clerestory.study.job import Job
from clerestory.study.results import Results
from clerestory.study.retracing import Situation, retraced, whole_illuminance
from clerestory.study.uncertain_figures import (
    FigureModel,
    assessments,
    grid_figures,
    light,
)
from clerestory.study.unknown_quantities import UnknownQuantities, unknown_quantities
from clerestory.study.variant_figures import VariantFigure, run_figures
from clerestory.uncertainty.draws import Correlated, Draws, draw
from clerestory.uncertainty.indices import sobol_indices

_QUANTILES = (0.05, 0.5, 0.95)

# The expansion fails if its error is above this share of the standard deviation of a
# figure, above this share of its value, above twice the error of the simulation, and
# in shares of the area above that of one sensor
_WRONG, _RELATIVE = 0.25, 0.01


def total_uncertainty(
    job: Job, signals: ControlInputs, states: States, data: xr.Dataset
) -> xr.Dataset:
    """Return the distributions of a study's figures; empty without [uncertainty].

    `data` are the results of the run. The shade states stay those of the run.
    """
    table = job.study.uncertainty
    if table is None:
        return xr.Dataset()
    report = job.display("uncertainty")
    unknowns = unknown_quantities(job.study, job.inputs, table.unknown)
    groups = [Correlated(tuple(c.unknowns), c.correlation) for c in table.correlated]
    draws = draw(unknowns.unknowns, table.draws, correlated=groups, seed=table.seed)
    report(0.0, "derivatives")
    every = situations(
        job, unknowns, Situation(signals.matrices, signals.skies, states)
    )
    standards = job.study.compliance.standards if job.study.compliance else []
    hours = np.flatnonzero(signals.occupied)
    steps = np.arange(len(signals.times)) if standards else hours
    whole = illuminance_expansion(job, unknowns, every, steps)
    sun = None
    if "sun_hours" in data:
        sun = direct_expansion(unknowns, every, steps)
    model = FigureModel(
        draws.names,
        whole.select(np.s_[:], hours) if standards else whole,
        sun and sun.select(np.s_[:], hours) if standards else sun,
        data["grid"].values.astype(str),
        float(data.attrs["target_lux"]),
        signals.step_minutes / 60,
    )
    report(0.5, f"{table.draws:,} draws")
    figures = [
        own
        for own in run_figures(Results(data), name="").figures
        if own.aspect in ("light", "sun")
    ]
    values = model.figures(draws.independent)
    found = _table(figures, unknowns, draws, model, values)
    report(0.8, "checks")
    parts = [found, _checks(job, every[0], unknowns, model, draws, found, table.checks)]
    if standards:
        named = model.named(draws.independent[_spread(draws)])
        each = assessments(data, standards, whole, sun, named)
        parts.append(_probabilities(each))
    report(1.0, "done")
    return xr.merge(parts)


def _spread(draws: Draws) -> np.ndarray:
    # The draws of both sets in turn
    half = len(draws.first)
    return np.arange(2 * half).reshape(2, half).T.ravel()


def _table(
    figures: Sequence[VariantFigure],
    unknowns: UnknownQuantities,
    draws: Draws,
    model: FigureModel,
    values: np.ndarray,
) -> xr.Dataset:
    indices = sobol_indices(draws, model.figures, known=values)
    lines = {
        name: np.array([getattr(f, name) for f in figures])
        for name in ("name", "place", "unit", "value", "error")
    }
    axis, groups = "known_figure", (("known_figure", "unknown_group"))
    told: dict[str, Any] = {
        "known_figure_name": (axis, lines["name"].astype(str)),
        "known_figure_place": (axis, lines["place"].astype(str)),
        "known_figure_unit": (axis, lines["unit"].astype(str)),
        "known_figure_value": (axis, lines["value"].astype(float)),
        "known_figure_error": (axis, lines["error"].astype(float)),
        "known_figure_mean": (axis, values.mean(axis=1)),
        "known_figure_deviation": (axis, values.std(axis=1, ddof=1)),
        "known_figure_quantile": (
            (axis, "quantile"),
            np.quantile(values, _QUANTILES, axis=1).T,
        ),
        "known_figure_draws": ((axis, "draw"), values.astype(np.float32)),
        "unknown_draws": (
            ("draw", "unknown"),
            draws.independent.astype(np.float32),
        ),
        "first_index": (groups, indices.first),
        "first_index_error": (groups, indices.first_error),
        "total_index": (groups, indices.total),
        "total_index_error": (groups, indices.total_error),
    }
    each = [own.distribution for own in unknowns.unknowns]
    told |= {
        "unknown_reference": ("unknown", [own.reference for own in unknowns.unknowns]),
        "unknown_mean": ("unknown", [own.mean for own in each]),
        "unknown_deviation": ("unknown", [own.standard_deviation for own in each]),
        "unknown_shape": ("unknown", np.array([own.shape for own in each])),
        "unknown_kind": (
            "unknown",
            np.array([unknowns.tables[name].kind for name in draws.names]),
        ),
        "unknown_low": ("unknown", np.quantile(draws.independent, 0.05, axis=0)),
        "unknown_high": ("unknown", np.quantile(draws.independent, 0.95, axis=0)),
    }
    coords = {
        "unknown": np.array(draws.names),
        "unknown_group": np.array(draws.labels),
        "quantile": list(_QUANTILES),
    }
    return xr.Dataset(told, coords=coords)


def far_draws(draws: np.ndarray, columns: Sequence[int], count: int) -> list[int]:
    """Return the numbers of draws to check: far from the middle and from each other.

    Among the 95 % of draws nearest to the middle, the farthest one is the first; each
    next one is the farthest from those chosen.

    >>> far_draws(np.linspace(-1, 1, 101)[:, None], [0], 2)
    [2, 98]
    """
    own = draws[:, columns]
    scaled = (own - own.mean(axis=0)) / np.maximum(own.std(axis=0), 1e-12)
    from_middle = (scaled**2).sum(axis=1)
    allowed = from_middle <= np.quantile(from_middle, 0.95)
    chosen: list[int] = []
    distance = from_middle
    for _ in range(min(count, int(allowed.sum()))):
        chosen.append(int(np.argmax(np.where(allowed, distance, -1.0))))
        nearest = ((scaled - scaled[chosen[-1]]) ** 2).sum(axis=1)
        distance = nearest if len(chosen) == 1 else np.minimum(distance, nearest)
    return chosen


def _checks(
    job: Job,
    situation: Situation,
    unknowns: UnknownQuantities,
    model: FigureModel,
    draws: Draws,
    found: xr.Dataset,
    count: int,
) -> xr.Dataset:
    # Draws that are traced again; without materials, the expansion is exact
    columns = [draws.names.index(name) for name in unknowns.materials]
    if not columns or not count:
        return xr.Dataset()
    chosen = far_draws(draws.independent, columns, count)
    values = draws.independent[chosen].copy()
    if unknowns.weather:
        values[:, draws.names.index(unknowns.weather)] = 0
    hours = np.flatnonzero(job_hours(job, situation))
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


def job_hours(job: Job, situation: Situation) -> np.ndarray:
    """Return whether each time step is within the occupied hours of a study."""
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


def _probabilities(each: Sequence[tuple[Assessment, ...]]) -> xr.Dataset:
    # Probability of reaching each level of each criterion
    rows = []
    for one in range(len(each[0])):
        first = each[0][one]
        for number, verdict in enumerate(first.verdicts):
            levels = np.array([own[one].verdicts[number].level for own in each])
            if not verdict.levels or (levels < 0).any():
                continue
            for level, words in enumerate(verdict.levels):
                share = float((levels >= level).mean())
                if level:
                    rows.append(
                        (first.standard, first.space, verdict.criterion, words, share)
                    )
    if not rows:
        return xr.Dataset()
    names = ("standard", "space", "criterion", "level")
    told: dict[str, Any] = {
        f"probable_{name}": ("probable", np.array([row[k] for row in rows], dtype=str))
        for k, name in enumerate(names)
    }
    told["probability"] = ("probable", np.array([row[4] for row in rows]))
    return xr.Dataset(told, attrs={})
