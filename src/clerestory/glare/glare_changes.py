"""Changes of annual glare for changes of reflectances, at a view point.

V, and D of materials outside, are expanded to second order in each parameter, with
derivatives from the same paths. Direct light, straight or reflected once, which the
direct correction takes from recorded paths, is traced again in the changed room. DGP
has a threshold and a limit: it is not differentiated, but evaluated for the changed
luminances, in the same cells of the sphere. Shade states are held constant.

The standard error is that of the delete-one jackknife over the batches of V: each
replicate is the metric of all batches but one (B. Efron, The Jackknife, the Bootstrap
and Other Resampling Plans, SIAM 1982).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Unpack

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.brief_repr import brief
from clerestory.checks import require, same_length
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.glare.changed_rooms import changed_room, without_components
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.view_grid_metrics import DISTURBING, view_figures
from clerestory.glare.view_point_tracer import ViewPointTracer
from clerestory.glare.view_points import ViewPoint
from clerestory.matrix.derivatives import Parameter
from clerestory.matrix.expansion import expanded_matrix, parameter_steps
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    States,
    Term,
    WindowMatrices,
)
from clerestory.phases.methods import FIVE_PHASE
from clerestory.phases.picture_matrices import differentiated_view_matrices
from clerestory.phases.shaded_windows import ShadedWindow
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import Scene
from clerestory.scene.view import View

# Metrics of a view, with their units
FIGURES = {
    "mean DGP": "",
    "DGP exceeded in 5 % of the hours": "",
    f"hours with DGP above {DISTURBING:.2f}": "%",
}

_AXES = "parameter", "change", "glare_figure", "view"

# Least reflectance of a scene that is traced again
_LEAST = 1e-6


@dataclass(frozen=True, eq=False)
class GlareOperation:
    """Operation of the windows, and the time in which glare counts.

    Attributes
    ----------
    states : shade state of each window group at each time step
    occupied : mask of the occupied time steps
    """

    states: States
    occupied: Bool[np.ndarray, " time"]

    __repr__ = brief


def glare_changes(
    scene: Scene,
    windows: Sequence[ShadedWindow],
    views: Sequence[View],
    *,
    skies: Skies,
    states: States | None = None,
    occupied: Bool[np.ndarray, " time"] | None = None,
    terms: Sequence[Term] = FIVE_PHASE,
    materials: Sequence[str] | Literal["all"] = "all",
    step: float = 0.05,
    refinement: Refinement | None = None,
    sun_samples: int = 128,
    **keywords: Unpack[EffortKeywords],
) -> xr.Dataset:
    """Return the changes of annual glare for a step of each parameter of a room.

    Parameters
    ----------
    scene : room surfaces, without the windows
    windows : window groups and their shade states; if D has derivatives, so has glare
        by materials outside
    views : views from one point
    states : shade state of each window group at each time step; default: 0
    occupied : mask of the time steps that count; default: all
    materials : names of materials that are changed, or "all"
    step : change of each parameter; smaller where the value would leave 0…1
    samples : number of paths per cell of the sphere for V

    The other parameters are those of `trace_view_point`.

    Returns
    -------
    `glare_sensitivity` and `glare_sensitivity_error` over (parameter, change,
    glare_figure, view), and `glare_sensitivity_base` over (glare_figure, view)

    Raises
    ------
    InputError : no such material, or one that cannot be changed, such as a BSDF
    """
    require(views, "no views; at least one expected")
    effort, count = (
        effort_of(glare_changes, keywords, default=Goal(512)),
        len(skies.times),
    )
    if states is None:
        states = [np.zeros(count, dtype=int) for _ in windows]
    tracer = ViewPointTracer(scene, tuple(windows), skies, tuple(terms))
    position = np.asarray(views[0].position, dtype=float)
    return view_point_changes(
        tracer,
        tracer.blank(position, views, refinement or Refinement()),
        GlareOperation(states, np.full(count, True) if occupied is None else occupied),
        parameters=material_parameters(scene, materials),
        step=step,
        effort=effort,
        sun_samples=sun_samples,
    )


def view_point_changes(
    tracer: ViewPointTracer,
    point: ViewPoint,
    operation: GlareOperation,
    *,
    parameters: Sequence[Parameter],
    step: float,
    effort: Effort,
    sun_samples: int,
) -> xr.Dataset:
    """Return the changes of annual glare at a view point; see `glare_changes`.

    `point` has no matrices: it is as `ViewPointTracer.blank` returns it.
    """
    steps = parameter_steps(
        np.array([parameter.value for parameter in parameters]),
        np.array([parameter.quantity for parameter in parameters]),
        step,
    )
    same_length(operation.occupied, point.skies.times, "occupied hours", "time steps")
    require(operation.occupied.any(), "no time step is occupied; at least one expected")
    # Refuse materials that cannot be changed before anything is traced
    rooms = [tracer, *_rooms(tracer, parameters, steps)]
    samples = tracer.cells(point, effort)
    views = differentiated_view_matrices(
        tracer.scene,
        [each.window for each in tracer.windows],
        samples.cells(point.position),
        derivatives=[parameter.name for parameter in parameters],
        reflected=tracer.sunlit,
        effort=effort,
    )
    found = []
    for room, change in zip(rooms, _changes(parameters, steps), strict=True):
        V = {name: expanded_matrix(each, change) for name, each in views.items()}
        bare = {name: without_components(each) for name, each in V.items()}
        whole = room.traced(point, samples, bare, effort, sun_samples=sun_samples)
        found.append([_figures(each, operation) for each in _replicates(whole, V)])
    return _labelled(np.array(found), parameters, steps)


def _rooms(
    tracer: ViewPointTracer,
    parameters: Sequence[Parameter],
    steps: Float[np.ndarray, "parameter 2"],
) -> Iterator[ViewPointTracer]:
    for parameter, pair in zip(parameters, steps.tolist(), strict=True):
        for step in pair:
            values = {parameter.name: max(parameter.value + step, _LEAST)}
            yield changed_room(tracer, values, {parameter.name: step})


def _changes(
    parameters: Sequence[Parameter], steps: Float[np.ndarray, "parameter 2"]
) -> Iterator[Mapping[str, float]]:
    yield {}
    for parameter, pair in zip(parameters, steps.tolist(), strict=True):
        for step in pair:
            yield {parameter.name: step}


def _replicates(
    point: ViewPoint, views: Mapping[str, TransferMatrix]
) -> Iterator[ViewPoint]:
    # The view point, and with V of all batches but one
    yield point
    for batch in range(_batches(views)):
        yield replace(
            point,
            windows=tuple(
                _without_batch(window, matrix, batch)
                for window, matrix in zip(point.windows, views.values(), strict=True)
            ),
        )


def _batches(views: Mapping[str, TransferMatrix]) -> int:
    parts = next(iter(views.values())).components
    assert parts is not None
    return len(parts)


def _without_batch(
    window: WindowMatrices, view: TransferMatrix, batch: int
) -> WindowMatrices:
    # The components are deviations of the batches over √(B (B − 1))
    parts, chain = view.components, window.whole
    assert parts is not None
    assert chain is not None
    (V,) = chain.receiving
    assert isinstance(V, TransferMatrix)
    scale = np.float32(np.sqrt(len(parts) / (len(parts) - 1)))
    values = V.values - scale * parts[batch]
    whole = MatrixChain((replace(V, values=values),), chain.factors)
    return replace(window, whole=whole)


def _figures(
    point: ViewPoint, operation: GlareOperation
) -> Float[np.ndarray, "figure view"]:
    occupied = np.flatnonzero(operation.occupied)
    found = point.glare(
        operation.states, steps=occupied, quantities=["dgp"], errors=False
    )
    dgp = found["dgp"].transpose("view", "time").values
    figures, mean = view_figures(dgp), np.nan_to_num(dgp).mean(axis=1)
    return np.stack([mean, figures.exceeded, 100 * figures.share[:, 1]])


def _labelled(
    found: Float[np.ndarray, "case replicate figure view"],
    parameters: Sequence[Parameter],
    steps: Float[np.ndarray, "parameter 2"],
) -> xr.Dataset:
    base, changed = found[0], found[1:].reshape(*steps.shape, *found.shape[1:])
    change = changed - base
    others, count = change[:, :, 1:], found.shape[1] - 1
    spread = np.square(others - others.mean(axis=2, keepdims=True)).sum(axis=2)
    return xr.Dataset(
        {
            "glare_sensitivity": (_AXES, change[:, :, 0]),
            "glare_sensitivity_error": (
                _AXES,
                np.sqrt(spread * (count - 1) / count),
            ),
            "glare_sensitivity_base": (_AXES[2:], base[0]),
            "glare_sensitivity_unit": ("glare_figure", list(FIGURES.values())),
            "glare_sensitivity_step": (_AXES[:2], steps),
        },
        coords={
            "parameter": [parameter.name for parameter in parameters],
            "change": ["less", "more"],
            "glare_figure": list(FIGURES),
        },
    )
