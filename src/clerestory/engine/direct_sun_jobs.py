"""Jobs for direct sun through a window: to sensors, and to the pixels of a view.

Coefficients are floating-point; every unit has rows and suns of its own, so there is
nothing to add up.
"""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from jaxtyping import Float, Int

from clerestory.bsdf.bsdf import Bsdf
from clerestory.engine.channels import channels_of
from clerestory.engine.work_units import Executor, Goal, Local, Unit, evenly_spaced
from clerestory.progress import Progress
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Independent batches of each coefficient of a sensor
BATCHES = 16

# Most lanes in one unit
_LANES = 1 << 21


@dataclass(frozen=True, eq=False)
class SunJob:
    """Irradiance of sensors per direct normal irradiance of suns behind a window.

    Attributes
    ----------
    number : of the window that light comes through, among all
    peak : whether what its BSDF passes straight stays as sharp as the sun
    samples : paths per sensor and sun
    """

    tracer: ClassVar[tuple[str, str]] = ("direct_sun_tracer", "prepare_sun")
    batches: ClassVar[int] = BATCHES

    scene: Scene
    windows: tuple[Window, ...]
    number: int
    bsdf: Bsdf
    sensors: Sensors
    suns: Float[np.ndarray, "sun 3"]
    peak: bool
    samples: int
    seed: int
    device: Literal["cpu", "cuda"]

    @property
    def points(self) -> int:
        """Sample points of a batch."""
        return max(1, -(-self.samples // BATCHES))

    @property
    def columns(self) -> int:
        """Number of suns."""
        return len(self.suns)

    @property
    def channels(self) -> int:
        """One for a grey BSDF, else three."""
        return 3 if self.bsdf.in_colour("transmission_front") else 1

    @property
    def lanes(self) -> int:
        """Lanes of a sensor and a sun; each takes all points of a batch."""
        return BATCHES

    @property
    def receivers(self) -> int:
        """Pairs of a sensor and a sun."""
        return len(self.sensors) * len(self.suns)

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of some sensors and suns."""
        pairs = max(1, paths // (BATCHES * self.points))
        return _trial(len(self.sensors), len(self.suns), pairs, self.points)


@dataclass(frozen=True, eq=False)
class UnscatteredJob:
    """Irradiance of sensors from far away that glass at most passes.

    Attributes
    ----------
    directions : sample points of each column, batch by batch, to where light comes from
    """

    tracer: ClassVar[tuple[str, str]] = ("direct_visibility", "prepare_unscattered")
    batches: ClassVar[int] = BATCHES

    scene: Scene
    sensors: Sensors
    directions: Float[np.ndarray, "column point 3"]
    device: Literal["cpu", "cuda"]

    @property
    def samples(self) -> int:
        """Rays of a sensor and a column."""
        return int(self.directions.shape[1])

    @property
    def points(self) -> int:
        """Sample points of a batch."""
        return self.samples // BATCHES

    @property
    def columns(self) -> int:
        """Number of columns, such as suns or patches."""
        return len(self.directions)

    @property
    def channels(self) -> int:
        """One in a grey scene, else one per band."""
        return channels_of(self.scene)

    @property
    def lanes(self) -> int:
        """Lanes of a sensor and a column: one for each ray."""
        return self.samples

    @property
    def receivers(self) -> int:
        """Pairs of a sensor and a column."""
        return len(self.sensors) * self.columns

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of some sensors and columns."""
        pairs = max(1, paths // self.samples)
        return _trial(len(self.sensors), self.columns, pairs, self.points)


@dataclass(frozen=True, eq=False)
class PixelSunJob:
    """Radiance of a view's pixels per direct normal irradiance of suns.

    Attributes
    ----------
    columns, rows : size of the picture
    samples : paths per pixel and sun
    """

    tracer: ClassVar[tuple[str, str]] = ("direct_sun_pixels", "prepare_pixel_sun")
    batches: ClassVar[int] = 1

    scene: Scene
    windows: tuple[Window, ...]
    number: int
    bsdf: Bsdf
    view: View
    columns: int
    rows: int
    suns: Float[np.ndarray, "sun 3"]
    peak: bool
    samples: int
    seed: int
    device: Literal["cpu", "cuda"]

    @property
    def receivers(self) -> int:
        """Pairs of a pixel and a sun."""
        return self.columns * self.rows * len(self.suns)

    def pilot_unit(self, paths: int) -> Unit:
        """Return a unit of some pixels and suns."""
        pairs = max(1, paths // self.samples)
        pixels = self.columns * self.rows
        return _trial(pixels, len(self.suns), pairs, self.samples)


@dataclass(frozen=True, eq=False)
class SunEstimate:
    """Direct-sun coefficients.

    Attributes
    ----------
    values : irradiance per direct normal irradiance
    components : error components; the sum of their squares is the variance
    """

    values: Float[np.ndarray, "channel row sun"]
    components: Float[np.ndarray, "component channel row sun"]


def trace_sun(
    job: SunJob | UnscatteredJob,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> SunEstimate:
    """Trace direct light to sensors, through one window or through glass at most."""
    rows, count, channels = len(job.sensors), job.columns, job.channels
    executor = executor or Local()
    if not executor.accepts(job, Goal(job.samples)):
        nothing = np.broadcast_to(0.0, (channels, rows, count))
        none = np.broadcast_to(np.float32(0), (BATCHES, *nothing.shape))
        return SunEstimate(nothing, none)
    values = np.zeros((channels, rows, count))
    components = np.zeros((BATCHES, channels, rows, count), dtype=np.float32)
    block = max(1, min(rows, _LANES // job.lanes))
    places = _places(rows, count, block, max(1, _LANES // (job.lanes * block)))
    units = [_unit(place, job.points, np.arange(count)) for place in places]
    traced, done = executor.map(job, units), 0
    for (row, sun), part in zip(places, traced, strict=True):
        found = part[:, :, :, :channels]
        mean = found.mean(axis=2)
        spread = (found - mean[:, :, None]) / np.sqrt(BATCHES * (BATCHES - 1))
        values[:, row, sun] = mean.transpose(2, 0, 1)
        components[:, :, row, sun] = spread.transpose(2, 3, 0, 1)
        done += found.shape[0] * found.shape[1]
        if progress is not None:
            progress(done / (rows * count), f"{sun.stop} of {count} suns")
    return SunEstimate(values, components)


def trace_pixel_sun(
    job: PixelSunJob,
    numbers: Int[np.ndarray, " sun"],
    *,
    executor: Executor,
    progress: Progress | None = None,
) -> Float[np.ndarray, "channel pixel sun"]:
    """Radiance of pixels per direct normal irradiance of each sun [1/sr].

    Parameters
    ----------
    numbers : of suns of the job, which their random numbers depend on
    executor : the same for all calls with one job, so that its scene is built once
    """
    pixels, count = job.columns * job.rows, len(numbers)
    values = np.zeros((len(job.scene.bands), pixels, count), np.float32)
    every = max(1, min(count, _LANES // job.samples))
    block = max(1, _LANES // (job.samples * every))
    places = _places(pixels, count, block, every)
    units = [_unit(place, job.samples, numbers) for place in places]
    done = 0
    for (row, sun), part in zip(places, executor.map(job, units), strict=True):
        values[:, row, sun] = np.moveaxis(part, -1, 0)
        done += part[..., 0].size
        if progress is not None:
            progress(done / values[0].size, f"{count} suns")
    return values


def _places(rows: int, suns: int, block: int, every: int) -> list[tuple[slice, slice]]:
    # Some rows and some suns each, all together the whole
    return [
        (slice(at, min(at + block, rows)), slice(first, min(first + every, suns)))
        for first in range(0, suns, every)
        for at in range(0, rows, block)
    ]


def _unit(
    place: tuple[slice, slice], count: int, numbers: Int[np.ndarray, " sun"]
) -> Unit:
    row, sun = place
    return Unit(np.arange(row.start, row.stop), 0, count, numbers[sun])


def _trial(rows: int, suns: int, pairs: int, count: int) -> Unit:
    # Some suns of the whole year, and consecutive rows
    few = evenly_spaced(suns, max(1, min(8, pairs)))
    block = max(1, min(rows, pairs // max(1, len(few))))
    first = (rows - block) // 2
    return Unit(np.arange(first, first + block), 0, count, few)
