"""Tracers of matrices from sensors, pixels and windows to windows and sky.

Each function lowers the scene of a job to Mitsuba once, and returns the tracer of
its units. Sums are transferred from the GPU once per unit.
"""

from collections.abc import Callable
from functools import lru_cache

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import UInt64

from clerestory.engine.camera_rays import camera_rays
from clerestory.engine.controller import EstimatedJob
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.matrix_jobs import (
    CoefficientsJob,
    DaylightJob,
    FacadeJob,
    PixelViewJob,
    ViewJob,
)
from clerestory.engine.next_event_estimation import Source
from clerestory.engine.origin import Origin, middle_of_window, window_origin
from clerestory.engine.patches import SkyTable
from clerestory.engine.path_tracer import PathTracer, segments_of
from clerestory.engine.primary_rays import Lanes, lanes, window_ray
from clerestory.engine.sampler import DIRECTION_U, DIRECTION_V, points
from clerestory.engine.sinks import MatrixSink
from clerestory.engine.upload import launching, vectors
from clerestory.engine.window_sampling import (
    SeparatedSkyPatches,
    SkyPatches,
    WindowPatches,
)
from clerestory.engine.windows import window_shapes
from clerestory.engine.work_units import Tracer, Unit
from clerestory.errors import DeviceError
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.scene.model import Scene

# Random number streams, which differ so that errors of V and D are independent. View
# matrices of pictures may use either stream.
_SENSORS, _WINDOWS = 0, 1
_PIXELS, _PIXELS_DIRECT = 0, 1

# Errors of F and D, which both start at window patches, must also be independent
_FACADE_SEED = 0x5FACADE5

# Russian roulette applies to paths below this fraction of their initial throughput. For
# windows of a room, the cost (time × variance) is constant from 0.25 to 1 and a fifth
# higher below 0.1; paths to the sky are short, and roulette would only add noise.
_ROULETTE_TO_WINDOWS = 0.4
_ROULETTE_TO_SKY = 0.1

Launch = Callable[[MatrixSink, Lanes, Unit], None]


def prepare_view(job: ViewJob) -> Tracer:
    """Return the tracer of view matrices from sensors to windows."""
    origin = np.mean(job.sensors.position, axis=0)
    model = lower(job.scene, origin=origin, receivers=job.windows)
    return _from_sensors(job, _to_windows(model), origin)


def prepare_coefficients(job: CoefficientsJob) -> Tracer:
    """Return the tracer of daylight coefficients from sensors to the sky."""
    origin = np.mean(job.sensors.position, axis=0)
    if not job.separate:
        return _from_sensors(job, _to_sky(job.scene, job.sky, origin), origin)
    model, size = lower(job.scene, origin=origin), len(job.sky)
    windows = model.of_materials(job.windows) if job.windows else None
    patches = SeparatedSkyPatches(SkyTable.of(job.sky), size, 0, windows)
    return _from_sensors(job, _sky_tracer(model, patches), origin)


def prepare_daylight(job: DaylightJob) -> Tracer:
    """Return the tracer of daylight matrices from a window to the sky."""
    origin = window_origin(job.scene, job.window)
    tracer = _to_sky(job.scene, job.sky, origin)
    return _from_window(job, tracer, job.seed, origin)


def prepare_facade(job: FacadeJob) -> Tracer:
    """Return the tracer of facade matrices from a window to the ports around it."""
    origin = middle_of_window(job.window)
    model = lower(job.scene, origin=origin, receivers=job.ports)
    return _from_window(job, _to_windows(model), job.seed ^ _FACADE_SEED, origin)


def prepare_pixel_view(job: PixelViewJob) -> Tracer:
    """Return the tracer of view matrices from pixels to windows.

    Direct light comes straight from windows to the eye, or after one reflection
    (diffuse or glossy) at the first surface.
    """
    origin = np.asarray(job.camera.position, dtype=float)
    model = lower(job.scene, origin=origin, receivers=job.windows)
    tracer = _to_windows(model, light=job.light)
    rays = camera_rays(job.camera)
    limit = segments_of(job.bounces)

    def launch(sink: MatrixSink, paths: Lanes, _: Unit) -> None:
        numbers = paths.numbers
        x, y = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        ray, valid = rays.through(paths.number, x, y)
        tracer.trace(sink, tracer.camera_path(ray), numbers, limit, valid)

    stream = _PIXELS_DIRECT if job.light == "direct" else _PIXELS
    return matrix_tracer(job, launch, stream=stream)


def _to_windows(model: LoweredScene, *, light: str = "all") -> PathTracer:
    windows = WindowPatches(model, direct=light == "direct")
    return PathTracer(
        model, (windows,), _ROULETTE_TO_WINDOWS, bounce_to_source=True,
        direct_only=light == "direct", without_direct=light == "reflected",
    )  # fmt: skip


def _to_sky(scene: Scene, sky: SkyPartition, origin: Origin) -> PathTracer:
    return _sky_tracer(lower(scene, origin=origin), SkyPatches(SkyTable.of(sky)))


def _sky_tracer(model: LoweredScene, patches: Source) -> PathTracer:
    return PathTracer(model, (patches,), _ROULETTE_TO_SKY, bounce_to_source=True)


def _from_window(
    job: DaylightJob | FacadeJob, tracer: PathTracer, seed: int, origin: Origin
) -> Tracer:
    table, _ = window_shapes((job.window,), origin)
    limit = segments_of(job.bounces)

    def launch(sink: MatrixSink, paths: Lanes, _: Unit) -> None:
        path = tracer.camera_path(window_ray(table, paths))
        tracer.trace(sink, path, paths.numbers, limit, mi.Bool(True))

    return matrix_tracer(job, launch, stream=_WINDOWS, seed=seed)


def _from_sensors(
    job: ViewJob | CoefficientsJob, tracer: PathTracer, origin: Origin
) -> Tracer:
    position, normal = job.sensors.position - origin, job.sensors.direction
    limit = segments_of(job.bounces, first=0)

    def launch(sink: MatrixSink, paths: Lanes, unit: Unit) -> None:
        o = dr.gather(mi.Point3f, vectors(mi.Point3f, position[unit.rows]), paths.row)
        n = dr.gather(mi.Vector3f, vectors(mi.Vector3f, normal[unit.rows]), paths.row)
        _, path = tracer.gather(sink, paths.numbers, o, n)
        active = dr.max(path.throughput) > 0
        tracer.trace(sink, path, paths.numbers, limit, active)

    return matrix_tracer(job, launch, stream=_SENSORS)


def matrix_tracer(
    job: EstimatedJob, launch: Launch, *, stream: int, seed: int | None = None
) -> Tracer:
    """Return a function that traces a unit of a matrix and returns its sums.

    `launch` traces the paths of a work unit and adds their weights to a sink. `stream`
    and `seed` (by default the job's seed) determine the random numbers.
    """
    _, batches, columns, channels = job.shape
    start = job.seed if seed is None else seed
    stretch = lru_cache(maxsize=1)(points)

    def trace(unit: Unit) -> UInt64[np.ndarray, "row batch column channel"]:
        size = len(unit.rows) * batches * columns * channels
        sums = dr.zeros(mi.UInt64, size + 1)
        with launching():
            sequence = stretch(unit.first, unit.count)
            paths = lanes(
                sequence, rows=unit.rows, batches=batches, seed=start, stream=stream
            )
            sink = MatrixSink(sums, columns, channels, paths.slot)
            launch(sink, paths, unit)
            added = sink.sums.numpy()
        refuse_out_of_range(int(added[0]))
        return added[1:].reshape(len(unit.rows), batches, columns, channels)

    return trace


def refuse_out_of_range(number: int) -> None:
    """Raise a DeviceError if path contributions were outside the range of the sums."""
    if number:
        raise DeviceError(
            f"{number} light paths contribute negative or excessive values;"
            " reflectances and transmittances from 0 to 1 expected"
        )
