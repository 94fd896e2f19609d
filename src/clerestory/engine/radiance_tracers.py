"""Radiance and irradiance at one instant: tracers of pixels, sensors and patches."""

from collections.abc import Callable
from functools import lru_cache

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.camera_rays import CameraRays
from clerestory.engine.first_hit import first_hit
from clerestory.engine.illumination import Illumination
from clerestory.engine.path_guiding import learned_portals
from clerestory.engine.path_tracer import PathTracer, segments_of
from clerestory.engine.pilot_paths import PILOT_PATHS, sample_surfaces
from clerestory.engine.portals import window_rectangles
from clerestory.engine.radiance_jobs import IrradianceJob, PictureJob
from clerestory.engine.sampler import (
    DIRECTION_U,
    DIRECTION_V,
    LOBE,
    PathNumbers,
    points,
)
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.sun_patches import sun_patches
from clerestory.engine.upload import launching, vectors
from clerestory.engine.work_units import Tracer, Unit
from clerestory.scene.model import Scene

# Dimensions of the hashed random numbers for the point in a pixel
_PIXEL = 0x40000

_SINK = RadianceSink()


def prepare_picture(job: PictureJob) -> Tracer:
    """Return the tracer of the radiance or irradiance of a view's pixels."""
    rays = CameraRays.of(job.view, job.columns, job.rows)
    origin = np.asarray(job.view.position, dtype=float)
    tracer = radiance_tracer(
        job.scene, origin, job.bounces, lambda: _camera_pilots(rays, job.receivers)
    )
    limit = segments_of(job.bounces)

    def irradiance(numbers: PathNumbers, row):
        # The low-discrepancy dimensions are left to the surface; the pixel uses hashes
        x, y = numbers.hashed(_PIXEL), numbers.hashed(_PIXEL + 1)
        ray, valid = rays.through(row, x, y)
        position, normal, found = first_hit(tracer.model, ray, valid)
        light = irradiance_at(tracer, numbers, position, normal, limit - 1, found)
        return dr.select(found, light, 0)

    def radiance(numbers: PathNumbers, row):
        x, y = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        ray, valid = rays.through(row, x, y)
        segments = dr.opaque(mi.UInt32, limit)
        path = tracer.camera_path(ray)
        return tracer.trace(_SINK, _SINK.begin(), path, numbers, segments, valid)

    kind = irradiance if job.quantity == "irradiance" else radiance
    return tracer_of(kind, job.seed, job.batches)


def prepare_irradiance(job: IrradianceJob) -> Tracer:
    """Return the tracer of the irradiance of sensors."""
    origin = np.mean(job.sensors.position, axis=0)
    position = vectors(mi.Point3f, job.sensors.position - origin)
    normal = vectors(mi.Vector3f, job.sensors.direction)
    tracer = radiance_tracer(
        job.scene, origin, job.bounces,
        lambda: _sensor_pilots(position, normal, job.receivers),
    )  # fmt: skip
    limit = segments_of(job.bounces, first=0)

    def irradiance(numbers: PathNumbers, row):
        o = dr.gather(mi.Point3f, position, row)
        n = dr.gather(mi.Vector3f, normal, row)
        return irradiance_at(tracer, numbers, o, n, limit, mi.Bool(True))

    return tracer_of(irradiance, job.seed, job.batches)


def irradiance_at(tracer: PathTracer, numbers, position, normal, limit: int, active):
    """Return the irradiance of points, one path each."""
    light, path = tracer.gather(
        _SINK, _SINK.begin(), numbers, position=position, normal=normal
    )
    active = active & (dr.max(path.throughput) > 0)
    segments = dr.opaque(mi.UInt32, max(limit, 0))
    return tracer.trace(_SINK, light, path, numbers, segments, active)


def radiance_tracer(
    scene: Scene,
    origin: Float[np.ndarray, "3"],
    bounces: int | None,
    pilots: Callable[[], mi.Ray3f],
) -> PathTracer:
    """Return a path tracer around a point, guided towards windows and sunlit areas.

    Parameters
    ----------
    pilots : function that returns the first segments of pilot paths
    """
    illuminated = Illumination.of(scene, origin)
    windows = window_rectangles(scene, origin)
    places = sample_surfaces(illuminated.model, pilots())
    patches = sun_patches(illuminated, places)
    portals = learned_portals(illuminated, windows, patches, places)
    return illuminated.tracer(portals, split_lobes=_splits_lobes(scene, bounces))


def _splits_lobes(scene: Scene, bounces: int | None) -> bool:
    # Whether a bounce limit applies and materials have diffuse and glossy components
    materials = scene.materials.values()
    return bounces is not None and any(
        getattr(each, "specularity", 0) > 0 for each in materials
    )


def _pilot_numbers(count: int):
    # Row of each pilot path, and random numbers for its direction
    lane = dr.arange(mi.UInt32, PILOT_PATHS)
    numbers = PathNumbers(points(0, PILOT_PATHS), mi.UInt32(1), lane, mi.UInt32(0))
    pick, u, v = (numbers.sobol(n) for n in (LOBE, DIRECTION_U, DIRECTION_V))
    rows = dr.opaque(mi.UInt32, count)
    return dr.minimum(mi.UInt32(pick * mi.Float(rows)), rows - 1), u, v


def _camera_pilots(rays: CameraRays, count: int) -> mi.Ray3f:
    ray, _ = rays.through(*_pilot_numbers(count))
    return ray


def _sensor_pilots(position: mi.Point3f, normal: mi.Vector3f, count: int) -> mi.Ray3f:
    row, u, v = _pilot_numbers(count)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    upwards = mi.Frame3f(dr.gather(mi.Vector3f, normal, row))
    return mi.Ray3f(dr.gather(mi.Point3f, position, row), upwards.to_world(local))


def tracer_of(light: Callable, seed: int, batches: int) -> Tracer:
    """Return the tracer of units: consecutive rows and a range of the sequence."""
    stretch = lru_cache(maxsize=1)(points)

    def trace(unit: Unit) -> Float[np.ndarray, "row batch 1 3"]:
        sequence, count = stretch(unit.first, unit.count), unit.count
        lane = dr.arange(mi.UInt32, len(unit.rows) * batches * count)
        index = lane % dr.opaque(mi.UInt32, count)
        slot = lane // dr.opaque(mi.UInt32, count)
        absolute = slot + dr.opaque(mi.UInt32, int(unit.rows[0]) * batches)
        row = absolute // dr.opaque(mi.UInt32, batches)
        key = mi.sample_tea_32(absolute, dr.opaque(mi.UInt32, seed))[0]
        with launching():
            found = light(PathNumbers(sequence, key, index, mi.UInt32(0)), row)
            dr.eval(found)
            total = dr.block_reduce(dr.ReduceOp.Add, found, count).numpy()
        return total.T.reshape(len(unit.rows), batches, 1, 3).astype(float)

    return trace
