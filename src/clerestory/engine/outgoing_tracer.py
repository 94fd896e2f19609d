"""The light that patches send into a room, on the device.

Rays start just before a patch, in the room, and look at it along the direction of the
light. Suns that they would meet straight through are left out: rendering aims at suns
through illums.
"""

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine import sampler
from clerestory.engine.next_event_estimation import Draw
from clerestory.engine.path_tracer import NOTHING, look
from clerestory.engine.radiance_jobs import ExitingRadianceJob
from clerestory.engine.radiance_tracers import light_of, segments_of, tracer_of
from clerestory.engine.upload import on_device, vectors
from clerestory.engine.work_units import Tracer

# How far before the patch rays start [m]
_BEFORE = 1e-3

# A density of the first direction so small that suns met by it count nothing
_NEVER = 1e-20

# Numbers beside the sequence for the place in a patch
_PLACE = 0x40000


def prepare_outgoing(job: ExitingRadianceJob) -> Tracer:
    """Return what traces the radiance of directions of patches."""
    patches = job.patches
    origin = patches.corner.reshape(-1, 3).mean(axis=0)
    lit, limit = light_of(job.scene, origin), segments_of(job.bounces)
    corner = vectors(mi.Point3f, patches.corner[:, 0] - origin)
    edge_u = vectors(mi.Vector3f, patches.corner[:, 1] - patches.corner[:, 0])
    edge_v = vectors(mi.Vector3f, patches.corner[:, 2] - patches.corner[:, 0])
    axes = [vectors(mi.Vector3f, patches.frame[:, i]) for i in range(3)]
    first = on_device(mi.UInt32, patches.first)
    # The number of the patch and the share of its area, growing over all triangles
    number = np.repeat(np.arange(len(patches.frame)), np.diff(patches.first))
    cumulative = on_device(mi.Float, number + patches.cumulative)
    count = len(patches.corner)
    rings, sectors = (dr.opaque(mi.UInt32, n) for n in (job.rings, job.sectors))
    dr.make_opaque(corner, edge_u, edge_v, axes, first, cumulative)

    def light(draw: Draw, row):
        sector, ring = row % sectors, row // sectors % rings
        patch = row // (sectors * rings)
        u, v, pick = (
            sampler.random_number(draw.seed, draw.index + draw.points.first, purpose)
            for purpose in range(_PLACE, _PLACE + 3)
        )

        # A place of the patch, by area
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

        # A direction of the ring and sector, by projected solid angle
        step = 0.5 * dr.pi / mi.Float(rings)
        inner = dr.square(dr.sin(mi.Float(ring) * step))
        outer = dr.square(dr.sin((mi.Float(ring) + 1) * step))
        share = draw.number(sampler.DIRECTION_U)
        sine2 = dr.lerp(inner, outer, share)
        turn = mi.Float(sector) + draw.number(sampler.DIRECTION_V)
        turn = turn * (2 * dr.pi / mi.Float(sectors)) - dr.pi
        sine, (s, c) = dr.safe_sqrt(sine2), dr.sincos(turn)
        across, along, normal = (dr.gather(mi.Vector3f, a, patch) for a in axes)
        leaving = (across * c + along * s) * sine + normal * dr.safe_sqrt(1 - sine2)
        ray = mi.Ray3f(point + normal * _BEFORE, -leaving)
        return look(
            lit, draw.points, ray, draw.seed, draw.index, mi.Color3f(1),
            mi.Float(_NEVER), mi.Float(NOTHING), mi.Bool(False),
            dr.opaque(mi.UInt32, limit), mi.Bool(True), parted=False,
        )  # fmt: skip

    return tracer_of(light, job.seed, job.batches)
