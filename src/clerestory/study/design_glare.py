"""Glare of designs: hourly DGP as a quadratic function of the design variables.

DGP is computed for a few designs: V is expanded to second order in the reflectances,
direct light is traced again, and light through windows is scaled. A quadratic function
is fitted to the DGP of each hour, and gives the figures of all candidates. The best
designs are run in full, so that errors of the fit do not remain in results.

Reference: G. E. P. Box, K. B. Wilson, "On the experimental attainment of optimum
conditions", Journal of the Royal Statistical Society B 13 (1), 1951.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Float, Int

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.engine.effort import Effort
from clerestory.errors import InputError
from clerestory.glare.changed_rooms import changed_room, without_components
from clerestory.glare.eye_directions import SUN_SOLID_ANGLE, SunDisc
from clerestory.glare.point_glare import point_glare
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.view_grid_metrics import DISTURBING
from clerestory.glare.view_point_tracer import ViewPointTracer
from clerestory.glare.view_points import ViewPoint
from clerestory.matrix.expansion import expanded_matrix
from clerestory.phases.methods import METHODS
from clerestory.phases.picture_matrices import differentiated_view_matrices
from clerestory.scene.view import View
from clerestory.study.annual_views import sees_glare
from clerestory.study.job import VIEW_GRIDS, Job
from clerestory.study.retracing import Situation
from clerestory.study.study_tracing import differentiated_matrices
from clerestory.study.unknown_quantities import UnknownQuantities
from clerestory.study.view_matrices import shaded_windows

# Name of the figure, as in a run
GLARE = f"hours with DGP above {DISTURBING:.2f}"

# Paths per cell for V, and to the windows; largest number of cells
_SAMPLES, _SUN_SAMPLES, _MOST = 256, 128, 2000

# Difference of the seeds of views from those of view grids
_SEED = 0x90000

# Candidates that are evaluated together
_CANDIDATES = 128

# Figures by name and view, over the candidates
Figures = dict[tuple[str, str], Float[np.ndarray, " candidate"]]


@dataclass(frozen=True, eq=False)
class DesignSpace:
    """Design variables and their ranges, with the hours in which glare counts.

    Attributes
    ----------
    quantities : the variables, with the middle of their ranges as reference
    ends : ends of the ranges
    steps : indices of the occupied time steps
    """

    quantities: UnknownQuantities
    ends: Float[np.ndarray, "variable 2"]
    steps: Int[np.ndarray, " step"]

    __repr__ = brief

    def scaled(self, values: Float[np.ndarray, "design variable"]) -> np.ndarray:
        """Return values of the variables on a scale from -1 to 1."""
        middle, half = self.ends.mean(axis=1), np.ptp(self.ends, axis=1) / 2
        return np.asarray((values - middle) / half)


def glare_figures(
    job: Job,
    situation: Situation,
    space: DesignSpace,
    values: Float[np.ndarray, "candidate variable"],
) -> Figures:
    """Return the hours with disturbing glare of each view [%], over the candidates.

    The scene of the job has the middle values.

    Raises
    ------
    InputError : no view of 180°, or a method with ports
    """
    cameras = zip(job.study.view, job.inputs.cameras, strict=True)
    eyes = {t.label: c.view for t, c in cameras if sees_glare(c.view)}
    if not eyes or not job.inputs.groups:
        raise InputError(
            f'[optimise] names the figure "{GLARE}", but no view is wide enough for'
            " glare; a table [[view]] of 180° and windows expected"
        )
    require(
        not METHODS[job.study.method].facade,
        f'[optimise] names the figure "{GLARE}" with method "{job.study.method}"; a'
        " method without ports expected",
    )
    tracer, found = _tracer(job, situation, space), {}
    trials = _trials(space)
    for number, (label, view) in enumerate(eyes.items()):
        effort = job.pixel_effort(_SAMPLES, VIEW_GRIDS + _SEED * (1 + number))
        dgp = _trial_dgp(tracer, view, situation, space, trials, effort)
        basis = quadratic_basis(space.scaled(trials))
        fit = np.linalg.lstsq(basis, dgp, rcond=None)[0]
        found[GLARE, label] = np.concatenate(
            [
                100 * (quadratic_basis(space.scaled(some)) @ fit > DISTURBING).mean(1)
                for some in np.split(
                    values, range(_CANDIDATES, len(values), _CANDIDATES)
                )
            ]
        )
    return found


def quadratic_basis(x: Float[np.ndarray, "design variable"]) -> np.ndarray:
    """Return 1, each variable, and all products of two of them, as columns.

    >>> quadratic_basis(np.array([[2.0, 3.0]])).tolist()
    [[1.0, 2.0, 3.0, 4.0, 6.0, 9.0]]
    """
    pairs = itertools.combinations_with_replacement(range(x.shape[1]), 2)
    columns = [np.ones(len(x)), *x.T, *(x[:, i] * x[:, j] for i, j in pairs)]
    return np.stack(columns, axis=1)


def _trials(space: DesignSpace) -> Float[np.ndarray, "design variable"]:
    # Middle, ends of each variable, and Sobol points: twice as many as coefficients
    count = len(space.ends)
    axes = np.concatenate([np.eye(count), -np.eye(count)])
    more = max(2, (count + 1) * (count + 2) - len(axes) - 1)
    sequence = scipy.stats.qmc.Sobol(count, rng=np.random.default_rng(1))
    points = 2 * sequence.random_base2(int(np.ceil(np.log2(more))))[:more] - 1
    x = np.concatenate([np.zeros((1, count)), axes, points])
    middle, half = space.ends.mean(axis=1), np.ptp(space.ends, axis=1) / 2
    return np.asarray(middle + x * half)


def _tracer(job: Job, situation: Situation, space: DesignSpace) -> ViewPointTracer:
    # The room, with derivatives of D by the materials that vary
    matrices, names = situation.matrices, list(space.quantities.materials.values())
    if names:
        windows = tuple(
            replace(window, whole=other.whole)
            for window, other in zip(
                matrices.windows, differentiated_matrices(job, names), strict=True
            )
        )
        matrices = replace(matrices, windows=windows)
    return ViewPointTracer(
        job.scene, shaded_windows(job, matrices), situation.skies, tuple(matrices.terms)
    )


def _trial_dgp(
    tracer: ViewPointTracer,
    view: View,
    situation: Situation,
    space: DesignSpace,
    trials: Float[np.ndarray, "design variable"],
    effort: Effort,
) -> Float[np.ndarray, "design step"]:
    # DGP of a view in the occupied hours, in a few designs
    position = np.asarray(view.position, dtype=float)
    blank = tracer.blank(position, [view], Refinement(most=_MOST))
    samples = tracer.cells(blank, effort)
    materials = space.quantities.materials
    views = differentiated_view_matrices(
        tracer.scene,
        [each.window for each in tracer.windows],
        samples.cells(position),
        derivatives=list(materials.values()),
        reflected=tracer.sunlit,
        effort=effort,
    )
    reference, found = space.quantities.reference, []
    for trial in trials:
        named = dict(zip(reference, trial.tolist(), strict=True))
        values = space.quantities.of_materials(named)
        middle = space.quantities.of_materials(reference)
        change = {name: value - middle[name] for name, value in values.items()}
        bare = {
            name: without_components(expanded_matrix(each, change))
            for name, each in views.items()
        }
        room = changed_room(tracer, values, change)
        point = room.traced(blank, samples, bare, effort, sun_samples=_SUN_SAMPLES)
        factors = _factors(space.quantities, named, len(point.windows))
        found.append(_dgp(point, situation, space.steps, factors))
    return np.array(found)


def _factors(
    quantities: UnknownQuantities, named: Mapping[str, float], count: int
) -> list[float]:
    # Factor on the light through each window group
    return [
        float(np.prod([named[n] for n, own in quantities.windows.items() if k in own]))
        for k in range(count)
    ]


def _dgp(
    point: ViewPoint,
    situation: Situation,
    steps: Int[np.ndarray, " step"],
    factors: Sequence[float],
) -> Float[np.ndarray, " step"]:
    # DGP at the time steps, 0 in the dark, with factors on the light through windows
    lit = point.skies.whole.diffuse[:, steps].max(axis=0) > 0
    seen = steps[lit]
    luminance = np.zeros((point.samples.count, len(seen)), np.float32)
    discs = []
    for own, states, factor in zip(
        _parts(point), situation.states, factors, strict=True
    ):
        chosen = [np.asarray(states)[seen]]
        own.keep_beams(chosen, seen)
        luminance += np.float32(factor) * own.luminance(chosen, seen)
        discs.append((factor, own.sun_disc(chosen, seen)))
    found = point_glare(
        point.samples, luminance, point.views, sun=_sum(discs), quantities=["dgp"]
    )
    dgp = np.zeros(len(steps))
    dgp[lit] = found["dgp"].values[0]
    return dgp


def _parts(point: ViewPoint) -> Iterator[ViewPoint]:
    for window in point.windows:
        yield replace(point, windows=(window,))


def _sum(discs: Sequence[tuple[float, SunDisc]]) -> SunDisc:
    # The sun's disc seen through several windows
    angles = sum(disc.solid_angle for _, disc in discs)
    flux = sum(factor * disc.luminance * disc.solid_angle for factor, disc in discs)
    angle = np.minimum(angles, SUN_SOLID_ANGLE)
    level = np.divide(flux, angle, out=np.zeros_like(angle), where=angle > 0)
    seen = np.argmax([disc.solid_angle for _, disc in discs], axis=0)
    every = np.stack([disc.direction for _, disc in discs])
    return SunDisc(every[seen, np.arange(len(angle))], level, angle)
