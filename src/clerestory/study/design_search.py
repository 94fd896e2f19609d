"""Search of designs: continuous variables by the expansion, discrete ones as variants.

Each variant of a study is expanded about the middle of the ranges of the variables.
Quasi-random values, and the corners of the ranges, give candidates; those within all
limits that no other one dominates are the Pareto front. Some of them, spread over the
front, become variants of the study that are run in full.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Bool, Float

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.scene.material_parameters import with_parameters
from clerestory.study.config import Study
from clerestory.study.design_glare import GLARE, DesignSpace, glare_figures
from clerestory.study.illuminance_expansion import illuminance_expansion
from clerestory.study.inputs import Inputs, read_inputs
from clerestory.study.job import Job
from clerestory.study.operated_study import operated
from clerestory.study.optimise_tables import FigureTable, OptimiseTable
from clerestory.study.uncertain_figures import FigureModel
from clerestory.study.unknown_quantities import unknown_quantities

# Largest number of variables of which all corners are candidates
_CORNERS = 8


@dataclass(frozen=True, eq=False)
class Candidates:
    """Candidates of one variant, and their figures of merit.

    Attributes
    ----------
    variant : name of the variant
    values : values of the variables
    figures : figures by name and grid, over the candidates
    """

    variant: str
    values: Float[np.ndarray, "candidate variable"]
    figures: Mapping[tuple[str, str], Float[np.ndarray, " candidate"]]

    __repr__ = brief


@dataclass(frozen=True)
class Design:
    """A design of the Pareto front: variant, values of variables, expected figures."""

    variant: str
    values: Mapping[str, float]
    figures: Mapping[tuple[str, str], float]


def figure_names(target_lux: float, grids: Sequence[str]) -> list[tuple[str, str]]:
    """Return name and grid of the figures that designs are judged by.

    >>> figure_names(300, ["desks"])[1]
    ('hours with 300 lux or more', 'desks')
    """
    target = f"{target_lux:g} lux"
    names = (
        "mean illuminance",
        f"hours with {target} or more",
        "useful illuminance",
        "hours above the useful range",
        f"area with {target} in half of the hours",
    )
    return [(name, grid) for grid in grids for name in names]


def candidates(variant: str, job: Job, table: OptimiseTable) -> Candidates:
    """Return candidates of a variant, with figures from the expansion."""
    unknowns = [own.unknown() for own in table.variable]
    quantities = unknown_quantities(job.study, job.inputs, unknowns)
    ends = np.array([[own.low, own.high] for own in table.variable])
    middle = dict(zip((u.label for u in unknowns), ends.mean(axis=1), strict=True))
    scene = with_parameters(job.scene, quantities.of_materials(middle))
    job = replace(job, inputs=replace(job.inputs, scene=scene))
    quantities = replace(
        quantities,
        unknowns=tuple(
            replace(own, reference=middle[own.name])
            if own.name in quantities.materials
            else own
            for own in quantities.unknowns
        ),
    )
    situation, schedule = operated(job), job.study.schedule
    hours = occupied_hours(
        situation.skies.times, from_hour=schedule.from_hour, to_hour=schedule.to_hour
    )
    steps = np.flatnonzero(hours)
    expansion = illuminance_expansion(job, quantities, [situation], steps)
    grids = list(job.inputs.grids)
    owner = np.repeat(grids, [len(own) for own in job.inputs.grids.values()])
    names = tuple(own.name for own in quantities.unknowns)
    target = job.study.metrics.target_lux
    model = FigureModel(names, expansion, None, owner, target, 1.0)
    values = _values(ends, table)
    found = model.figures(values)
    figures = dict(zip(figure_names(target, grids), found, strict=True))
    if any(own.figure == GLARE for own in (*table.goal, *table.limit)):
        space = DesignSpace(quantities, ends, steps)
        figures |= glare_figures(job, situation, space, values)
    return Candidates(variant, values, figures)


def _values(ends: np.ndarray, table: OptimiseTable) -> np.ndarray:
    # Sobol' points, and the corners of the ranges
    count = len(ends)
    sequence = scipy.stats.qmc.Sobol(count, rng=np.random.default_rng(table.seed))
    points = sequence.random(table.candidates)
    if count <= _CORNERS:
        corners = list(itertools.product((0.0, 1.0), repeat=count))
        points = np.concatenate([points, np.array(corners)])
    return np.asarray(ends[:, 0] + points * (ends[:, 1] - ends[:, 0]))


def named_figure(
    wanted: FigureTable, keys: Sequence[tuple[str, str]]
) -> tuple[str, str]:
    """Return name and grid of a figure of the table [optimise].

    Raises
    ------
    InputError : no figure of this name, or no grid of this name has it
    """
    names = list(dict.fromkeys(name for name, _ in keys))
    known = "; ".join(dict.fromkeys([*names, GLARE]))
    message = f'[optimise] names the figure "{wanted.figure}"; one of {known} expected'
    require(wanted.figure in names, message)
    places = [place for name, place in keys if name == wanted.figure]
    place = wanted.place or places[0]
    if place not in places:
        known = ", ".join(places)
        raise InputError(
            f'[optimise] names the grid "{place}"; one of {known} expected'
        )
    return wanted.figure, place


def within_limits(
    figures: Mapping[tuple[str, str], Float[np.ndarray, " candidate"]],
    table: OptimiseTable,
) -> Bool[np.ndarray, " candidate"]:
    """Return which candidates are within all limits."""
    keys = list(figures)
    inside = np.ones(len(next(iter(figures.values()))), dtype=bool)
    for limit in table.limit:
        values = figures[named_figure(limit, keys)]
        inside &= values >= (-np.inf if limit.least is None else limit.least)
        inside &= values <= (np.inf if limit.most is None else limit.most)
    return inside


def goal_values(
    figures: Mapping[tuple[str, str], Float[np.ndarray, " candidate"]],
    table: OptimiseTable,
) -> Float[np.ndarray, "candidate goal"]:
    """Return the goals' values; more is better."""
    keys = list(figures)
    columns = []
    for goal in table.goal:
        key = named_figure(goal, keys)
        less = goal.aim == "less" or (goal.aim is None and "above" in key[0])
        columns.append((-1 if less else 1) * figures[key])
    return np.stack(columns, axis=1)


def chosen_designs(found: Sequence[Candidates], table: OptimiseTable) -> list[Design]:
    """Return designs of the Pareto front of all variants, spread over the front.

    Raises
    ------
    InputError : no candidate is within the limits
    """
    rows, goals = [], []
    for number, own in enumerate(found):
        inside = np.flatnonzero(within_limits(own.figures, table))
        if not inside.size:
            continue
        values = goal_values(own.figures, table)[inside]
        front = non_dominated(values)
        rows += [(number, int(k)) for k in inside[front]]
        goals.append(values[front])
    require(rows, "no design is within the limits of [optimise]; wider limits expected")
    every = np.concatenate(goals)
    front = np.flatnonzero(non_dominated(every))
    names = [own.label for own in table.variable]
    designs = []
    for k in front[spread(every[front], table.designs)].tolist():
        number, at = rows[k]
        own = found[number]
        designs.append(
            Design(
                own.variant,
                dict(zip(names, own.values[at].tolist(), strict=True)),
                {key: float(values[at]) for key, values in own.figures.items()},
            )
        )
    return designs


def non_dominated(
    values: Float[np.ndarray, "candidate goal"],
) -> Bool[np.ndarray, " candidate"]:
    """Return the candidates that no other one dominates; larger values are better.

    Of candidates with equal values the first one is kept.

    >>> goals = np.array([[1.0, 3.0], [2.0, 2.0], [1.0, 2.0], [2.0, 2.0]])
    >>> non_dominated(goals).tolist()
    [True, True, False, False]
    """
    kept = np.zeros(len(values), dtype=bool)
    # By falling sums, a candidate is dominated only by an earlier one
    for at in np.argsort(-values.sum(axis=1), kind="stable").tolist():
        better = (values[kept] >= values[at]).all(axis=1)
        kept[at] = not better.any()
    return kept


def spread(values: Float[np.ndarray, "candidate goal"], count: int) -> list[int]:
    """Return candidates with the best value of each goal, then far from each other.

    >>> spread(np.array([[0.0, 4.0], [1.0, 3.0], [2.0, 2.0], [4.0, 0.0]]), 3)
    [3, 0, 2]
    """
    size = np.maximum(np.ptp(values, axis=0), 1e-12)
    scaled = values / size
    best = [int(np.argmax(scaled[:, k])) for k in range(values.shape[1])]
    chosen = list(dict.fromkeys(best))[:count]
    while len(chosen) < min(count, len(values)):
        gaps = np.linalg.norm(scaled[:, None] - scaled[chosen][None], axis=-1)
        nearest = gaps.min(axis=1)
        if nearest.max() <= 1e-9:
            break
        chosen.append(int(np.argmax(nearest)))
    return chosen


def inputs_of(study: Study) -> Inputs:
    """Return the inputs of a study with a table [optimise].

    Raises
    ------
    InputError : no table [optimise]
    """
    require(
        study.optimise is not None, "no table [optimise] in the study; one expected"
    )
    return read_inputs(study)
