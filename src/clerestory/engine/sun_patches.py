"""Sunlit patches: small places in a room that the sun shines on, to aim at.

A stripe of sun on the floor may light the room more than the window beside it, and
paths find it by chance only. Before a picture is traced, some paths look which surfaces
a room has, and rays from the sun where on these it falls. Rectangles around what they
find join the windows as portals, and a few more paths tell how bright each is. What
they miss costs noise, never light.
"""

from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float
from scipy.ndimage import binary_dilation, label

from clerestory.engine import points as sampling
from clerestory.engine.aims import LitScene
from clerestory.engine.look import look
from clerestory.engine.points import points
from clerestory.engine.portals import MOST, Portals, Rectangles
from clerestory.engine.upload import launching, vectors
from clerestory.engine.walk import offset, passed

# Paths that look for surfaces, how many each visits, rays from the sun, and panes that
# these pass at most.
LOOKING = 1 << 13
_VERTICES = 4
_SUNBEAMS = 1 << 18
_PANES = 6

# Beams fall where most places lie: without this share of the outermost, a little wider.
_OUTLYING = 0.04
_WIDENED = 1.1

# Patches help where the sun falls on a small share of what is visited; of fewer beams
# none is made.
_SELDOM = 0.25
_FEWEST = 24

# Planes are the same within this slope and distance [m]; a patch is cut up along the
# empty cells of a grid this fine, and widened by so many.
_SLOPE, _DISTANCE = 0.01, 0.01
_CELLS = 48
_MARGIN = 2.0

# Paths that tell how bright a portal is compared with everything; patches of less than
# so much are left to chance, and none counts for more than the most.
_GLANCES = 512
_STANDING_OUT = 2.0
_BRIGHTEST = 200.0


@dataclass
class Visits:
    """Places on the surfaces of a room.

    Attributes
    ----------
    point, normal : of each [m]
    sunlit : share on which the sun shines
    """

    point: Float[np.ndarray, "n 3"]
    normal: Float[np.ndarray, "n 3"]
    sunlit: float

    def planes(self) -> set[tuple[int, ...]]:
        """Return the planes in which the places lie."""
        return set(map(tuple, np.unique(_plane(self.point, self.normal), axis=0)))


def with_sun_patches(lit: LitScene, windows: Rectangles, paths) -> LitScene:
    """Return the scene with what the sun shines on as portals.

    Parameters
    ----------
    windows : portals so far
    paths : function that returns first segments of `LOOKING` paths
    """
    if lit.sky.suns == 0:
        return lit
    seen = _visit(lit, paths())
    if len(seen.point) == 0 or seen.sunlit > _SELDOM:
        return lit
    patches = _patches(*_sunbeams(lit, seen), seen)
    if len(patches) == 0:
        return lit
    trial = replace(lit, portals=Portals.of(windows, patches))
    bright = _brightness(trial, seen)
    # Windows stay, patches where they outshine these
    worth = np.arange(len(bright)) < len(windows)
    worth |= bright > bright[: len(windows)].max(initial=_STANDING_OUT)
    kept = patches.some(worth[len(windows) :])
    return replace(lit, portals=Portals.of(windows, kept, bright[worth]))


def _visit(lit: LitScene, ray: mi.Ray3f) -> Visits:
    # Walk diffusely from surface to surface, on this side of all windows
    model = lit.model
    sequence = points(0, dr.width(ray.d))
    index, seed = dr.arange(mi.UInt32, dr.width(ray.d)), mi.UInt32(0)
    active = mi.Bool(True)
    found = []
    for vertex in range(_VERTICES):

        def number(purpose: int, vertex: int = vertex):
            return sampling.coordinate(
                sequence, seed, index, mi.UInt32(vertex), purpose
            )

        hit = model.scene.ray_intersect_preliminary(ray, active=active)
        active &= hit.is_valid()
        shape = dr.reinterpret_array(mi.UInt32, hit.shape)
        flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, active)
        active &= mi.has_flag(flags, mi.BSDFFlags.Smooth)
        active &= ~mi.has_flag(flags, mi.BSDFFlags.Null)
        active &= ~mi.has_flag(flags, mi.BSDFFlags.Transmission)
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, active)
        normal = dr.mulsign(si.n, -dr.dot(si.n, ray.d))
        sun, _, _ = lit.sky.aim(
            number(sampling.LOBE),
            number(sampling.CONNECT_U),
            number(sampling.CONNECT_V),
        )
        start = offset(model, si, sun, active)
        shone = active & (dr.dot(sun, normal) > 0)
        aim = lambda origin, sun=sun: mi.Ray3f(origin, sun)  # noqa: E731
        shone &= dr.max(passed(model, start, aim, shone, True)) > 0
        u, v = number(sampling.DIRECTION_U), number(sampling.DIRECTION_V)
        local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
        direction = mi.Frame3f(normal).to_world(local)
        ray = mi.Ray3f(offset(model, si, direction, active), direction)
        with launching():
            dr.eval(ray, active, shone, si.p, normal)
        kept = active.numpy()
        found.append(
            (si.p.numpy().T[kept], normal.numpy().T[kept], shone.numpy()[kept])
        )
    place, normal, shone = (np.concatenate(part) for part in zip(*found, strict=True))
    lit_share = float(shone.mean()) if len(shone) else 0.0
    return Visits(place.astype(float), normal.astype(float), lit_share)


def _sunbeams(lit: LitScene, seen: Visits):
    # Points and normals of what the sun shines on, through panes, around the places
    model = lit.model
    low, high = np.quantile(seen.point, [_OUTLYING, 1 - _OUTLYING], axis=0)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) * _WIDENED / 2
    index, seed = dr.arange(mi.UInt32, _SUNBEAMS), mi.UInt32(2)
    sequence = points(0, _SUNBEAMS)
    a, b, pick, u, v = (
        sampling.coordinate(sequence, seed, index, mi.UInt32(0), purpose)
        for purpose in range(sampling.PER_VERTEX)
    )
    # From all of the sun's disc: patches reach as far as the penumbra
    sun, _, _ = lit.sky.aim(pick, a, b)
    frame = mi.Frame3f(sun)
    disc = mi.warp.square_to_uniform_disk_concentric(mi.Point2f(u, v)) * radius
    box = model.scene.bbox()
    far = 2 * float(dr.norm(box.max - box.min)) + radius
    start = mi.Point3f(*map(float, middle)) + frame.s * disc.x + frame.t * disc.y
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


def _plane(point: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "n 3"]):
    # Whole numbers that are the same for points of one plane
    facing = np.round(normal / _SLOPE).astype(int)
    height = np.sum(facing * _SLOPE * point, axis=1)
    return np.column_stack([facing, np.round(height / _DISTANCE).astype(int)])


def _patches(
    point: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "n 3"], seen: Visits
) -> Rectangles:
    # Rectangles around sunlit places, those that the most beams met first
    known = seen.planes()
    keys, plane, size = np.unique(
        _plane(point, normal), axis=0, return_inverse=True, return_counts=True
    )
    found: list[tuple[int, np.ndarray]] = []
    for number in np.flatnonzero(size >= _FEWEST):
        if tuple(keys[number]) in known:
            chosen = plane.ravel() == number
            found += _rectangles(point[chosen], normal[chosen][0])
    found.sort(key=lambda part: -part[0])
    corners = np.array([part for _, part in found[:MOST]]).reshape(-1, 3, 3)
    return Rectangles(corners[:, 0], corners[:, 1], corners[:, 2])


def _rectangles(
    point: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "3"]
) -> list[tuple[int, Float[np.ndarray, "3 3"]]]:
    # Corner and edges of rectangles around the clusters of points of a plane
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


def _brightness(lit: LitScene, seen: Visits) -> Float[np.ndarray, " portal"]:
    # Mean radiance from each portal to the places, compared with that from anywhere
    count = lit.portals.count
    lanes = dr.arange(mi.UInt32, (count + 1) * _GLANCES)
    portal, index = lanes % (count + 1), lanes // (count + 1)
    sequence = points(0, _GLANCES)
    u, v, pick = (
        sampling.coordinate(sequence, portal, index, mi.UInt32(0), purpose)
        for purpose in (sampling.CONNECT_U, sampling.CONNECT_V, sampling.LOBE)
    )
    place = mi.UInt32(pick * len(seen.point))
    origin = dr.gather(mi.Point3f, vectors(mi.Point3f, seen.point), place)
    normal = dr.gather(mi.Vector3f, vectors(mi.Vector3f, seen.normal), place)
    one = dr.minimum(portal, count - 1)
    target = dr.gather(mi.Point3f, lit.portals.corner, one)
    target += dr.gather(mi.Vector3f, lit.portals.edge_u, one) * u
    target += dr.gather(mi.Vector3f, lit.portals.edge_v, one) * v
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    anywhere = mi.Frame3f(normal).to_world(local)
    direction = dr.select(portal < count, dr.normalize(target - origin), anywhere)
    before = dr.dot(direction, normal) > 0
    start = origin + normal * (1e-5 * dr.maximum(dr.norm(origin), 1.0))
    with launching():
        light = look(
            lit, sequence, mi.Ray3f(start, direction), portal, index, mi.Color3f(1),
            mi.Float(0), mi.Bool(False), dr.opaque(mi.UInt32, 2), before,
        )  # fmt: skip
        dr.eval(light, before)
    looked = before.numpy().reshape(_GLANCES, count + 1)
    value = light.numpy().astype(float).mean(axis=0).reshape(looked.shape)
    mean = np.sum(value * looked, axis=0) / np.maximum(looked.sum(axis=0), 1)
    return np.clip(mean[:-1] / max(mean[-1], 1e-30), 1, _BRIGHTEST)
