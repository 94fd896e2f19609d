"""Radiance of pixels and cells due to sky patches and suns, in scenes with glazing.

Direct light is scattered by one surface, or by none; panes on its way transmit it
straight. The radiance due to suns is next-event estimation at the first surface.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.constants import SUN_DIAMETER
from clerestory.engine.camera_rays import camera_rays, sampled_ray
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.matrix_tracers import matrix_tracer
from clerestory.engine.next_event_estimation import (
    LightSample,
    Path,
    Source,
    Vertex,
)
from clerestory.engine.patches import SkyTable
from clerestory.engine.path_tracer import PathTracer, segments_of
from clerestory.engine.portals import Portals, window_rectangles
from clerestory.engine.primary_rays import Lanes
from clerestory.engine.sampler import (
    CONNECT_U,
    CONNECT_V,
    PathNumbers,
    mix,
    points,
)
from clerestory.engine.sinks import MatrixSink, RadianceSink
from clerestory.engine.sky_view_jobs import SkyViewJob, SunViewJob
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.visibility import along, transmittance
from clerestory.engine.window_sampling import SeparatedSkyPatches
from clerestory.engine.work_units import Tracer, Unit

# Random number stream: that of pixels, as the other matrices of this method have none
_STREAM = 0

# Russian roulette applies to paths below this fraction of their initial throughput
_ROULETTE = 0.2


@dataclass
class DistantSun(Source):
    """Sun of unit direct normal irradiance, at a point of its disc for each path."""

    name: ClassVar[str] = "sun"
    model: LoweredScene
    direction: mi.Vector3f

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield the direction to the sun."""

        def arriving(vertex: Vertex, active):
            start = vertex.leave(self.direction, active)
            return transmittance(self.model, start, along(self.direction), active)

        always = mi.Bool(True)
        yield LightSample(
            self.direction, mi.Float(1), always, arriving, heuristic=None,
            luminaire=True,
        )  # fmt: skip


def prepare_sky_view(job: SkyViewJob) -> Tracer:
    """Return the tracer of the radiance of pixels due to sky patches."""
    origin = np.asarray(job.camera.position, dtype=float)
    model = lower(job.scene, origin=origin)
    patches = SeparatedSkyPatches(SkyTable.of(job.sky), len(job.sky), scattered=1)
    portals = Portals.uniform(window_rectangles(job.scene, origin))
    tracer = PathTracer(model, (patches,), _ROULETTE, portals, bounce_to_source=True)
    rays, limit = camera_rays(job.camera), segments_of(job.bounces)

    def launch(sink: MatrixSink, paths: Lanes, _: Unit) -> None:
        ray, valid = sampled_ray(rays, paths.number, paths.numbers)
        tracer.trace(sink, tracer.camera_path(ray), paths.numbers, limit, valid)

    return matrix_tracer(job, launch, stream=_STREAM)


def prepare_sun_view(job: SunViewJob) -> Tracer:
    """Return the tracer of sunlight that the first surfaces scatter to pixels."""
    origin = np.asarray(job.camera.position, dtype=float)
    model = lower(job.scene, origin=origin)
    rays, sequence = camera_rays(job.camera), points(0, job.points)
    batches, sink = job.batches, RadianceSink()

    def trace(unit: Unit) -> Float[np.ndarray, "pixel batch sun channel"]:
        assert unit.columns is not None
        suns, samples = len(unit.columns), unit.count
        lane = dr.arange(mi.UInt32, len(unit.rows) * suns * batches * samples)
        index, slot = lane % dr.opaque(mi.UInt32, samples), lane // samples
        pair = slot // dr.opaque(mi.UInt32, batches)
        own, width = pair % dr.opaque(mi.UInt32, suns), dr.opaque(mi.UInt32, suns)
        pixel = dr.gather(mi.UInt32, on_device(mi.UInt32, unit.rows), pair // width)
        sun = dr.gather(mi.UInt32, on_device(mi.UInt32, unit.columns), own)
        stream = mix(sun, dr.opaque(mi.UInt32, job.seed))
        key = mi.sample_tea_32(pixel * batches + slot % batches, stream)[0]
        numbers = PathNumbers(sequence, key, index, mi.UInt32(0))
        place = mi.Point2f(numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V))
        local = mi.warp.square_to_uniform_cone(place, float(np.cos(SUN_DIAMETER / 2)))
        with launching():
            middle = dr.gather(mi.Vector3f, vectors(mi.Vector3f, job.suns), sun)
            disc = DistantSun(model, mi.Frame3f(middle).to_world(local))
            tracer = PathTracer(model, (disc,), 1.0, direct_only=True)
            ray, valid = sampled_ray(rays, pixel, numbers)
            path = tracer.path(ray, 1, 0, camera=not job.indirect)
            light = tracer.trace(sink, path, numbers, 1, valid)
            dr.eval(light)
            total = dr.block_reduce(dr.ReduceOp.Add, light, samples).numpy()
        values = (total / samples).T.reshape(len(unit.rows), suns, batches, -1)
        return values.transpose(0, 2, 1, 3)

    return trace
