"""Light transport through a sample area of a shading system.

Paths are traced in the direction of light. They start on the plane in front of the
system or behind it, uniformly over the sample area, and end where they are absorbed or
leave the slab between both planes. Paths of large weight are split at each vertex. The
weight of each branch that leaves the slab is recorded; one of the branches that stay in
the slab continues with the total weight of these branches.

Paths carry the throughput of three channels, or of all bands of a scene whose bands
share paths (`channels`): the branches are the same in all bands, and are split and
selected by the largest throughput.

The lateral sides of the slab are open (light that leaves through a side is lost) or
periodic (a path that leaves through one side enters through the opposite side).
"""

from dataclasses import dataclass
from typing import Protocol

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.sampler import (
    CONNECT_U,
    CONNECT_V,
    DIRECTION_U,
    DIRECTION_V,
    LOBE,
    PathNumbers,
)
from clerestory.engine.unusual_lengths import scene_factor
from clerestory.engine.upload import vectors
from clerestory.engine.visibility import interaction, offset
from clerestory.scene.model import Scene
from clerestory.scene.scaling import scaled

# Paths below this fraction of their initial weight are subject to Russian roulette.
_ROULETTE = 0.5

# Number of branches of a path of full weight. For a blind, the work (time × variance)
# is near the minimum for two to four branches.
BRANCHES = 3

# Relative extension of rays beyond the sides of a cell, to hit surfaces on the sides.
_BEYOND = 1e-5

# Largest number of vertices for unlimited bounces; far more than in physical scenes.
_MOST_STEPS = 4000


@dataclass
class Slab:
    """A shading system as Mitsuba scene, and the box within which paths are traced.

    The box has two corners in translated coordinates [m]; the lower and upper plane lie
    just outside the system. If `periodic`, paths that leave through a side enter
    through the opposite side.
    """

    model: LoweredScene
    low: mi.Point3f
    high: mi.Point3f
    periodic: bool


class Receiver(Protocol):
    """An object that records the paths that leave the slab."""

    def receive(self, direction, weight, active) -> None:
        """Record the direction and the weight of each path that leaves the slab."""


@dataclass
class Step:
    """Result of tracing a ray to a surface or to a side of the periodic cell.

    `left` tells whether the ray leaves the slab. In a periodic cell, `way` is the
    distance to a side [m]; the ray continues at `origin` on the opposite side.
    """

    hit: mi.PreliminaryIntersection3f
    left: mi.Bool
    origin: mi.Point3f
    way: mi.Float


def lower_slab(scene: Scene, box: Float[np.ndarray, "2 3"], *, periodic: bool) -> Slab:
    """Return the slab of a shading system; the origin is the centre of the box [m]."""
    factor = scene_factor(scene)
    scene, box = scaled(scene, factor), box * factor
    origin = box.mean(axis=0)
    low, high = (vectors(mi.Point3f, corner[None]) for corner in box - origin)
    return Slab(lower(scene, origin=origin), low, high, periodic)


def start(slab: Slab, numbers: PathNumbers, table, cell, back) -> mi.Ray3f:
    """Return rays from random points on the plane before or behind the blind.

    Directions of travel are sampled uniformly by projected solid angle in a cell of the
    table's partition. If `back`, rays start behind the system, on the side of the room.
    """
    a, b = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
    u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
    local = table.sample(cell, u, v)
    x, y = dr.lerp(slab.low.x, slab.high.x, a), dr.lerp(slab.low.y, slab.high.y, b)
    o = mi.Point3f(x, y, dr.select(back, slab.high.z, slab.low.z))
    d = mi.Vector3f(local.x, local.y, dr.select(back, -local.z, local.z))
    return mi.Ray3f(o, d)


def _step(slab: Slab, ray: mi.Ray3f, active) -> Step:
    # Intersect a ray with the system within the slab, or within the periodic cell
    if not slab.periodic:
        hit = slab.model.scene.ray_intersect_preliminary(ray, active=active)
        return Step(hit, ~hit.is_valid(), mi.Point3f(0), mi.Float(0))
    far = mi.Point3f(dr.select(ray.d > 0, slab.high, slab.low)) - ray.o
    x = dr.select(ray.d.x == 0, dr.inf, far.x / ray.d.x)
    y = dr.select(ray.d.y == 0, dr.inf, far.y / ray.d.y)
    way = dr.maximum(dr.minimum(x, y), 0)
    ray = mi.Ray3f(ray)
    ray.maxt = way * (1 + _BEYOND) + 1e-9
    hit = slab.model.scene.ray_intersect_preliminary(ray, active=active)

    # Continue from the opposite side
    size = slab.high - slab.low
    end = ray.o + ray.d * way
    end.x -= dr.select(x < y, dr.mulsign(size.x, ray.d.x), 0)
    end.y -= dr.select(x < y, 0, dr.mulsign(size.y, ray.d.y))
    within = (end.z > slab.low.z) & (end.z < slab.high.z)
    return Step(hit, ~hit.is_valid() & ~within, end, way)


@dr.syntax
def follow(
    slab: Slab, receiver: Receiver, first: PathNumbers, ray: mi.Ray3f, limit: int
) -> None:
    """Trace paths from their first ray; the receiver records paths that leave the slab.

    `first` holds the sample numbers of each path at its start; `limit` is 1 + the
    largest number of diffuse scattering events of a path.
    """
    context, segments = mi.BSDFContext(), dr.opaque(mi.UInt32, limit)
    model = slab.model

    # ------------------------------- Loop state -------------------------------
    step = _step(slab, ray, mi.Bool(True))  # intersection of the current ray
    weight = model.uniform(1)  # throughput of the path
    receiver.receive(ray.d, weight, step.left)
    active = ~step.left  # paths within the slab
    segment = mi.UInt32(1)  # 1 + number of diffuse scattering events
    vertex = mi.UInt32(1)  # number of vertices, including the start
    travelled = mi.Float(0)  # distance from the last vertex to the last cell side [m]

    while active:
        # Prepare the path vertex, unless the ray only passes a side of the cell
        met = active & step.hit.is_valid()
        si = interaction(step.hit, ray, met)
        si.t = si.t + travelled
        bsdf, in_bands = si.bsdf(), _in_bands(model, si, met)
        numbers = first.at(vertex)
        lobe = numbers.sobol(LOBE)
        u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        chance = first.hashed(vertex + 0x10000)
        count = dr.clip(dr.ceil(dr.max(weight) * BRANCHES), 1, BRANCHES)
        count = dr.select(met, count, 1)

        # Split the path, and select one of the branches that stay in the slab
        before, grown_to, total = mi.Ray3f(ray), mi.UInt32(segment), mi.Float(0)
        next_step, kept = step, model.uniform(0)
        for number in range(BRANCHES):
            place = mi.Point2f(_turn(u, number / BRANCHES), _turn(v, number * 0.618034))
            branching = active & (number < count)
            sample, factor = bsdf.sample(
                context, si, _turn(lobe, number / BRANCHES), place, branching & met
            )
            direction = si.to_world(sample.wo)
            branch = mi.Ray3f(offset(model, si, direction, met), direction)
            if dr.hint(number == 0, mode="scalar"):
                branch.o = dr.select(met, branch.o, step.origin)
                branch.d = dr.select(met, branch.d, before.d)
            share = weight * in_bands(dr.select(met, factor, 1)) / count
            diffuse = mi.has_flag(sample.sampled_type, mi.BSDFFlags.Diffuse)
            grown = segment + dr.select(met & diffuse, mi.UInt32(1), mi.UInt32(0))
            branching &= (dr.max(share) > 0) & (grown <= segments)
            found = _step(slab, branch, branching)
            receiver.receive(branch.d, share, branching & found.left)

            # Select one branch in proportion to weight
            stays = branching & ~found.left
            bright = dr.select(stays, dr.max(share), 0)
            total += bright
            upper = bright / dr.maximum(total, 1e-30)
            chosen = stays & (chance <= upper)
            rest = (chance - upper) / dr.maximum(1 - upper, 1e-30)
            chance = dr.select(chosen, chance / dr.maximum(upper, 1e-30), rest)
            ray.o = dr.select(chosen, branch.o, ray.o)
            ray.d = dr.select(chosen, branch.d, ray.d)
            next_step = dr.select(chosen, found, next_step)
            kept = dr.select(chosen, share / bright, kept)
            grown_to = dr.select(chosen, grown, grown_to)

        # Continue with the total weight of the branches, subject to Russian roulette
        travelled = dr.select(met, 0, travelled + step.way)
        step, segment = next_step, grown_to
        survive = dr.minimum(total / _ROULETTE, 1)
        chance = first.hashed(vertex + 0x20000)
        active &= (total > 0) & (chance < survive)
        weight = kept * total / dr.maximum(survive, 1e-30)
        vertex += 1
        active &= vertex < _MOST_STEPS


def _in_bands(model: LoweredScene, si: mi.SurfaceInteraction3f, active: mi.Bool):
    # Function from the channels of a BSDF to those of the paths
    if model.throughput is None:
        return lambda value: value
    return model.throughput.at(dr.reinterpret_array(mi.UInt32, si.shape), active)


def _turn(u, shift: float):
    # Shift a number in the unit interval, modulo 1
    u = u + shift
    return u - dr.floor(u)
