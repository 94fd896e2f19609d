"""View grids of studies whose glazing is part of the scene, by two phases.

The matrices of a position have several hundred megabytes, and there are no shade
states: the annual glare of each position is cached instead of its matrices.
"""

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import xarray as xr
from jaxtyping import Int

from clerestory.engine.effort import Effort
from clerestory.glare.glazed_view_points import (
    SAMPLES,
    SUN_SAMPLES,
    GlazedViewPoint,
)
from clerestory.glare.sphere_refinement import Refinement
from clerestory.matrix.axis import pixel_axis, unknown_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import Skies, States
from clerestory.progress import Progress
from clerestory.study.job import Job
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.view_grid_points import (
    USUAL_LEVEL,
    GridPoints,
    Positions,
    position_effort,
    position_label,
)
from clerestory.study.view_grid_positions import ViewGrid

# Quantities that are cached, in this order
_QUANTITIES = ("dgp", "dgp_error", "illuminance")


def grid_points(job: Job, matrices: StudyMatrices, skies: Skies) -> Positions:
    """Return the positions of the view grids of a study."""
    if job.inputs.groups:
        return GridPoints(job, matrices, skies)
    return GlazedGridPoints(job, skies)


@dataclass(frozen=True, eq=False)
class GlazedGridPoints:
    """Positions of all view grids of a study without window groups."""

    job: Job
    skies: Skies

    def glare(
        self,
        grid: ViewGrid,
        number: int,
        states: States,
        steps: Int[np.ndarray, " step"],
        *,
        errors: bool = True,
    ) -> xr.Dataset:
        """Return the glare of the views of a position; there are no states."""
        values = self.load(grid, number).values[0]
        count = len(values) // len(_QUANTITIES)
        parts = {
            name: (("view", "time"), values[at * count : (at + 1) * count, steps])
            for at, name in enumerate(_QUANTITIES)
        }
        return xr.Dataset(parts, {"time": self.skies.times[steps]})

    def load(self, grid: ViewGrid, number: int) -> TransferMatrix:
        """Return the quantities of a position, a row for each of them and view.

        Values in the dark are 0.
        """
        point, effort, sun_samples = self._point(grid, number)

        def found(_key: str, *, effort: Effort, progress: Progress) -> TransferMatrix:
            glare = point.glare(point.cells(effort), effort, sun_samples=sun_samples)
            values = np.concatenate([glare[name].values for name in _QUANTITIES])
            return TransferMatrix(
                np.nan_to_num(values)[None],
                pixel_axis(len(values)),
                unknown_axis(values.shape[1]),
            )

        key = fingerprint(self._light, point.views, point.refinement, sun_samples)
        label = f"{position_label(grid, number)}-glare"
        return self.job.matrix(label, partial(found, key), effort)

    def plan(self, grid: ViewGrid) -> None:
        """Record the tracing of one position of a grid, with a usual cell count."""
        point, effort, sun_samples = self._point(grid, 0)
        point.matrices(point.cells(effort), self.skies, effort, sun_samples)

    def _point(
        self, grid: ViewGrid, number: int
    ) -> tuple[GlazedViewPoint, Effort, int]:
        # A position, with its numbers of paths per cell, and per cell and sun
        table = grid.table
        samples = table.samples or SAMPLES
        first = min(USUAL_LEVEL, int(np.log2(table.most_directions) // 2))
        refinement = Refinement(
            tolerance=table.tolerance, most=table.most_directions, first=first
        )
        views = tuple(grid.views(number))
        point = GlazedViewPoint(self.job.scene, views, self.skies, refinement)
        effort = position_effort(self.job, grid, number, samples=samples)
        return point, effort, table.sun_samples or SUN_SAMPLES

    @cached_property
    def _light(self) -> str:
        # Fingerprint of everything that all positions have in common
        whole, suns = self.skies.whole, self.skies.suns
        assert suns is not None
        normal = suns.direct_normal
        return fingerprint(
            self.job.scene_key,
            [whole.diffuse, whole.times.astype(np.int64), suns.directions],
            [normal.data, normal.indices, normal.indptr],
        )
