"""Tracer of the pairwise estimator: sunlight on pixels, by paths for every sun."""

import drjit as dr
import mitsuba as mi
import numpy as np
from pairwise_window import SunlitWindow

from clerestory.engine.camera_rays import CameraRays
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.sampler import (
    CONNECT_U,
    CONNECT_V,
    DIRECTION_U,
    DIRECTION_V,
    PathNumbers,
    mix,
    points,
)
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.upload import launching, on_device, vectors

_SINK = RadianceSink()


def _tracer(window: SunlitWindow) -> PathTracer:
    return PathTracer(window.inside, (window,), 1.0, direct_only=True)


def prepare_pixel_sun(job):
    """Return the tracer of direct sunlight from a window to pixels: C_R-ds and C_F-ds.

    The radiance of a window pixel is that of sunlight scattered by the BSDF to the eye,
    plus that of the solar disc if light is transmitted unscattered. The radiance of any
    other pixel is that of sunlight reflected by the visible surface.
    """
    origin = np.asarray(job.view.position, dtype=float)
    window = SunlitWindow.of(job, origin)
    rays = CameraRays.of(job.view, job.columns, job.rows)
    sequence, batches = points(0, job.points), job.batches

    def trace(unit):
        suns, samples = len(unit.columns), unit.count
        lane = dr.arange(mi.UInt32, len(unit.rows) * suns * batches * samples)
        index = lane % dr.opaque(mi.UInt32, samples)
        slot = lane // dr.opaque(mi.UInt32, samples)
        pixel, stream, middle = _pairs(job, unit, slot // batches)
        key = mi.sample_tea_32(pixel * batches + slot % batches, stream)[0]
        numbers = PathNumbers(sequence, key, index, mi.UInt32(0))
        x, y = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        a, b = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
        ray, valid = rays.through(pixel, x, y)
        tracer = _tracer(window.lit_by(middle, a, b))
        with launching():
            light = tracer.trace(_SINK, tracer.camera_path(ray), numbers, 1, valid)
            dr.eval(light)
            total = dr.block_reduce(dr.ReduceOp.Add, light, samples).numpy()
        by_pair = (total / samples).T.reshape(len(unit.rows), suns, batches, -1)
        return by_pair.transpose(0, 2, 1, 3)

    return trace


def _pairs(job, unit, pair):
    # Row, random stream, and unit vector to the sun's centre, by pair of row and sun
    suns = dr.opaque(mi.UInt32, len(unit.columns))
    row = pair // suns + dr.opaque(mi.UInt32, int(unit.rows[0]))
    sun = pair % suns
    number = dr.gather(mi.UInt32, on_device(mi.UInt32, unit.columns), sun)
    stream = mix(number, dr.opaque(mi.UInt32, job.seed))
    middles = vectors(mi.Vector3f, job.suns[unit.columns])
    return row, stream, dr.gather(mi.Vector3f, middles, sun)
