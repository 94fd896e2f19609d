"""Sunlit areas of a room as portals for path guiding.

A sunlit area on the floor may light the room more than the window does, yet BSDF
sampling hits it only by chance. Before rendering, rays are traced from the sun into the
room; rectangles around clusters of their hit points become portals in addition to the
windows. A missed sunlit area increases the noise but causes no bias.
"""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int
from scipy.ndimage import binary_dilation, label

from clerestory.engine.illumination import Illumination
from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.portals import MOST, Rectangles
from clerestory.engine.sampler import random_numbers
from clerestory.engine.upload import launching, vectors
from clerestory.engine.visibility import along, offset, transmittance

# Number of rays from the sun, and greatest number of panes that a ray passes.
_SUNBEAMS = 1 << 18
_PANES = 6

# Rays cover a sphere around the surface points without outliers: fraction of outliers
# at either end of an axis, and factor that enlarges the sphere.
_OUTLYING = 0.04
_WIDENED = 1.1

# Portals are used if the sun lights at most this fraction of the surface points; least
# number of hit points of sun rays in a portal.
_SELDOM = 0.25
_FEWEST = 24

# Tolerances on normal and on distance [m] for points of one plane; bound on the number
# of distance steps along a normal; cells per axis of the grid on which hit points are
# clustered; margin around a cluster [cells].
_SLOPE, _DISTANCE = 0.01, 0.01
_HEIGHTS = 1 << 40
_CELLS = 48
_MARGIN = 2.0


def sun_patches(scene: Illumination, places: SurfacePoints) -> Rectangles:
    """Return rectangles around sunlit areas; none if much of the room is sunlit."""
    if scene.distant.suns == 0 or len(places) == 0:
        return Rectangles.none()
    if _sunlit_share(scene, places) > _SELDOM:
        return Rectangles.none()
    return _patches(*_sunbeams(scene, places), places)


def _sunlit_share(scene: Illumination, places: SurfacePoints) -> float:
    # Fraction of the surface points lit directly by a sun
    u, v, pick = random_numbers(1, dr.arange(mi.UInt32, len(places)), 3)
    sun = scene.distant.sample_sun(pick, u, v).direction
    start, ray = vectors(mi.Point3f, places.start), along(sun)
    shone = dr.dot(sun, vectors(mi.Vector3f, places.normal)) > 0
    with launching():
        seen = transmittance(scene.model, start, ray, shone, through_illums=True)
        return float((shone & (dr.max(seen) > 0)).numpy().mean())


def _sunbeams(scene: Illumination, places: SurfacePoints):
    # Points and normals where rays from the sun, through panes, hit opaque surfaces
    model = scene.model
    low, high = np.quantile(places.point, [_OUTLYING, 1 - _OUTLYING], axis=0)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) * _WIDENED / 2
    a, b, pick, u, v = random_numbers(2, dr.arange(mi.UInt32, _SUNBEAMS), 5)
    # Directions cover the whole solar disc, so that portals include the penumbra
    sun = scene.distant.sample_sun(pick, a, b).direction
    frame = mi.Frame3f(sun)
    disc = mi.warp.square_to_uniform_disk_concentric(mi.Point2f(u, v))
    disc *= dr.opaque(mi.Float, radius)
    box = model.scene.bbox()
    far = dr.opaque(mi.Float, 2 * float(dr.norm(box.max - box.min)) + radius)
    centre = vectors(mi.Point3f, middle[None])
    start = centre + frame.s * disc.x + frame.t * disc.y
    ray = mi.Ray3f(start + sun * far, -sun)
    travelling, found = mi.Bool(True), mi.Bool(False)
    point, normal = mi.Point3f(0), mi.Vector3f(0)
    for _ in range(_PANES):
        hit = model.scene.ray_intersect_preliminary(ray, active=travelling)
        travelling &= hit.is_valid()
        shape = dr.reinterpret_array(mi.UInt32, hit.shape)
        flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, travelling)
        pane = mi.has_flag(flags, mi.BSDFFlags.Null)
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, travelling)
        here = travelling & ~pane & ~mi.has_flag(flags, mi.BSDFFlags.Transmission)
        found |= here
        point = dr.select(here, si.p, point)
        normal = dr.select(here, dr.mulsign(si.n, dr.dot(si.n, sun)), normal)
        travelling &= pane
        ray = mi.Ray3f(offset(model, si, ray.d, travelling), ray.d)
    with launching():
        dr.eval(found, point, normal)
    kept = found.numpy()
    return point.numpy().T[kept].astype(float), normal.numpy().T[kept].astype(float)


def _plane(
    point: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "n 3"]
) -> Int[np.ndarray, " n"]:
    # Integer key of each point's plane; points of one plane have equal keys
    facing = np.round(normal / _SLOPE).astype(np.int64)
    height = np.sum(facing * _SLOPE * point, axis=1)
    most = round(1 / _SLOPE)
    wide = 2 * most + 1
    slope = (facing + most) @ [wide * wide, wide, 1]
    return np.asarray(slope * _HEIGHTS + np.round(height / _DISTANCE).astype(np.int64))


def _patches(
    point: Float[np.ndarray, "n 3"],
    normal: Float[np.ndarray, "n 3"],
    places: SurfacePoints,
) -> Rectangles:
    # Rectangles around sunlit areas, in descending order of their numbers of hit points
    plane = _plane(point, normal)
    keys, size = np.unique(plane, return_counts=True)
    seen = np.isin(keys, _plane(places.point, places.normal))
    found: list[tuple[int, np.ndarray]] = []
    for key in keys[seen & (size >= _FEWEST)]:
        chosen = plane == key
        found += _rectangles(point[chosen], normal[chosen][0])
    found.sort(key=lambda part: -part[0])
    corners = np.array([part for _, part in found[:MOST]]).reshape(-1, 3, 3)
    return Rectangles(corners[:, 0], corners[:, 1], corners[:, 2])


def _rectangles(
    point: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "3"]
) -> list[tuple[int, Float[np.ndarray, "3 3"]]]:
    # By cluster of hit points: number of points, and rectangle (corner and two edges)
    axis = np.eye(3)[np.argmin(np.abs(normal))]
    right = np.cross(axis, normal)
    right /= np.linalg.norm(right)
    upwards = np.cross(normal, right)
    place = np.column_stack([point @ right, point @ upwards])
    low = place.min(axis=0)
    cell = np.maximum(np.ptp(place, axis=0) / _CELLS, 1e-3)
    column = np.floor((place - low) / cell).astype(int)
    grid = np.zeros((_CELLS + 2, _CELLS + 2), dtype=bool)
    grid[tuple(column.T)] = True
    cluster, count = label(binary_dilation(grid, np.ones((3, 3))), np.ones((3, 3)))
    member = cluster[tuple(column.T)]
    found = []
    for number in range(1, count + 1):
        inside = place[member == number]
        if len(inside) < _FEWEST:
            continue
        first = inside.min(axis=0) - _MARGIN * cell
        extent = inside.max(axis=0) + _MARGIN * cell - first
        corner = first[0] * right + first[1] * upwards + (point[0] @ normal) * normal
        part = np.array([corner, extent[0] * right, extent[1] * upwards])
        found.append((len(inside), part))
    return found
