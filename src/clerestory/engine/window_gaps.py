"""Portals for path guiding where daylight passes beside panes.

A blind or a shade that hangs some centimetres in front of its opening lets daylight
pass beside it. BSDF sampling hits such a gap only by chance. Before rendering, rays are
therefore traced from surface points of the room to strips around the panes; strips that
rays pass become portals in addition to the panes. A missed gap increases the noise but
causes no bias.
"""

from dataclasses import astuple

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.lower import LoweredScene
from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.portals import Rectangles
from clerestory.engine.sampler import random_numbers
from clerestory.engine.spherical_rectangle import Parallelograms
from clerestory.engine.upload import launching, vectors

# Number of rays to each rectangle, and largest number of panes, the largest in area.
_RAYS = 1 << 12
_PANES = 3

# Width of strips [m]: wider ones contain more wall, narrower ones less of a wide gap
_WIDTH = 0.2

# A ray passes a strip if it meets nothing up to this distance behind the strip [m]: the
# wall behind a flush or overlapping pane is nearer.
_BEHIND = 1.0

# A strip is used if the light that passes it under a uniform sky is at least this
# fraction of the pane's.
_LEAST = 0.005


def window_gaps(
    model: LoweredScene, windows: Rectangles, places: SurfacePoints
) -> Rectangles:
    """Return strips beside the largest panes that rays from a room pass.

    `windows` are the rectangles of panes in descending order of their areas.
    """
    panes = windows.some(np.arange(len(windows)) < _PANES)
    if len(panes) == 0 or len(places) == 0:
        return Rectangles.none()
    strips = _strips(panes)
    everything, passed = _form_factors(model, panes + strips, places)
    seen = np.repeat(everything[: len(panes)], len(strips) // len(panes))
    return strips.some(passed[len(panes) :] > _LEAST * seen)


def _strips(panes: Rectangles) -> Rectangles:
    # Four strips around each pane, in its plane
    found = []
    for corner, u, v in zip(panes.corner, panes.edge_u, panes.edge_v, strict=True):
        right, up = (_WIDTH * edge / np.linalg.norm(edge) for edge in (u, v))
        across = u + 2 * right
        found += [
            (corner - right - up, across, up),
            (corner - right + v, across, up),
            (corner - right, right, v),
            (corner + u, right, v),
        ]
    corner, edge_u, edge_v = np.array(found).transpose(1, 0, 2)
    return Rectangles(corner, edge_u, edge_v)


def _form_factors(
    model: LoweredScene, rectangles: Rectangles, places: SurfacePoints
) -> tuple[Float[np.ndarray, " rectangle"], Float[np.ndarray, " rectangle"]]:
    # Mean form factor of rectangles times π, of all rays and of those that pass. Near
    # points are limited, as they would add noise
    count = dr.opaque(mi.UInt32, len(places))
    lanes = dr.arange(mi.UInt32, len(rectangles) * _RAYS)
    pick, u, v = random_numbers(5, lanes, 3)
    place = dr.minimum(mi.UInt32(pick * mi.Float(count)), count - 1)
    start = dr.gather(mi.Point3f, vectors(mi.Point3f, places.start), place)
    normal = dr.gather(mi.Vector3f, vectors(mi.Vector3f, places.normal), place)
    every = Parallelograms.of(*astuple(rectangles)).take(lanes // _RAYS)
    towards = every.point(u, v) - start
    distance = dr.maximum(dr.norm(towards), _WIDTH)
    direction = dr.normalize(towards)
    area = dr.abs(dr.dot(dr.cross(every.edge_u, every.edge_v), direction))
    weight = dr.maximum(dr.dot(normal, direction), 0) * area / dr.square(distance)
    ray = mi.Ray3f(start, direction)
    ray.maxt = dr.norm(towards) + _BEHIND
    with launching():
        clear = ~model.scene.ray_test(ray, weight > 0)
        found = [
            dr.block_reduce(dr.ReduceOp.Add, each, _RAYS).numpy().astype(float) / _RAYS
            for each in (weight, dr.select(clear, weight, 0))
        ]
    return found[0], found[1]
