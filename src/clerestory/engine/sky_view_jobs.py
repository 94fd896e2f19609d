"""Jobs of the radiance of pixels and cells due to sky patches and suns, through glass.

    C, C_d   pixels × sky patches   SkyViewJob
    C_ds     pixels × suns          SunViewJob

The glazing is part of the scene, with its materials.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float, Float32

from clerestory.engine.controller import traced_units
from clerestory.engine.effort import Effort
from clerestory.engine.matrix_jobs import MatrixJob, mean_error
from clerestory.engine.sums import Sums
from clerestory.engine.work_units import Job, Unit, evenly_spaced
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.image.camera import PixelsOrCells

# Largest number of paths of a unit
_PATHS = 1 << 21

# Least number of suns of a pilot unit
_FEW = 8


@dataclass(frozen=True, eq=False, kw_only=True)
class SkyViewJob(MatrixJob):
    """Radiance of pixels or cells per radiance of sky patches.

    There are two columns for each patch: first those of direct light, which is
    scattered once or never, then those of all other light.
    """

    tracer: ClassVar[tuple[str, str]] = ("sky_view_tracers", "prepare_sky_view")
    together: ClassVar[bool] = False

    camera: PixelsOrCells
    sky: SkyPartition

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of pixels, and of columns: two for each patch."""
        return len(self.camera), 2 * len(self.sky)

    def error(self, sums: Sums) -> float:
        """RMS error of pixels under a uniform sky, relative to the mean."""
        return mean_error(sums.collected(), axis=1)


@dataclass(frozen=True, eq=False, kw_only=True)
class SunViewJob(Job):
    """Radiance of pixels or cells per direct normal irradiance of suns [1/sr].

    `samples` is the number of paths per pixel and sun; `indirect` is whether the paths
    start with a bounce at a surface, so that the BSDF of a proxy scatters them, and not
    its geometry.
    """

    tracer: ClassVar[tuple[str, str]] = ("sky_view_tracers", "prepare_sun_view")

    camera: PixelsOrCells
    suns: Float[np.ndarray, "sun 3"]
    samples: int
    indirect: bool = False

    @property
    def points(self) -> int:
        """Number of sample points in each batch."""
        return -(-self.samples // self.batches)

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of pixels, batches, suns and bands."""
        return len(self.camera), self.batches, len(self.suns), len(self.scene.bands)

    @property
    def receivers(self) -> int:
        """Number of pairs of a pixel and a sun."""
        return len(self.camera) * len(self.suns)

    def pilot_unit(self, paths: int) -> Unit:
        """Return a pilot unit of evenly spaced pixels and suns."""
        pairs = max(1, paths // (self.batches * self.points))
        suns = evenly_spaced(len(self.suns), max(1, min(pairs, _FEW)))
        pixels = evenly_spaced(len(self.camera), max(1, pairs // max(1, len(suns))))
        return Unit(pixels, 0, self.points, suns)

    def units(self) -> Iterator[Unit]:
        """Divide the pixels into units of all suns, or of some of them."""
        each = self.batches * self.points
        suns = np.arange(len(self.suns))
        every = max(1, min(len(suns), _PATHS // each))
        block = max(1, _PATHS // (each * every))
        for row in range(0, len(self.camera), block):
            rows = np.arange(row, min(row + block, len(self.camera)))
            for first in range(0, len(suns), every):
                yield Unit(rows, 0, self.points, suns[first : first + every])


def trace_sun_view(
    job: SunViewJob, effort: Effort
) -> Float32[np.ndarray, "batch band pixel sun"]:
    """Return the radiance of pixels per direct normal irradiance, for each batch."""
    pixels, batches, suns, bands = job.shape
    values = np.zeros((batches, bands, pixels, suns), np.float32)
    if not effort.executor.accepts(job, effort.goal):
        return values
    for unit, part in traced_units(job, list(job.units()), effort, "direct sun"):
        found = np.moveaxis(part, (1, 3), (0, 1))
        values[:, :, unit.rows[0] : unit.rows[-1] + 1, unit.columns] = found
    return values
