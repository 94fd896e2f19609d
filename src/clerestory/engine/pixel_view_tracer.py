"""View matrices of pictures: what each pixel sees of each patch of the windows.

The whole matrix follows paths from every pixel. Its direct part stops at the first
surface: what the eye sees of the windows, and what reaches the surface straight from
them and is reflected to the eye by all of the surface's material.
"""

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine import sampler
from clerestory.engine.lower import lower
from clerestory.engine.matrix_jobs import PixelViewJob
from clerestory.engine.matrix_tracers import matrix_tracer
from clerestory.engine.primary_rays import Lanes
from clerestory.engine.radiance_tracers import PixelRays
from clerestory.engine.sampler import Points
from clerestory.engine.walk import (
    CONNECTIONS,
    Target,
    connect,
    offset,
    spread,
    towards,
    walk,
)
from clerestory.engine.work_units import Tracer, Unit

# Streams of random numbers, apart from those of sensors and of window patches
_WHOLE, _DIRECT = 0, 1


def prepare_pixel_view(job: PixelViewJob) -> Tracer:
    """Return what traces from pixels to windows."""
    origin = np.asarray(job.view.position, dtype=float)
    model = lower(job.scene, origin=origin, receivers=job.windows)
    rays = PixelRays.of(job.view, job.columns, job.rows)
    limit = (1 << 30) if job.bounces is None else job.bounces + 1

    def launch(target: Target, sequence: Points, paths: Lanes, _unit: Unit) -> None:
        x = _number(sequence, paths, sampler.DIRECTION_U)
        y = _number(sequence, paths, sampler.DIRECTION_V)
        ray, valid = rays.through(paths.number, x, y)
        if job.direct:
            _connect_first(target, sequence, paths, ray, valid)
        else:
            walk(
                target, sequence, ray, mi.Color3f(1), mi.Float(0), paths.slot,
                paths.seed, paths.index, valid, dr.opaque(mi.UInt32, limit),
            )  # fmt: skip

    target = Target(model, None, mi.UInt64(), *job.shape[2:])
    stream = _DIRECT if job.direct else _WHOLE
    return matrix_tracer(job, target, launch, stream=stream)


def _number(sequence, paths: Lanes, purpose: int):
    return sampler.coordinate(sequence, paths.seed, paths.index, mi.UInt32(0), purpose)


def _connect_first(target: Target, sequence, paths: Lanes, ray, active) -> None:
    # Score the window that the eye sees, or those that light what it sees
    model = target.model
    hit = model.scene.ray_intersect_preliminary(ray, active=active)
    met = active & hit.is_valid()
    si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, met)
    shape = dr.reinterpret_array(mi.UInt32, si.shape)
    role = dr.gather(mi.UInt32, model.window_of_shape, shape, met)
    window = role - 1
    at_window = met & (role > 0)
    normal = dr.gather(mi.Vector3f, model.windows.normal, window, at_window)
    front = at_window & (dr.dot(ray.d, normal) < -1e-6)
    column = model.windows.find(window, -ray.d)
    target.score(paths.slot, column, mi.Color3f(1), front)

    surface = met & (role == 0)
    si.sh_frame = mi.Frame3f(si.n)
    si.wi = si.to_local(-ray.d)
    bsdf, context = si.bsdf(), mi.BSDFContext()
    a = _number(sequence, paths, sampler.CONNECT_U)
    b = _number(sequence, paths, sampler.CONNECT_V)
    for number in range(CONNECTIONS):
        line = connect(model, si.p, *spread(a, b, number))
        value = bsdf.eval(context, si, si.to_local(line.direction), surface)
        lit = surface & line.valid & (dr.max(value) > 0)
        near = offset(model, si, line.direction, lit)
        lit &= ~model.scene.ray_test(towards(near, line.point), lit)
        target.score(paths.slot, line.column, value / (CONNECTIONS * line.pdf), lit)
