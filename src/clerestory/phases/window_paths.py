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
from functools import cached_property, lru_cache
from typing import Any, Unpack

import numpy as np
from jaxtyping import Float, Float32, Int, UInt32
from scipy.sparse import csc_array

from clerestory.bands import RGB
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.checks import require
from clerestory.engine import device as devices
from clerestory.engine.effort import Effort, EffortKeywords
from clerestory.engine.window_path_jobs import (
    PixelWindowPaths,
    Records,
    SensorWindowPaths,
    WindowPathsJob,
    record_window_paths,
)
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import cell_centres, directions_from_square
from clerestory.matrix.axis import pixel_axis, sun_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.camera import Camera
from clerestory.phases.sun_coefficients import sun_effort, window_number
from clerestory.phases.traced_matrices import require_distinct
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window
from clerestory.scene.window_zones import (
    CELLS,
    EDGE,
    WindowZones,
    cell_directions,
    zone_of,
)

# Default numbers of paths per pixel and sensor, with three directions to the windows
_SAMPLES, _SENSOR_SAMPLES = 16, 1024

# Number of points of a zone at which the transmittance from the sun is sampled
_ZONE_POINTS = 16

# Number of batches of paths per pixel
_BATCHES = 2

# Largest number of halvings of a grid of exit cells
_FINEST = 9

# Suns per block of C_ds
_SUNS = 64

# Pixels per block of V_d: sums are in double precision
_PIXELS = 1 << 16


def picture_window_paths(
    scene: Scene,
    windows: Sequence[Window],
    camera: Camera,
    **keywords: Unpack[EffortKeywords],
) -> "WindowPaths":
    """Trace the paths from the pixels of a picture to all windows.

    `samples` is the number of paths per pixel.
    """
    require_distinct(windows)
    effort = sun_effort(picture_window_paths, keywords, samples=_SAMPLES)
    job = PixelWindowPaths(
        scene=scene,
        windows=tuple(windows),
        view=camera.view,
        columns=camera.columns,
        rows=camera.rows,
        samples=effort.samples or _SAMPLES,
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
    effort = sun_effort(sensor_window_paths, keywords, samples=_SENSOR_SAMPLES)
    job = SensorWindowPaths(
        scene=scene,
        windows=tuple(windows),
        sensors=sensors,
        samples=effort.samples or _SENSOR_SAMPLES,
        **effort.job_options(),
    )
    return _recorded(job, effort)


def _recorded(job: WindowPathsJob, effort: Effort) -> "WindowPaths":
    if effort.executor.accepts(job, effort.goal):
        return WindowPaths(job, tuple(record_window_paths(job, effort, "paths")))
    nothing = np.zeros(job.receivers + 1, int), np.zeros(0, np.uint32)
    none = Records(*nothing, np.zeros((1, 0), np.float32))
    return WindowPaths(job, (none,) * job.batches)


@dataclass(frozen=True, eq=False)
class WindowPaths:
    """Recorded paths from pixels or sensors to windows, by batch."""

    job: WindowPathsJob
    records: tuple[Records, ...]
    _products: dict[tuple[int, object], Any] = field(default_factory=dict)

    @cached_property
    def zones(self) -> WindowZones:
        """Zones of the windows."""
        return WindowZones.of(self.job.windows)

    def view_matrices(
        self, kind: type[np.floating] = np.float32
    ) -> dict[str, TransferMatrix]:
        """Return V_d, by window name, of floating-point numbers of a `kind`."""
        pixels, bands, found = self.job.receivers, self.job.scene.bands, {}
        for number, window in enumerate(self.job.windows):
            patch = window.partition.find(cell_directions())
            own = self.zones.of_window(number)
            shape = len(self.records[0].weights), pixels, len(window.partition)
            values, error = np.zeros(shape, kind), np.zeros((1, *shape), kind)
            for first in range(0, pixels, _PIXELS):
                rows = slice(first, min(first + _PIXELS, pixels))
                one, other = (
                    _by_patch(each, rows, own, patch, shape[2]) for each in self.records
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

    def sunlit(
        self,
        window: str,
        bsdf: Bsdf,
        *,
        suns: Float[np.ndarray, "sun 3"],
        peak: bool = False,
        scene: Scene | None = None,
    ) -> "SunlitPixels":
        """Return the pixels in sunlight from one window, in one shade state.

        `scene`, by default that of the paths, contains what shades the window outside.
        """
        number = window_number(self.job.windows, window, bsdf, suns)
        bands = self.job.scene.bands
        require(
            bands == RGB or not bsdf.in_colour("transmission_front"),
            f"the BSDF is in {RGB}, the scene in {bands}; a BSDF that is the same in"
            " all bands expected",
            file=bsdf.source,
        )
        return SunlitPixels(self, number, bsdf, suns, peak, scene or self.job.scene)

    def product(self, number: int, cells: "ExitCells") -> Any:
        """Return the paths to a window on the compute device, by exit cell."""
        key = number, cells.key
        if key not in self._products:
            engine: Any = devices.load(self.job.device, "path_product")
            zones = self.zones.of_window(number)
            self._products[key] = engine.PathProduct(
                self.records, zones, cells.number, len(cells.directions)
            )
        return self._products[key]


def _by_patch(
    records: Records,
    rows: slice,
    zones: slice,
    patch: Int[np.ndarray, " cell"],
    patches: int,
) -> Float[np.ndarray, "channel pixel patch"]:
    # Sum of the weights by pixel and patch of a window
    starts = records.starts[rows.start : rows.stop + 1]
    part = slice(starts[0], starts[-1])
    codes, count = records.codes[part], rows.stop - rows.start
    zone = zone_of(codes)
    inside = (zone >= zones.start) & (zone < zones.stop)
    pixel = np.repeat(np.arange(count), np.diff(starts))[inside]
    place = pixel * patches + patch[codes[inside] & (CELLS - 1)]
    sums = [
        np.bincount(place, weights[part][inside], count * patches)
        for weights in records.weights
    ]
    return np.reshape(sums, (len(sums), count, patches))


@dataclass(frozen=True, eq=False)
class ExitCells:
    """Cells of exit directions in which a BSDF is constant, or nearly so.

    Attributes
    ----------
    key : partition, or the number of halvings of a tensor tree
    number : cell of each cell of a code; see `scene.window_zones`
    directions : representative directions, in the window's frame
    corners : low corners of cells of a square grid; None for other cells
    """

    key: object
    number: UInt32[np.ndarray, " code"]
    directions: Float[np.ndarray, "cell 3"]
    corners: Float[np.ndarray, "cell 2"] | None = None

    @classmethod
    def of(cls, bsdf: Bsdf) -> "ExitCells":
        """Return the exit cells of the transmission towards the room."""
        part = bsdf.scattering("transmission_front")
        tree = _tree(part)
        if tree is None:
            first = bsdf.function("transmission_front").exits
            return _patches_of(first)
        # Rank 3 trees turn with the azimuth of the sun: cells half as large follow them
        return _halved(min(tree.depth + (tree.rank == 3), _FINEST))


def _tree(part: ScatteringFunction) -> ScatteringTree | None:
    if isinstance(part, ScatteringTree):
        return part
    if isinstance(part, ScatteringMatrix):
        return None
    return _tree(part.reciprocal())


@lru_cache(maxsize=4)
def _patches_of(partition: RingPartition) -> ExitCells:
    number = partition.find(cell_directions()).astype(np.uint32)
    return ExitCells(partition, number, partition.centres())


@lru_cache(maxsize=4)
def _halved(halvings: int) -> ExitCells:
    row, column = np.divmod(np.arange(CELLS, dtype=np.uint32), np.uint32(EDGE))
    shift = np.uint32(EDGE.bit_length() - 1 - halvings)
    number = ((row >> shift) << np.uint32(halvings)) + (column >> shift)
    centres = cell_centres(halvings)
    corners = np.stack(centres, axis=-1) - 0.5 / (1 << halvings)
    return ExitCells(halvings, number, directions_from_square(*centres), corners)


@dataclass(frozen=True, eq=False)
class SunlitPixels:
    """Pixels in sunlight transmitted by one window in one shade state: C_ds S_sun.

    C_ds is pixel radiance per direct normal irradiance [1/sr], C_F-ds + C_R-ds in the
    notation of the extended five-phase method.
    """

    paths: WindowPaths
    window: int
    bsdf: Bsdf
    suns: Float[np.ndarray, "sun 3"]
    peak: bool
    scene: Scene
    _last: dict[tuple[bytes, ...], tuple[np.ndarray, np.ndarray]] = field(
        default_factory=dict
    )

    def received(
        self, normal: csc_array, weights: Float[np.ndarray, "out band"]
    ) -> tuple[
        Float32[np.ndarray, "out pixel step"], Float32[np.ndarray, "out pixel step"]
    ]:
        """Return the radiance under suns, weighted by band, and its error component.

        `normal` is the direct normal irradiance (sun × step), of at most one sun per
        step.
        """
        key = normal.indices.tobytes(), normal.data.tobytes(), weights.tobytes()
        if key not in self._last:
            self._last.clear()
            self._last[key] = self._received(normal, weights)
        return self._last[key]

    def _received(
        self, normal: csc_array, weights: Float[np.ndarray, "out band"]
    ) -> tuple[np.ndarray, np.ndarray]:
        steps, pixels = normal.shape[1], self.paths.job.receivers
        sun = np.full(steps, -1)
        coordinates = normal.tocoo()
        sun[coordinates.coords[1]] = coordinates.coords[0]
        lit = np.flatnonzero(sun >= 0)
        lit = lit[self._behind[sun[lit]]]
        found = np.zeros((2, len(weights), pixels, steps), np.float32)
        if len(lit) == 0 or not self._traced:
            return found[0], found[1]
        irradiance = np.asarray(normal.sum(axis=0)).ravel()[lit]
        one, other = self._batches(sun[lit], irradiance, weights)
        found[0][..., lit], found[1][..., lit] = (one + other) / 2, (one - other) / 2
        return found[0], found[1]

    @cached_property
    def _traced(self) -> bool:
        # Whether there are paths: not in a dry run
        return any(len(each.codes) for each in self.paths.records)

    @cached_property
    def _behind(self) -> np.ndarray:
        frame = self.paths.job.windows[self.window].frame
        return np.asarray(self.suns @ frame.normal < 0)

    def _batches(
        self,
        sun: np.ndarray,
        irradiance: np.ndarray,
        weights: Float[np.ndarray, "out band"],
    ) -> Float32[np.ndarray, "batch out pixel step"]:
        job = self.paths.job
        engine: Any = devices.load(job.device, "path_product")
        cells = ExitCells.of(self.bsdf)
        product = self.paths.product(self.window, cells)
        width = engine.padded(len(sun))
        extra = [(0, 0), (0, 0), (0, width - len(sun))]
        light = self._table.radiance(cells.directions, self.suns[sun])
        light *= irradiance.astype(np.float32)
        spread, beams = self._beams(cells, light, self.suns[sun], irradiance)
        light = np.pad(np.concatenate([spread, light], axis=1), extra)
        passed = np.pad(self._transmittance[..., sun], extra)
        sums = [
            [self._sum(product, batch, row, light, passed) for row in weights]
            for batch in range(len(product))
        ]
        for each in beams:
            self._beam_tracer.add(sums, weights, each, width)
        shape = len(sums), len(weights), job.receivers, width
        return np.array([[o.numpy() for o in b] for b in sums]).reshape(shape)[
            ..., : len(sun)
        ]

    def _sum(
        self,
        product: Any,
        batch: int,
        weights: Float[np.ndarray, " band"],
        light: Float32[np.ndarray, "channel cell step"],
        passed: Float32[np.ndarray, "channel zone step"],
    ) -> Any:
        # Scattered sunlight by pixel and step, on the compute device
        channels = len(self.paths.records[batch].weights)
        if len(light) == len(passed) == 1:
            share = weights if channels > 1 else weights.sum(keepdims=True)
            return product.received(batch, share, light[0], passed[0])
        total = 0.0
        for band, weight in enumerate(weights):
            if weight:
                share = np.zeros(channels)
                share[band % channels] = weight
                radiance, zones = light[band % len(light)], passed[band % len(passed)]
                total = product.received(batch, share, radiance, zones) + total
        return total

    @cached_property
    def _table(self) -> Any:
        engine: Any = devices.load(self.paths.job.device, "sun_tables")
        frame = self.paths.job.windows[self.window].frame
        return engine.SunlitBsdf(self.bsdf, frame, peak=self.peak)

    @cached_property
    def _transmittance(self) -> Float32[np.ndarray, "channel zone sun"]:
        window, job = self.paths.job.windows[self.window], self.paths.job
        engine: Any = devices.load(job.device, "sun_tables")
        points = self.paths.zones.points(self.window, window.polygons, _ZONE_POINTS)
        normal = window.frame.normal
        return np.asarray(
            engine.sun_transmittance(self.scene, points, normal, self.suns)
        )

    def _beams(
        self,
        cells: ExitCells,
        light: Float32[np.ndarray, "channel cell step"],
        suns: Float[np.ndarray, "step 3"],
        irradiance: Float[np.ndarray, " step"],
    ) -> tuple[Float32[np.ndarray, "channel cell step"], list[Any]]:
        # Radiance for light reflected by pixels, without narrow beams, and the beams
        engine: Any = devices.load(self.paths.job.device, "sun_beams")
        frame, found = self.paths.job.windows[self.window].frame, []
        if cells.corners is not None:
            narrow = engine.narrow_cells(light)
            if narrow.any():
                bright = np.where(narrow, light, 0)
                found.append(
                    engine.narrow_beams(
                        bright, cells.corners, suns, frame, seed=self.paths.job.seed
                    )
                )
                light = light - bright
        if self.peak:
            found.append(self._unscattered.of(suns, irradiance))
        return light, found

    @cached_property
    def _unscattered(self) -> Any:
        engine: Any = devices.load(self.paths.job.device, "sun_beams")
        frame = self.paths.job.windows[self.window].frame
        return engine.UnscatteredBeams(self.bsdf, frame)

    @cached_property
    def _beam_tracer(self) -> Any:
        job = self.paths.job
        engine: Any = devices.load(job.device, "beam_tracer")
        return engine.BeamTracer(replace(job, scene=self.scene), self.window)

    def coefficients(
        self, bands: int
    ) -> tuple[Float32[np.ndarray, "band row sun"], Float32[np.ndarray, "component band row sun"]]:
        """Return C_ds and its error components, in one band or in all of the scene."""
        job, weights = self.paths.job, np.eye(bands)
        shape = job.batches, bands, job.receivers, len(self.suns)
        found = np.zeros(shape, np.float32)
        lit = np.flatnonzero(self._behind)
        for first in range(0, len(lit) * self._traced, _SUNS):
            sun = lit[first : first + _SUNS]
            found[..., sun] = self._batches(sun, np.ones(len(sun)), weights)
        mean = found.mean(axis=0)
        found -= mean
        return mean, found / np.float32(np.sqrt(job.batches * (job.batches - 1)))


def picture_sun_coefficients(
    scene: Scene,
    windows: Sequence[Window],
    window: str,
    bsdf: Bsdf,
    camera: Camera,
    *,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Direct-sun coefficients of a picture [1/sr].

    Pixel radiance per direct normal irradiance: the sun seen through the window
    (C_F-ds) plus sunlight reflected once in the room (C_R-ds). See `sun_coefficients`
    for the parameters; `samples` is the number of paths per pixel, for all suns.
    """
    effort = sun_effort(picture_sun_coefficients, keywords, samples=_SAMPLES)
    paths = picture_window_paths(scene, windows, camera, effort=effort)
    lit = paths.sunlit(window, bsdf, suns=suns, peak=peak)
    values, parts = lit.coefficients(len(scene.bands))
    axes = pixel_axis(len(camera)), sun_axis(len(suns))
    # The two components are opposite; one of them is the error
    return TransferMatrix(values, *axes, parts[:1] * np.float32(2**0.5), scene.bands)


def sun_coefficients(
    scene: Scene,
    windows: Sequence[Window],
    window: str,
    bsdf: Bsdf,
    *,
    sensors: Sensors,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Direct-sun coefficients C_ds: irradiance per direct normal irradiance.

    Coefficients are zero for suns behind the window plane. The solar disc has a
    diameter of 0.533°.

    Parameters
    ----------
    scene : obstructions outside and inside, all taken as black
    windows : all windows; windows other than `window` are opaque
    window : name of the window for which coefficients are computed
    bsdf : BSDF of this window, matrix or tensor tree, at full resolution
    suns : unit vectors to the suns
    peak : whether direct-direct transmission is extracted from the BSDF, as by Radiance
        aBSDF
    samples : number of paths per sensor, for all suns
    """
    effort = sun_effort(sun_coefficients, keywords, samples=_SENSOR_SAMPLES)
    paths = sensor_window_paths(blackened(scene), windows, sensors, effort=effort)
    lit = paths.sunlit(window, bsdf, suns=suns, peak=peak)
    colour = bsdf.in_colour("transmission_front")
    values, parts = lit.coefficients(len(RGB) if colour else 1)
    axes = sensors_axis(sensors), sun_axis(len(suns))
    return TransferMatrix(values, *axes, parts, RGB)
