"""Total uncertainty of a study: what is not known, carried to its figures of merit.

Quasi-random draws of the unknown quantities give the distribution of each figure and
its Sobol' indices. Draws far from the model are traced again, to check the expansion.
"""

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
import xarray as xr

from clerestory.metrics.compliance import Assessment
from clerestory.phases.matrix_equation import States
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.expansion_checks import checks
from clerestory.study.illuminance_expansion import (
    direct_expansion,
    illuminance_expansion,
    situations,
)
from clerestory.study.job import Job
from clerestory.study.results import Results
from clerestory.study.retracing import Situation
from clerestory.study.uncertain_figures import (
    FigureModel,
    assessments,
    varying_criteria,
)
from clerestory.study.unknown_quantities import UnknownQuantities, unknown_quantities
from clerestory.study.variant_figures import VariantFigure, run_figures
from clerestory.uncertainty.draws import Correlated, Draws, draw
from clerestory.uncertainty.indices import sobol_indices

_QUANTILES = (0.05, 0.5, 0.95)


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
    parts = [found, checks(job, every[0], unknowns, model, draws, found, table.checks)]
    if standards:
        named = model.named(draws.alternating)
        each = assessments(data, standards, whole, sun, named)
        parts.append(_probabilities(each, varying_criteria(data, standards)))
    report(1.0, "done")
    return xr.merge(parts)


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


def _probabilities(
    each: Sequence[tuple[Assessment, ...]], varying: Collection[str]
) -> xr.Dataset:
    # Probability of reaching each level of each criterion that depends on the light
    rows = []
    for one in range(len(each[0])):
        first = each[0][one]
        for number, verdict in enumerate(first.verdicts):
            levels = np.array([own[one].verdicts[number].level for own in each])
            known = verdict.levels and (levels >= 0).all()
            if not known or verdict.criterion not in varying:
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
