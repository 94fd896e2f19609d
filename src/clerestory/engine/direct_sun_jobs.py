"""Jobs of direct light from suns through a window, or from sky and suns through glass.

Coefficients are summed in floating point. No two units contain the same element of the
matrix, so the result does not depend on the order of units.
"""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float, Int

from clerestory.bsdf.bsdf import Bsdf
from clerestory.engine.channels import channels_of
from clerestory.engine.controller import EstimatedJob, traced_units
from clerestory.engine.effort import Effort
from clerestory.engine.sums import Sums
from clerestory.engine.work_units import Job, Unit, UnitSize, evenly_spaced
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Largest number of parallel paths (lanes) in one work unit
_LANES = 1 << 21


@dataclass(frozen=True, eq=False, kw_only=True)
class _DirectJob(Job):
    # Job with `samples` paths per pair of a sensor or pixel (row) and a source (column)

    samples: int

    @property
    def points(self) -> int:
        """Number of sample points in each batch."""
        return -(-self.samples // self.batches)

    @property
    def receivers(self) -> int:
        """Number of pairs of a sensor or pixel (row) and a source (column)."""
        return self.shape[0] * self.shape[2]

    def pilot_unit(self, paths: int) -> Unit:
        """Return a pilot unit of consecutive rows and evenly spaced columns."""
        rows, _, columns, _ = self.shape
        pairs = max(1, paths // (self.batches * self.points))
        few = evenly_spaced(columns, max(1, min(pairs, max(8, pairs // rows))))
        block = max(1, min(rows, pairs // max(1, len(few))))
        first = (rows - block) // 2
        return Unit(np.arange(first, first + block), 0, self.points, few)


@dataclass(frozen=True, eq=False, kw_only=True)
class _DirectSensorJob(_DirectJob, EstimatedJob):
    together: ClassVar[bool] = False

    sensors: Sensors

    @property
    @abstractmethod
    def lanes(self) -> int:
        """Number of lanes per sensor and column."""

    def empty_sums(self, rows: int) -> Sums:
        """Return zero sums, to which units add the means of batches."""
        return Sums.empty(float, (rows, *self.shape[1:]), 1 / self.points)

    def error(self, sums: Sums) -> float:
        """Return zero: convergence is not tested, as the number of paths is given."""
        return 0.0

    def units(
        self, rows: Int[np.ndarray, " row"], first: int, end: int, size: UnitSize
    ) -> Iterator[Unit]:
        """Divide the rows and columns of the matrix into work units."""
        del size
        columns = np.arange(self.shape[2])
        block = max(1, min(len(rows), _LANES // self.lanes))
        every = max(1, _LANES // (self.lanes * block))
        for row, column in _places(len(rows), len(columns), block, every):
            yield Unit(rows[row], first, end - first, columns[column])


@dataclass(frozen=True, eq=False, kw_only=True)
class SunlightJob(_DirectJob):
    """Sunlight transmitted by one of several windows, the window of index `number`.

    If `peak`, light transmitted without scattering keeps the angular diameter of the
    sun. `samples` is the number of paths per receiver and sun.
    """

    windows: tuple[Window, ...]
    number: int
    bsdf: Bsdf
    suns: Float[np.ndarray, "sun 3"]
    peak: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class SunJob(SunlightJob, _DirectSensorJob):
    """Irradiance of sensors per direct normal irradiance of suns behind a window."""

    tracer: ClassVar[tuple[str, str]] = ("direct_sun_tracer", "prepare_sun")

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of sensors, batches, suns and channels (one for a grey BSDF)."""
        colour = self.bsdf.in_colour("transmission_front")
        channels = len(self.scene.bands) if colour else 1
        return len(self.sensors), self.batches, len(self.suns), channels

    @property
    def lanes(self) -> int:
        """Number of lanes per sensor and column: one per batch."""
        return self.batches


@dataclass(frozen=True, eq=False, kw_only=True)
class UnscatteredJob(_DirectSensorJob):
    """Irradiance of sensors from distant sources, unobstructed or through glass.

    Each column has one source; `directions` are unit vectors to sample points of the
    source, batch by batch.
    """

    tracer: ClassVar[tuple[str, str]] = ("direct_visibility", "prepare_unscattered")

    directions: Float[np.ndarray, "column point 3"]

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of sensors, batches, sources and channels."""
        rows, columns = len(self.sensors), len(self.directions)
        return rows, self.batches, columns, channels_of(self.scene)

    @property
    def lanes(self) -> int:
        """Number of lanes per sensor and column: one per ray."""
        return self.samples


@dataclass(frozen=True, eq=False, kw_only=True)
class PixelSunJob(SunlightJob):
    """Radiance of columns × rows pixels per direct normal irradiance of suns [1/sr]."""

    tracer: ClassVar[tuple[str, str]] = ("direct_sun_tracer", "prepare_pixel_sun")

    view: View
    columns: int
    rows: int

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of pixels, batches, suns and bands."""
        pixels, bands = self.columns * self.rows, len(self.scene.bands)
        return pixels, self.batches, len(self.suns), bands


def trace_pixel_sun(
    job: PixelSunJob, numbers: Int[np.ndarray, " sun"], effort: Effort
) -> Float[np.ndarray, "batch band pixel sun"]:
    """Return the radiance of pixels per direct normal irradiance of each sun [1/sr].

    Each batch is an independent estimate. `numbers` selects suns of the job by index;
    the index also seeds the random numbers. Calls with the same job should pass the
    same executor, so that the scene is built only once.
    """
    pixels, batches, _, bands = job.shape
    count, samples = len(numbers), job.batches * job.points
    values = np.zeros((batches, bands, pixels, count), np.float32)
    every = max(1, min(count, _LANES // samples))
    block = max(1, _LANES // (samples * every))
    places = _places(pixels, count, block, every)
    pixel = np.arange(pixels)
    units = [Unit(pixel[row], 0, job.points, numbers[sun]) for row, sun in places]
    traced = traced_units(job, units, effort, f"{count} suns")
    for (row, sun), (_, part) in zip(places, traced, strict=True):
        values[:, :, row, sun] = part.transpose(1, 3, 0, 2)
    return values


def _places(
    rows: int, columns: int, block: int, every: int
) -> list[tuple[slice, slice]]:
    return [
        (slice(at, min(at + block, rows)), slice(first, min(first + every, columns)))
        for first in range(0, columns, every)
        for at in range(0, rows, block)
    ]
