"""Direct light of the windows on pixels: V_d, and C_ds S_sun as a sparse product.

    V_d          pixels × interior patches
    C_ds S_sun   pixels × time steps

What a pixel sees of the windows, directly or by one reflection, depends neither on the
sun nor on the shade. Its paths are traced once and recorded; V_d is the sum of their
weights by patch, and the radiance in sunlight is their product with a table of the
window's radiance for each sun and shade state. Both thus share the random error of the
paths, which largely cancels in C_ds S_sun − V_d T D_d S_ds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Unpack

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.engine import device as devices
from clerestory.engine.effort import Effort, EffortKeywords
from clerestory.engine.window_path_jobs import (
    PixelWindowPaths,
    Records,
    SensorWindowPaths,
    WindowPathsJob,
    record_window_paths,
)
from clerestory.image.camera import PixelsOrCells
from clerestory.matrix.axis import pixel_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import sun_effort
from clerestory.phases.exit_cells import ExitCells
from clerestory.phases.traced_matrices import require_distinct
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window
from clerestory.scene.window_zones import STRAIGHT, WindowZones

# Default numbers of paths per pixel and sensor, with three directions to the windows
PIXEL_SAMPLES, SENSOR_SAMPLES = 16, 1024

# Number of batches of paths per pixel
_BATCHES = 2

# Pixels per block of V_d: sums are in double precision
_PIXELS = 1 << 16


def picture_window_paths(
    scene: Scene,
    windows: Sequence[Window],
    camera: PixelsOrCells,
    **keywords: Unpack[EffortKeywords],
) -> "WindowPaths":
    """Trace the paths from the pixels of a picture to all windows.

    `samples` is the number of paths per pixel.
    """
    require_distinct(windows)
    effort = sun_effort(picture_window_paths, keywords, samples=PIXEL_SAMPLES)
    job = PixelWindowPaths(
        scene=scene,
        windows=tuple(windows),
        camera=camera,
        samples=effort.samples or PIXEL_SAMPLES,
        **effort.job_options(_BATCHES),
    )
    return _recorded(job, effort)


def sensor_window_paths(
    scene: Scene,
    windows: Sequence[Window],
    sensors: Sensors,
    **keywords: Unpack[EffortKeywords],
) -> "WindowPaths":
    """Trace the straight paths from sensors to all windows.

    `samples` is the number of paths per sensor.
    """
    require_distinct(windows)
    effort = sun_effort(sensor_window_paths, keywords, samples=SENSOR_SAMPLES)
    job = SensorWindowPaths(
        scene=scene,
        windows=tuple(windows),
        sensors=sensors,
        samples=effort.samples or SENSOR_SAMPLES,
        **effort.job_options(),
    )
    return _recorded(job, effort)


def _recorded(job: WindowPathsJob, effort: Effort) -> "WindowPaths":
    if effort.executor.accepts(job, effort.goal):
        return WindowPaths(job, tuple(record_window_paths(job, effort, "paths")))
    starts, codes = np.zeros(job.receivers + 1, int), np.zeros(0, np.uint32)
    weights = np.zeros((1, 0), np.float32)
    none = Records(starts, codes, codes.astype(np.uint16), weights)
    return WindowPaths(job, (none,) * job.batches, traced=False)


@dataclass(frozen=True, eq=False)
class WindowPaths:
    """Recorded paths from pixels or sensors to windows, by batch.

    `traced` is false in a dry run, in which there are none.
    """

    job: WindowPathsJob
    records: tuple[Records, ...]
    traced: bool = True
    _products: dict[tuple[int, object], Any] = field(default_factory=dict)
    _tracers: dict[tuple[int, Scene], Any] = field(default_factory=dict)

    __repr__ = brief

    def engine(self, module: str) -> Any:
        """Return a module of the engine, on the device of this machine.

        Workers of a cluster may have a GPU where this machine has none.
        """
        return devices.load("cpu" if self.job.device == "cpu" else "auto", module)

    @cached_property
    def zones(self) -> WindowZones:
        """Zones of the windows."""
        return WindowZones.of(self.job.windows)

    def view_matrices(
        self, kind: type[np.floating] = np.float32
    ) -> dict[str, TransferMatrix]:
        """Return V_d, by window name, with errors of a `kind` of numbers."""
        pixels, bands, found = self.job.receivers, self.job.scene.bands, {}
        for number, window in enumerate(self.job.windows):
            cells = ExitCells.of_partition(window.partition)
            own = self.zones.of_window(number)
            shape = len(self.records[0].weights), pixels, len(window.partition)
            values, error = np.zeros(shape, np.float32), np.zeros((1, *shape), kind)
            for first in range(0, pixels, _PIXELS):
                rows = slice(first, min(first + _PIXELS, pixels))
                one, other = (
                    _by_patch(each, rows, own, cells) for each in self.records
                )
                values[:, rows], error[0, :, rows] = (
                    (one + other) / 2,
                    (one - other) / 2,
                )
            axis = window_axis("interior", window.partition, window.name)
            found[window.name] = TransferMatrix(
                values, pixel_axis(pixels), axis, error, bands
            )
        return found

    def product(self, number: int, cells: ExitCells) -> Any:
        """Return the paths to a window on the compute device, by exit cell."""
        key = number, cells.key
        if key not in self._products:
            engine: Any = self.engine("path_product")
            zones = self.zones.of_window(number)
            self._products[key] = engine.PathProduct(
                self.records, zones, cells.find, len(cells.sizes)
            )
        return self._products[key]

    def beam_tracer(self, number: int, scene: Scene) -> Any:
        """Return the tracer of narrow beams through a window.

        `scene` contains what shades the window outside.
        """
        key = number, scene
        if key not in self._tracers:
            engine: Any = self.engine("beam_tracer")
            job = replace(self.job, scene=scene)
            self._tracers[key] = engine.BeamTracer(job, number)
        return self._tracers[key]


def _by_patch(
    records: Records,
    rows: slice,
    zones: slice,
    cells: ExitCells,
) -> Float[np.ndarray, "channel pixel patch"]:
    # Sum of the weights by pixel and patch of a window
    starts = records.starts[rows.start : rows.stop + 1]
    part = slice(starts[0], starts[-1])
    count, patches = rows.stop - rows.start, len(cells.sizes)
    zone = records.zones[part] & np.uint16(STRAIGHT - 1)
    inside = (zone >= zones.start) & (zone < zones.stop)
    pixel = np.repeat(np.arange(count), np.diff(starts))[inside]
    place = pixel * patches + cells.find(records.directions[part][inside])
    sums = [
        np.bincount(place, weights[part][inside], count * patches)
        for weights in records.weights
    ]
    return np.reshape(sums, (len(sums), count, patches)).astype(float)
