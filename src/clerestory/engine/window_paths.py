"""Tracer of paths from pixels and sensors to windows, which are recorded one by one.

A path sees the window directly, or is reflected once, towards points of the windows
that are sampled by solid angle. All surfaces but the first are black.
"""

from collections.abc import Callable
from functools import lru_cache

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.camera_rays import camera_rays, sampled_ray
from clerestory.engine.channels import channels_of
from clerestory.engine.lower import lower
from clerestory.engine.origin import Origin
from clerestory.engine.path_tracer import PathTracer, segments_of
from clerestory.engine.primary_rays import Lanes, lanes
from clerestory.engine.sampler import points
from clerestory.engine.sinks import RecordSink
from clerestory.engine.upload import launching, vectors
from clerestory.engine.vertices import sensor_vertex
from clerestory.engine.window_path_jobs import (
    PixelWindowPaths,
    SensorWindowPaths,
    WindowPathsJob,
)
from clerestory.engine.window_sampling import SAMPLES, WindowCells, ZoneTable
from clerestory.engine.work_units import Tracer, Unit
from clerestory.scene.window_zones import WindowZones

# Random number stream: that of V_d of pictures
_STREAM = 1

Launch = Callable[[RecordSink, Lanes], mi.UInt32]


def prepare_pixels(job: PixelWindowPaths) -> Tracer:
    """Return the tracer of paths from pixels to windows."""
    tracer = _tracer(job, np.asarray(job.camera.position, dtype=float))
    rays = camera_rays(job.camera)
    limit = segments_of(None)

    def launch(sink: RecordSink, paths: Lanes) -> mi.UInt32:
        ray, valid = sampled_ray(rays, paths.number, paths.numbers)
        return tracer.trace(sink, tracer.camera_path(ray), paths.numbers, limit, valid)

    return _recorder(job, launch)


def prepare_sensors(job: SensorWindowPaths) -> Tracer:
    """Return the tracer of paths from sensors to windows."""
    origin = np.mean(job.sensors.position, axis=0)
    tracer = _tracer(job, origin)
    position = vectors(mi.Point3f, job.sensors.position - origin)
    normal = vectors(mi.Vector3f, job.sensors.direction)

    def launch(sink: RecordSink, paths: Lanes) -> mi.UInt32:
        point = dr.gather(mi.Point3f, position, paths.number)
        facing = dr.gather(mi.Vector3f, normal, paths.number)
        vertex, one = sensor_vertex(None, point, facing), mi.Color3f(1)
        return tracer.sample_sources(sink, sink.begin(), vertex, paths.numbers, one)

    return _recorder(job, launch)


def _tracer(job: WindowPathsJob, origin: Origin) -> PathTracer:
    model = lower(job.scene, origin=origin, receivers=job.windows)
    zones = ZoneTable.of(WindowZones.of(job.windows), origin)
    return PathTracer(
        model, (WindowCells(model, direct=True, zones=zones),), 1.0,
        direct_only=True, bounce_to_source=True,
    )  # fmt: skip


def _recorder(job: WindowPathsJob, launch: Launch) -> Tracer:
    stretch = lru_cache(maxsize=1)(points)
    batches, channels = job.batches, channels_of(job.scene)

    def trace(unit: Unit) -> Float[np.ndarray, "row batch record channel"]:
        count, most = len(unit.rows) * batches * job.points, SAMPLES
        while True:
            with launching():
                paths = lanes(
                    stretch(0, job.points), rows=unit.rows, batches=batches,
                    seed=job.seed, stream=_STREAM,
                )  # fmt: skip
                sink = RecordSink.of(count, most, channels)
                largest = int(np.max(launch(sink, paths).numpy()))
                codes = [each.numpy() for each in (sink.directions, sink.zones)]
                weights = np.stack([each.numpy() for each in sink.weights], axis=-1)
            if largest <= most:
                slots = len(unit.rows) * batches
                found = np.zeros((slots, 3, len(weights) // slots, channels), "f4")
                for number, code in enumerate(codes):
                    found[:, number, :, 0] = code.view("f4").reshape(slots, -1)
                found[:, 2] = weights.reshape(found[:, 2].shape)
                return found.reshape(len(unit.rows), batches, -1, channels)
            # Paths through several scattering panes contribute more often
            most = largest

    return trace
