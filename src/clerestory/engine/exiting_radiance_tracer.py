"""Tracer of the exiting radiance of patches towards a room, by direction.

Rays start in the room just in front of a patch, and are traced towards it against the
direction of light. Suns visible through the patch are excluded, because pictures sample
suns through illums.
"""

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.illumination import Illumination
from clerestory.engine.path_tracer import SAMPLED_AT_START, segments_of
from clerestory.engine.portals import Portals, window_rectangles
from clerestory.engine.radiance_jobs import ExitingRadianceJob
from clerestory.engine.radiance_tracers import tracer_of
from clerestory.engine.sampler import DIRECTION_U, DIRECTION_V, PathNumbers
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.upload import on_device, vectors
from clerestory.engine.work_units import Tracer

# Distance of ray origins from the patch [m]
_BEFORE = 1e-3

# Dimensions of the hashed random numbers for the point in a patch
_POINT = 0x40000


def prepare_outgoing(job: ExitingRadianceJob) -> Tracer:
    """Return the tracer of the exiting radiance of patches by direction."""
    patches = job.patches
    origin = patches.corner.reshape(-1, 3).mean(axis=0)
    portals = Portals.uniform(window_rectangles(job.scene, origin))
    tracer, sink = Illumination.of(job.scene, origin).tracer(portals), RadianceSink()
    limit = segments_of(job.bounces)
    corner = vectors(mi.Point3f, patches.corner[:, 0] - origin)
    edge_u = vectors(mi.Vector3f, patches.corner[:, 1] - patches.corner[:, 0])
    edge_v = vectors(mi.Vector3f, patches.corner[:, 2] - patches.corner[:, 0])
    axes = [vectors(mi.Vector3f, patches.frame[:, i]) for i in range(3)]
    first = on_device(mi.UInt32, patches.first)
    # Patch index plus cumulative area fraction, increasing over all triangles
    number = np.repeat(np.arange(len(patches.frame)), np.diff(patches.first))
    cumulative = on_device(mi.Float, number + patches.cumulative)
    count = len(patches.corner)
    rings, sectors = (dr.opaque(mi.UInt32, n) for n in (job.rings, job.sectors))
    dr.make_opaque(corner, edge_u, edge_v, axes, first, cumulative)

    def radiance(numbers: PathNumbers, row):
        sector, ring = row % sectors, row // sectors % rings
        patch = row // (sectors * rings)
        u, v, pick = (numbers.hashed(_POINT + n) for n in range(3))

        # Sample a point of the patch by area
        low = dr.gather(mi.UInt32, first, patch)
        high = dr.gather(mi.UInt32, first, patch + 1)
        place = mi.Float(patch) + pick
        triangle = dr.binary_search(
            0, count - 1, lambda i: dr.gather(mi.Float, cumulative, i) <= place
        )
        triangle = dr.clip(mi.UInt32(triangle), low, high - 1)
        fold = u + v > 1
        u, v = dr.select(fold, 1 - u, u), dr.select(fold, 1 - v, v)
        point = dr.gather(mi.Point3f, corner, triangle)
        point += dr.gather(mi.Vector3f, edge_u, triangle) * u
        point += dr.gather(mi.Vector3f, edge_v, triangle) * v

        # Sample a direction of the ring and sector by projected solid angle
        step = 0.5 * dr.pi / mi.Float(rings)
        inner = dr.square(dr.sin(mi.Float(ring) * step))
        outer = dr.square(dr.sin((mi.Float(ring) + 1) * step))
        share = numbers.sobol(DIRECTION_U)
        sine2 = dr.lerp(inner, outer, share)
        turn = mi.Float(sector) + numbers.sobol(DIRECTION_V)
        turn = turn * (2 * dr.pi / mi.Float(sectors)) - dr.pi
        sine, (s, c) = dr.safe_sqrt(sine2), dr.sincos(turn)
        across, along, normal = (dr.gather(mi.Vector3f, a, patch) for a in axes)
        leaving = (across * c + along * s) * sine + normal * dr.safe_sqrt(1 - sine2)
        ray = mi.Ray3f(point + normal * _BEFORE, -leaving)
        path = tracer.path(ray, 1, SAMPLED_AT_START)
        segments = dr.opaque(mi.UInt32, limit)
        return tracer.trace(sink, sink.begin(), path, numbers, segments, mi.Bool(True))

    return tracer_of(radiance, job.seed, job.batches)
