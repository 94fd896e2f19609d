"""View matrices of pictures: what each pixel sees of each patch of the windows.

The whole matrix follows paths from every pixel. Its direct part stops at the first
surface: what the eye sees of the windows, and what reaches the surface straight from
them and is reflected to the eye by all of the surface's material.
"""

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine import points as sampling
from clerestory.engine.estimate import (
    Effort,
    Estimate,
    Sums,
    estimate,
    matrix_target,
    variance,
)
from clerestory.engine.lower import lower
from clerestory.engine.pixels import PixelRays
from clerestory.engine.points import points
from clerestory.engine.starts import Lanes, lanes
from clerestory.engine.walk import (
    CONNECTIONS,
    Target,
    connect,
    offset,
    spread,
    towards,
    walk,
)
from clerestory.scene.model import Scene
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Streams of random numbers, apart from those of sensors and of window patches
_WHOLE, _DIRECT = 0, 1


def trace_pixel_view(
    scene: Scene,
    windows: tuple[Window, ...],
    view: View,
    columns: int,
    rows: int,
    effort: Effort,
    *,
    direct: bool,
) -> Estimate:
    """Trace from pixels to the patches of all windows (columns: window by window).

    The relative error is that of the mean pixel under windows of uniform radiance.
    """
    origin = np.asarray(view.position, dtype=float)
    model = lower(scene, origin=origin, receivers=windows)
    target = matrix_target(model, None, model.windows.columns)
    rays = PixelRays.of(view, columns, rows)
    limit = (1 << 30) if effort.bounces is None else effort.bounces + 1

    def launch(target: Target, rows: np.ndarray, first: int, count: int) -> None:
        sequence = points(first, count)
        stream = _DIRECT if direct else _WHOLE
        paths = lanes(
            sequence, rows=rows, batches=effort.batches, seed=effort.seed, stream=stream
        )
        x = _number(sequence, paths, sampling.DIRECTION_U)
        y = _number(sequence, paths, sampling.DIRECTION_V)
        ray, valid = rays.through(paths.number, x, y, origin)
        if direct:
            _connect_first(target, sequence, paths, ray, valid)
        else:
            walk(
                target, sequence, ray, mi.Color3f(1), mi.Float(0), paths.slot,
                paths.seed, paths.index, valid, dr.opaque(mi.UInt32, limit),
            )  # fmt: skip

    def noisy(sums: Sums) -> tuple[np.ndarray, float]:
        radiance = sums.means().sum(axis=2)
        error = np.sqrt(np.mean(variance(radiance, axis=1)))
        mean = float(radiance.mean())
        ratio = error / (effort.relative_error * mean) if mean > 0 else 0.0
        return np.full(len(sums.count), ratio > 1), float(ratio)

    return estimate(launch, target, columns * rows, effort, noisy)


def _number(sequence, paths: Lanes, purpose: int):
    return sampling.coordinate(sequence, paths.seed, paths.index, mi.UInt32(0), purpose)


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
    a = _number(sequence, paths, sampling.CONNECT_U)
    b = _number(sequence, paths, sampling.CONNECT_V)
    for number in range(CONNECTIONS):
        line = connect(model, si.p, *spread(a, b, number))
        value = bsdf.eval(context, si, si.to_local(line.direction), surface)
        lit = surface & line.valid & (dr.max(value) > 0)
        near = offset(model, si, line.direction, lit)
        lit &= ~model.scene.ray_test(towards(near, line.point), lit)
        target.score(paths.slot, line.column, value / (CONNECTIONS * line.pdf), lit)
