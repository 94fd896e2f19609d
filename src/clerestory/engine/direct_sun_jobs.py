"""Jobs of direct sun through a window: to sensors, and to the pixels of a view.

Coefficients are floating-point; every unit has rows and suns of its own, so that the
order of units changes nothing.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float, Int

from clerestory.bsdf.bsdf import Bsdf
from clerestory.engine.controller import EstimatedJob, trace_units
from clerestory.engine.effort import Effort
from clerestory.engine.sums import Sums
from clerestory.engine.work_units import Job, Unit, UnitSize, evenly_spaced
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Most lanes in one unit
_LANES = 1 << 21


@dataclass(frozen=True, eq=False, kw_only=True)
class _SunJob(Job):
    # Suns through one of the windows, `number`. `peak`: whether light that its BSDF
    # transmits without scattering stays as sharp as the sun; `samples`: paths per
    # receiver and sun
    windows: tuple[Window, ...]
    number: int
    bsdf: Bsdf
    suns: Float[np.ndarray, "sun 3"]
    peak: bool
    samples: int

    @property
    def points(self) -> int:
        """Sample points of a batch."""
        return -(-self.samples // self.batches)

    @property
    def receivers(self) -> int:
        """Pairs of a row and a sun."""
        return self.shape[0] * self.shape[2]

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of consecutive rows and some suns of the whole year."""
        rows, _, suns, _ = self.shape
        pairs = max(1, paths // (self.batches * self.points))
        few = evenly_spaced(suns, max(1, min(8, pairs)))
        block = max(1, min(rows, pairs // max(1, len(few))))
        first = (rows - block) // 2
        return Unit(np.arange(first, first + block), 0, self.points, few)


@dataclass(frozen=True, eq=False, kw_only=True)
class SunJob(_SunJob, EstimatedJob):
    """Irradiance of sensors per direct normal irradiance of suns behind a window.

    Attributes
    ----------
    number : of the window that light comes through, among all
    peak : whether light that its BSDF transmits without scattering stays as sharp as
        the sun
    samples : paths per sensor and sun
    """

    tracer: ClassVar[tuple[str, str]] = ("direct_sun_tracer", "prepare_sun")
    together: ClassVar[bool] = False

    sensors: Sensors

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Sensors, batches, suns and channels."""
        channels = 3 if self.bsdf.in_colour("transmission_front") else 1
        return len(self.sensors), self.batches, len(self.suns), channels

    def empty_sums(self, rows: int) -> Sums:
        """Return sums of batch means."""
        return Sums.floating((rows, *self.shape[1:]), 1 / self.points)

    def error(self, sums: Sums) -> float:
        """Zero: the number of paths is given."""
        return 0.0

    def units(
        self, rows: Int[np.ndarray, " row"], first: int, end: int, size: UnitSize
    ) -> Iterator[Unit]:
        """Cut rows and suns into units."""
        del size  # a lane follows all paths of a batch
        block = max(1, min(len(rows), _LANES // self.batches))
        every = max(1, _LANES // (self.batches * block))
        suns = np.arange(len(self.suns))
        for row, sun in _places(len(rows), len(suns), block, every):
            yield Unit(rows[row], first, end - first, suns[sun])


@dataclass(frozen=True, eq=False, kw_only=True)
class PixelSunJob(_SunJob):
    """Radiance of a view's pixels per direct normal irradiance of suns.

    Attributes
    ----------
    columns, rows : size of the picture
    samples : paths per pixel and sun
    """

    tracer: ClassVar[tuple[str, str]] = ("direct_sun_pixels", "prepare_pixel_sun")

    view: View
    columns: int
    rows: int
    batches: int = 1

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Pixels, one batch, suns and RGB."""
        return self.columns * self.rows, 1, len(self.suns), 3


def trace_pixel_sun(
    job: PixelSunJob, numbers: Int[np.ndarray, " sun"], effort: Effort
) -> Float[np.ndarray, "channel pixel sun"]:
    """Radiance of pixels per direct normal irradiance of each sun [1/sr].

    Parameters
    ----------
    numbers : of suns of the job, which their random numbers depend on
    effort : with the same executor for all calls with one job, so that its scene is
        built once
    """
    pixels, count = job.shape[0], len(numbers)
    values = np.zeros((3, pixels, count), np.float32)
    every = max(1, min(count, _LANES // job.samples))
    block = max(1, _LANES // (job.samples * every))
    places = _places(pixels, count, block, every)
    units = [
        Unit(np.arange(row.start, row.stop), 0, job.samples, numbers[sun])
        for row, sun in places
    ]
    remaining = iter(places)

    def add(_unit: Unit, part: np.ndarray) -> None:
        row, sun = next(remaining)
        values[:, row, sun] = part

    trace_units(job, units, effort, add, f"{count} suns")
    return values


def _places(rows: int, suns: int, block: int, every: int) -> list[tuple[slice, slice]]:
    # Some rows and some suns each, all together the whole
    return [
        (slice(at, min(at + block, rows)), slice(first, min(first + every, suns)))
        for first in range(0, suns, every)
        for at in range(0, rows, block)
    ]
