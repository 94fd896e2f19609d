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

from clerestory.engine.camera_rays import camera_rays, sampled_ray
from clerestory.engine.controller import EstimatedJob
from clerestory.engine.derivative_sums import Places
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.material_derivatives import MaterialDerivatives
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
from clerestory.engine.sampler import points
from clerestory.engine.sinks import DerivativeSink, MatrixSink, by_place, empty_sums
from clerestory.engine.upload import launching, vectors
from clerestory.engine.window_sampling import (
    SeparatedSkyPatches,
    SkyPatches,
    WindowPatches,
)
from clerestory.engine.windows import window_shapes
from clerestory.engine.work_units import Tracer, Unit
from clerestory.errors import DeviceError

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
    return _from_sensors(job, _to_windows(job, model, origin), origin)


def prepare_coefficients(job: CoefficientsJob) -> Tracer:
    """Return the tracer of daylight coefficients from sensors to the sky."""
    origin = np.mean(job.sensors.position, axis=0)
    if not job.separate:
        return _from_sensors(job, _to_sky(job, origin), origin)
    model, size = lower(job.scene, origin=origin), len(job.sky)
    windows = model.of_materials(job.windows) if job.windows else None
    patches = SeparatedSkyPatches(SkyTable.of(job.sky), size, 0, windows)
    return _from_sensors(job, _sky_tracer(job, model, patches, origin), origin)


def prepare_daylight(job: DaylightJob) -> Tracer:
    """Return the tracer of daylight matrices from a window to the sky."""
    origin = window_origin(job.scene, job.window)
    return _from_window(job, _to_sky(job, origin), job.seed, origin)


def prepare_facade(job: FacadeJob) -> Tracer:
    """Return the tracer of facade matrices from a window to the ports around it."""
    origin = middle_of_window(job.window)
    model = lower(job.scene, origin=origin, receivers=job.ports)
    tracer = _to_windows(job, model, origin)
    return _from_window(job, tracer, job.seed ^ _FACADE_SEED, origin)


def prepare_pixel_view(job: PixelViewJob) -> Tracer:
    """Return the tracer of view matrices from pixels to windows.

    Direct light comes straight from windows to the eye, or after one reflection
    (diffuse or glossy) at the first surface.
    """
    origin = np.asarray(job.camera.position, dtype=float)
    model = lower(job.scene, origin=origin, receivers=job.windows)
    tracer = _to_windows(job, model, origin, light=job.light)
    rays = camera_rays(job.camera)
    limit = segments_of(job.bounces)

    def launch(sink: MatrixSink, paths: Lanes, _: Unit) -> None:
        ray, valid = sampled_ray(rays, paths.number, paths.numbers)
        tracer.trace(sink, tracer.camera_path(ray), paths.numbers, limit, valid)

    stream = _PIXELS_DIRECT if job.light == "direct" else _PIXELS
    return matrix_tracer(job, launch, stream=stream)


def _to_windows(
    job: EstimatedJob, model: LoweredScene, origin: Origin, *, light: str = "all"
) -> PathTracer:
    windows = WindowPatches(model, direct=light == "direct")
    return PathTracer(
        model, (windows,), _ROULETTE_TO_WINDOWS, bounce_to_source=True,
        direct_only=light == "direct", without_direct=light == "reflected",
        derivatives=_derivatives(job, model, origin),
    )  # fmt: skip


def _to_sky(job: DaylightJob | CoefficientsJob, origin: Origin) -> PathTracer:
    model, patches = lower(job.scene, origin=origin), SkyPatches(SkyTable.of(job.sky))
    return _sky_tracer(job, model, patches, origin)


def _sky_tracer(
    job: EstimatedJob, model: LoweredScene, patches: Source, origin: Origin
) -> PathTracer:
    return PathTracer(
        model, (patches,), _ROULETTE_TO_SKY, bounce_to_source=True,
        derivatives=_derivatives(job, model, origin),
    )  # fmt: skip


def _derivatives(
    job: EstimatedJob, model: LoweredScene, origin: Origin
) -> MaterialDerivatives | None:
    names = [parameter.name for parameter in job.derivatives]
    return MaterialDerivatives.of(job.scene, names, model, origin)


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
    _, places, columns, channels = job.shape
    batches, start = job.batches, job.seed if seed is None else seed
    stretch = lru_cache(maxsize=1)(points)

    def trace(unit: Unit) -> UInt64[np.ndarray, "row place column channel"]:
        count = len(unit.rows) * places * columns
        sums = empty_sums(count, channels)
        with launching():
            sequence = stretch(unit.first, unit.count)
            paths = lanes(
                sequence, rows=unit.rows, batches=batches, seed=start, stream=stream
            )
            sink = matrix_sink(job, sums, paths.row, paths.slot)
            launch(sink, paths, unit)
            added = sink.sums.numpy()
        refuse_out_of_range(int(added[0]))
        shape = len(unit.rows), places, columns, channels
        return by_place(added, count, channels).reshape(shape)

    return trace


def matrix_sink(
    job: EstimatedJob, sums: mi.UInt64, row: mi.UInt32, slot: mi.UInt32
) -> MatrixSink:
    """Return the sink of a matrix and, if the job asks for them, its derivatives.

    `slot` is the index of the paths' row and batch.
    """
    _, _, columns, channels = job.shape
    if not job.derivatives:
        return MatrixSink(sums, columns, channels, slot)
    places = Places(job.batches, len(job.derivatives))
    batch = slot - row * places.batches
    value = row * places.count + batch
    count = len(job.derivatives)
    return DerivativeSink(
        sums, columns, channels, value, job.batches, count, row, batch
    )


def refuse_out_of_range(number: int) -> None:
    """Raise a DeviceError if path contributions were outside the range of the sums."""
    if number:
        raise DeviceError(
            f"{number} light paths contribute negative or excessive values;"
            " reflectances and transmittances from 0 to 1 expected"
        )
