"""View points of the view grids of a study: traced, cached, and evaluated on demand.

The cells of the sphere around a position, and V for these cells, are cached. The paths
to the windows are traced again whenever a position is loaded: this takes about a
second, and files of them are large.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Protocol

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.engine.effort import Effort
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.sphere_samples import SphereSamples, regular_samples
from clerestory.glare.view_point_tracer import ViewPointTracer
from clerestory.glare.view_points import ViewPoint
from clerestory.matrix.axis import pixel_axis, unknown_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import Skies, States
from clerestory.progress import Progress
from clerestory.study.control_inputs import GridGlareFunction
from clerestory.study.job import VIEW_GRIDS, Display, Job
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.view_grid_positions import ViewGrid
from clerestory.study.view_matrices import half_views, shaded_windows

# Function that chooses the cells of a view point
ChooseCells = Callable[[ViewPointTracer, ViewPoint, Effort], SphereSamples]

# Level of cells whose number is usual, and rounds and paths per cell of their choice
USUAL_LEVEL, _ROUNDS, _TRIAL = 6, 3, 64

# Default number of paths per cell for V, and to the windows
_SAMPLES, _SUN_SAMPLES = 256, 128

# Difference of the seeds of consecutive positions, more than those that one uses
_SEEDS = 7919

# Share of `memory_gb` for view points that stay in memory; bytes of a cell apart from
# V: recorded paths, on the host and on the compute device
_SHARE, _CELL = 0.8, 8192


class Positions(Protocol):
    """Positions of the view grids of a study."""

    @property
    def job(self) -> Job:
        """Inputs of the study."""

    @property
    def skies(self) -> Skies:
        """S, S_ds and S_sun, with the time steps."""

    def load(self, grid: ViewGrid, number: int) -> object:
        """Trace a position, or read it from the cache."""

    def plan(self, grid: ViewGrid) -> None:
        """Record the tracing of one position of a grid, with a usual cell count."""

    def glare(
        self,
        grid: ViewGrid,
        number: int,
        states: States,
        steps: Int[np.ndarray, " step"],
        *,
        errors: bool = True,
    ) -> xr.Dataset:
        """Return the glare of the views of a position; see `GridPoints`."""


def trace_positions(points: Positions, display: Display) -> None:
    """Trace all positions of all view grids that are not in the cache."""
    for grid in points.job.inputs.view_grids:
        report = display(f"positions of {grid.name}")
        for number in range(len(grid)):
            points.load(grid, number)
            done = number + 1
            report(done / len(grid), f"{done} of {len(grid)} positions")


def position_label(grid: ViewGrid, number: int) -> str:
    """Return the name of a position in the cache."""
    return f"view-grid-{grid.name}-{number + 1:04d}"


def position_effort(job: Job, grid: ViewGrid, number: int, *, samples: int) -> Effort:
    """Return the sampling effort of a position, with `samples` paths per cell."""
    first = sum(len(each) for each in _before(job.inputs.view_grids, grid))
    return job.pixel_effort(samples, VIEW_GRIDS + _SEEDS * (first + number))


@dataclass(frozen=True, eq=False)
class GridPoints:
    """View points of all view grids of a study.

    As many view points as fit into memory are kept; the others are loaded on demand.
    """

    job: Job
    matrices: StudyMatrices
    skies: Skies
    _kept: dict[tuple[str, int], ViewPoint] = field(default_factory=dict)

    def glare(
        self,
        grid: ViewGrid,
        number: int,
        states: States,
        steps: Int[np.ndarray, " step"],
        *,
        errors: bool = True,
    ) -> xr.Dataset:
        """Return DGP, with its error and illuminance, of the views of a position.

        Without errors, only DGP is computed.
        """
        names = ("dgp", "illuminance") if errors else ("dgp",)
        point = self.load(grid, number)
        return point.glare(states, steps=steps, quantities=names, errors=errors)

    def load(self, grid: ViewGrid, number: int) -> ViewPoint:
        """Return the view point of a position, traced if it is not in the cache."""
        key = grid.name, number
        if key in self._kept:
            return self._kept[key]
        found = self._loaded(grid, number, ViewPointTracer.cells)
        used = sum(map(_bytes, self._kept.values()))
        if used + _bytes(found) < _SHARE * 1e9 * self.job.study.trace.memory_gb:
            self._kept[key] = found
        return found

    def plan(self, grid: ViewGrid) -> None:
        """Record the tracing of one position of a grid, with a usual cell count."""
        self._loaded(grid, 0, _usual_cells)

    def _loaded(self, grid: ViewGrid, number: int, choose: ChooseCells) -> ViewPoint:
        job, table = self.job, grid.table
        effort = position_effort(job, grid, number, samples=table.samples or _SAMPLES)
        tracer = self._tracer
        blank = tracer.blank(
            grid.position[number],
            grid.views(number),
            Refinement(tolerance=table.tolerance, most=table.most_directions),
        )
        parts = blank.position, blank.views, blank.refinement, effort
        key = fingerprint(self._light, *parts)
        label = position_label(grid, number)

        def chosen(_key: str, *, effort: Effort, progress: Progress) -> TransferMatrix:
            return _as_matrix(choose(tracer, blank, effort))

        def views(
            _key: str, *, effort: Effort, progress: Progress
        ) -> dict[str, TransferMatrix]:
            return half_views(tracer.view_matrices(blank, samples, effort))

        samples = _as_cells(job.matrix(f"{label}-cells", partial(chosen, key), effort))
        inner = [each.window for each in tracer.windows]
        V = job.matrices(label, inner, partial(views, key), effort, shown=label)
        paths = table.sun_samples or _SUN_SAMPLES
        return tracer.traced(blank, samples, V, effort, sun_samples=paths)

    @cached_property
    def _tracer(self) -> ViewPointTracer:
        windows = shaded_windows(self.job, self.matrices)
        terms = tuple(self.matrices.terms)
        return ViewPointTracer(self.job.scene, windows, self.skies, terms)

    @cached_property
    def _light(self) -> str:
        # Fingerprint of everything that all positions have in common
        matrices = [
            (each.whole, each.direct) for w in self._tracer.windows for each in w.states
        ]
        skies = [self.skies.whole.diffuse, self.skies.whole.times.astype(np.int64)]
        return fingerprint(self.job.scene_key, matrices, skies)


def grid_glare_function(points: Positions, *, display: Display) -> GridGlareFunction:
    """Return a function that computes the largest DGP among the views of view grids."""
    lit = points.skies.whole.diffuse.max(axis=0) > 0

    def largest(
        states: States,
        steps: Int[np.ndarray, " step"],
        names: Sequence[str],
        *,
        enough: float,
    ) -> Float[np.ndarray, " step"]:
        worst = np.zeros(len(steps))
        for grid in points.job.inputs.view_grids:
            if names and grid.name not in names:
                continue
            report = display(f"glare in view grid {grid.name}")
            for number in range(len(grid)):
                open_ = np.flatnonzero(lit[steps] & (worst <= enough))
                if len(open_):
                    dgp = points.glare(
                        grid, number, states, steps[open_], errors=False
                    )["dgp"]
                    worst[open_] = np.maximum(worst[open_], dgp.max("view").values)
                report((number + 1) / len(grid), f"{number + 1} of {len(grid)}")
        return worst

    return largest


def _usual_cells(
    tracer: ViewPointTracer, point: ViewPoint, effort: Effort
) -> SphereSamples:
    # Cells in a dry run, which records the tracing that chooses the cells
    samples, trial = regular_samples(USUAL_LEVEL), replace(effort, samples=_TRIAL)
    for _ in range(_ROUNDS):
        V = tracer.view_matrices(point, samples, trial)
        tracer.traced(point, samples, V, trial, sun_samples=_TRIAL)
    return samples.centred()


def _before(grids: Sequence[ViewGrid], grid: ViewGrid) -> Sequence[ViewGrid]:
    return grids[: [each.name for each in grids].index(grid.name)]


def _bytes(point: ViewPoint) -> int:
    # Memory of a view point, without the matrices that all view points share
    matrices = [
        matrix
        for window in point.windows
        for chain in (window.whole, window.direct)
        for matrix in (chain.receiving if chain else ())
        if isinstance(matrix, TransferMatrix)
    ]
    return _CELL * point.samples.count + sum(each.values.nbytes for each in matrices)


def _as_matrix(samples: SphereSamples) -> TransferMatrix:
    # Level, row and column of each cell, in the form that the cache stores
    values = np.column_stack([samples.level, samples.place]).astype(float)
    return TransferMatrix(values[None], pixel_axis(samples.count), unknown_axis(3))


def _as_cells(matrix: TransferMatrix) -> SphereSamples:
    level, *place = matrix.values[0].T.astype(np.int64)
    cells = np.stack(place, axis=-1)
    return SphereSamples(level, cells, np.zeros(cells.shape)).centred()
