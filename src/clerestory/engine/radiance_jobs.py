"""Jobs of radiance and irradiance at one instant: pictures, sensors, window emitters.

Radiance has no upper limit, so sums are floating-point numbers; they are added in the
order of the units, whose size does not depend on the machine.
"""

import math
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.batch_lengths import Growth
from clerestory.engine.controller import EstimatedJob, sum_rows
from clerestory.engine.effort import Effort
from clerestory.engine.matrix_jobs import mean_error, row_errors
from clerestory.engine.sums import Sums
from clerestory.engine.work_units import Unit, UnitSize
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

# Default number of independent batches per pixel or direction
PICTURE_BATCHES = 8


@dataclass(frozen=True, eq=False)
class RadianceEstimate:
    """Estimated radiance or irradiance, with the standard error of each value.

    `photometric_error` is that of luminance or illuminance; zero for bands of unknown
    luminous efficacy. `reached` tells whether the target relative error was reached.
    """

    value: Float[np.ndarray, "row band"]
    error: Float[np.ndarray, "row band"]
    photometric_error: Float[np.ndarray, " row"]
    paths: int
    reached: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class RadianceJob(EstimatedJob):
    """A job whose rows are radiances or irradiances in the bands of the scene."""

    together: ClassVar[bool] = True
    growth: ClassVar[Growth] = Growth(pilot=8, longest=1 << 20, most=16)
    cut: ClassVar[UnitSize | None] = UnitSize(paths=1 << 21, sums=1 << 40)

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of rows, batches, columns (one) and bands."""
        return self.receivers, self.batches, 1, len(self.scene.bands)

    def empty_sums(self, rows: int) -> Sums:
        """Return floating-point sums."""
        return Sums.empty(float, (rows, *self.shape[1:]), 1.0)

    def error(self, sums: Sums) -> float | Float[np.ndarray, " row"]:
        """Root mean square error of the rows, relative to the mean of all rows."""
        return mean_error(sums.collected(), axis=1)

    def pilot_unit(self, paths: int) -> Unit:
        """Return a pilot unit of consecutive rows around the middle row."""
        # As many rows as the paths allow; longer batches only if all rows fit
        rows, shortest = self.shape[0], self.growth.pilot
        block = max(1, min(rows, paths // (self.batches * shortest)))
        first = (rows - block) // 2
        count = paths // (self.batches * block)
        count = int(np.clip(count, 1, self.growth.longest))
        return Unit(np.arange(first, first + block), 0, count)


@dataclass(frozen=True, eq=False, kw_only=True)
class PictureJob(RadianceJob):
    """Radiance of a view's pixels, or irradiance of the visible surfaces.

    The pixels are ordered row by row from the top.
    """

    tracer: ClassVar[tuple[str, str]] = ("radiance_tracers", "prepare_picture")
    growth: ClassVar[Growth] = Growth(pilot=4, longest=1 << 20, most=16)

    view: View
    columns: int
    rows: int
    quantity: Literal["radiance", "irradiance"] = "radiance"

    @property
    def receivers(self) -> int:
        """Number of pixels."""
        return self.columns * self.rows


@dataclass(frozen=True, eq=False, kw_only=True)
class IrradianceJob(RadianceJob):
    """Irradiance of sensors."""

    tracer: ClassVar[tuple[str, str]] = ("radiance_tracers", "prepare_irradiance")

    sensors: Sensors

    @property
    def receivers(self) -> int:
        """Number of sensors."""
        return len(self.sensors)

    def error(self, sums: Sums) -> Float[np.ndarray, " row"]:
        """Relative error of each sensor."""
        return row_errors(sums)


@dataclass(frozen=True, eq=False)
class EmitterPatches:
    """Flat surface patches, each cut into triangles.

    The rows of `frame` are two axes in the plane of a patch, and the normal. `first` is
    the index of each patch's first triangle, followed by the number of triangles;
    `cumulative` is the cumulative area fraction of the triangles within each patch.
    """

    frame: Float[np.ndarray, "patch 3 3"]
    corner: Float[np.ndarray, "triangle 3 3"]
    first: Int[np.ndarray, " patches_and_end"]
    cumulative: Float[np.ndarray, " triangle"]

    def scaled(self, factor: float) -> "EmitterPatches":
        """Return the patches with all lengths multiplied."""
        return replace(self, corner=self.corner * factor)


@dataclass(frozen=True, eq=False, kw_only=True)
class ExitingRadianceJob(RadianceJob):
    """Mean exiting radiance of surface patches, by rings and sectors of directions.

    Suns seen straight through a patch are excluded.
    """

    tracer: ClassVar[tuple[str, str]] = ("radiance_tracers", "prepare_outgoing")

    patches: EmitterPatches
    rings: int
    sectors: int

    @property
    def receivers(self) -> int:
        """Number of patches times number of direction cells (rings × sectors)."""
        return len(self.patches.frame) * self.rings * self.sectors


def estimate_radiance(job: RadianceJob, effort: Effort) -> RadianceEstimate:
    """Estimate radiance or irradiance up to a number of samples or a target error."""
    if not effort.executor.accepts(job, effort.goal):
        return black(job)
    sums, reached = sum_rows(job, slice(0, job.shape[0]), effort)
    return radiance_of(job, sums, reached=reached)


def black(job: RadianceJob) -> RadianceEstimate:
    """Return the result of a job that is not traced."""
    rows, _, _, bands = job.shape
    nothing = np.zeros((rows, bands))
    return RadianceEstimate(nothing, nothing, nothing[:, 0], 0, True)


def radiance_of(job: RadianceJob, sums: Sums, *, reached: bool) -> RadianceEstimate:
    """Return radiance or irradiance, and standard errors, from sums over batches."""
    batches = sums.total[:, :, 0] / sums.count[:, None, None]
    known = job.scene.bands.efficacy is not None
    luminous = (
        job.scene.bands.photometric(batches)
        if known
        else np.zeros_like(batches[..., 0])
    )
    error, photometric_error = (
        each.std(axis=1, ddof=1) / math.sqrt(job.batches)
        for each in (batches, luminous)
    )
    paths = int(sums.count.sum()) * job.batches
    return RadianceEstimate(
        batches.mean(axis=1), error, photometric_error, paths, reached
    )
