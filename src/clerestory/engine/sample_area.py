"""Light transport through a piece of a shading system, from a plane before it.

Paths run with the light. They start on the plane before the front or the back of
the system, spread evenly over the sample area, and end where they leave the slab
between both planes for good, or are absorbed. At a vertex, strong paths branch:
several branches are traced for a way out, and one of those that stay within the slab
continues for all.

The slab is open at its sides, where a finite sample loses light; or it is the cell
of a repeating system: what leaves one side enters at the opposite side.
"""

from dataclasses import dataclass
from typing import Protocol

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine import sampler
from clerestory.engine.lower import lower
from clerestory.engine.primary_rays import Lanes
from clerestory.engine.sampler import Points
from clerestory.engine.visibility import offset
from clerestory.scene.model import Scene

# Paths below this share of their first weight continue only by Russian roulette.
_ROULETTE = 0.5

# Branches of a path of full weight. For a blind, work (time × variance) is least from
# two to four, and flat.
BRANCHES = 3

# Rays reach this little beyond the sides of a cell, so that surfaces there are hit.
_BEYOND = 1e-5

# Safety net for unlimited bounces: no path of a physical scene comes near it.
_MOST_STEPS = 4000


@dataclass
class Slab:
    """A lowered system with the box that paths start in and leave.

    Attributes
    ----------
    scene : the system, for Mitsuba
    first_face, reach : of the lowered scene, see `LoweredScene`
    grey : whether all materials are, so that one channel says all
    low, high : corners of the box in the device's frame [m]; its lower and upper
        plane lie just outside the system
    periodic : whether paths that leave through a side enter at the opposite one
    """

    scene: mi.Scene
    first_face: mi.UInt32
    reach: mi.Float
    grey: bool
    low: mi.Point3f
    high: mi.Point3f
    periodic: bool


class Receiver(Protocol):
    """Sink of the light that leaves the slab."""

    def receive(self, paths: Lanes, direction, weight, active) -> None:
        """Add a share of the light of each path, leaving along a direction."""


@dataclass
class Step:
    """Where a ray leads.

    Attributes
    ----------
    hit : the surface that it meets, if any
    left : whether it leaves the slab
    origin : where it continues if it only passes a side of the cell
    way : length up to there [m]
    """

    hit: mi.PreliminaryIntersection3f
    left: mi.Bool
    origin: mi.Point3f
    way: mi.Float


def lower_slab(scene: Scene, box: Float[np.ndarray, "2 3"], *, periodic: bool) -> Slab:
    """Build the device's system around the middle of the box [m]."""
    origin = box.mean(axis=0)
    low, high = (mi.Point3f(*(corner - origin).tolist()) for corner in box)
    dr.make_opaque(low, high)
    model = lower(scene, origin=origin)
    return Slab(
        model.scene, model.first_face, model.reach, model.grey, low, high, periodic
    )


def start(slab: Slab, points: Points, paths: Lanes, table, cell, back) -> mi.Ray3f:
    """Return rays from points spread evenly over the plane before a side.

    Parameters
    ----------
    table, cell : directions of travel, and the part of them to sample evenly by
        projected solid angle
    back : whether to start behind the system, from the room
    """

    def number(purpose: int):
        return sampler.coordinate(points, paths.seed, paths.index, first, purpose)

    first = mi.UInt32(0)
    a, b = number(sampler.CONNECT_U), number(sampler.CONNECT_V)
    u, v = number(sampler.DIRECTION_U), number(sampler.DIRECTION_V)
    local = table.sample(cell, u, v)
    o = mi.Point3f(
        dr.lerp(slab.low.x, slab.high.x, a),
        dr.lerp(slab.low.y, slab.high.y, b),
        dr.select(back, slab.high.z, slab.low.z),
    )
    d = mi.Vector3f(local.x, local.y, dr.select(back, -local.z, local.z))
    return mi.Ray3f(o, d)


def _step(slab: Slab, ray: mi.Ray3f, active) -> Step:
    # Find what a ray meets before it leaves the slab, or the cell
    if not slab.periodic:
        hit = slab.scene.ray_intersect_preliminary(ray, active=active)
        return Step(hit, ~hit.is_valid(), mi.Point3f(0), mi.Float(0))
    far = mi.Point3f(dr.select(ray.d > 0, slab.high, slab.low)) - ray.o
    x = dr.select(ray.d.x == 0, dr.inf, far.x / ray.d.x)
    y = dr.select(ray.d.y == 0, dr.inf, far.y / ray.d.y)
    way = dr.maximum(dr.minimum(x, y), 0)
    ray = mi.Ray3f(ray)
    ray.maxt = way * (1 + _BEYOND) + 1e-9
    hit = slab.scene.ray_intersect_preliminary(ray, active=active)

    # Enter at the opposite side
    size = slab.high - slab.low
    end = ray.o + ray.d * way
    end.x -= dr.select(x < y, dr.mulsign(size.x, ray.d.x), 0)
    end.y -= dr.select(x < y, 0, dr.mulsign(size.y, ray.d.y))
    within = (end.z > slab.low.z) & (end.z < slab.high.z)
    return Step(hit, ~hit.is_valid() & ~within, end, way)


@dr.syntax
def follow(
    slab: Slab,
    receiver: Receiver,
    points: Points,
    paths: Lanes,
    ray: mi.Ray3f,
    segments: mi.UInt32,
) -> None:
    """Follow paths from their first ray; the receiver adds up what leaves the slab.

    Parameters
    ----------
    segments : most segments between diffuse reflections or transmissions
    """
    context = mi.BSDFContext()
    seed, index = paths.seed, paths.index

    # ------------------------------- Loop state -------------------------------
    step = _step(slab, ray, mi.Bool(True))  # where the ray leads
    receiver.receive(paths, ray.d, mi.Color3f(1), step.left)
    active = ~step.left  # paths within the slab
    weight = mi.Color3f(1)  # share of the light that is still under way
    segment = mi.UInt32(1)  # segments so far between diffuse vertices
    vertex = mi.UInt32(1)  # vertices so far, the start included
    travelled = mi.Float(0)  # way since the last vertex, up to the last side [m]

    while active:
        # Prepare the vertex, if the ray has not merely passed a side
        met = active & step.hit.is_valid()
        si = step.hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, met)
        si.sh_frame = mi.Frame3f(si.n)
        si.wi = si.to_local(-ray.d)
        si.t = si.t + travelled
        bsdf = si.bsdf()
        lobe = sampler.coordinate(points, seed, index, vertex, sampler.LOBE)
        u = sampler.coordinate(points, seed, index, vertex, sampler.DIRECTION_U)
        v = sampler.coordinate(points, seed, index, vertex, sampler.DIRECTION_V)
        chance = sampler.random_number(seed, index + points.first, vertex + 0x10000)
        count = dr.clip(dr.ceil(dr.max(weight) * BRANCHES), 1, BRANCHES)
        count = dr.select(met, count, 1)

        # Branch, and choose one of the branches that stay within the slab
        before, grown_to, total = mi.Ray3f(ray), mi.UInt32(segment), mi.Float(0)
        next_step, kept = step, mi.Color3f(0)
        for number in range(BRANCHES):
            place = mi.Point2f(_turn(u, number / BRANCHES), _turn(v, number * 0.618034))
            branching = active & (number < count)
            sample, factor = bsdf.sample(
                context, si, _turn(lobe, number / BRANCHES), place, branching & met
            )
            direction = si.to_world(sample.wo)
            branch = mi.Ray3f(offset(slab, si, direction, met), direction)
            if dr.hint(number == 0, mode="scalar"):
                branch.o = dr.select(met, branch.o, step.origin)
                branch.d = dr.select(met, branch.d, before.d)
            share = weight * dr.select(met, factor, 1) / count
            diffuse = mi.has_flag(sample.sampled_type, mi.BSDFFlags.Diffuse)
            grown = segment + dr.select(met & diffuse, mi.UInt32(1), mi.UInt32(0))
            branching &= (dr.max(share) > 0) & (grown <= segments)
            found = _step(slab, branch, branching)
            receiver.receive(paths, branch.d, share, branching & found.left)

            # Choose it in proportion to its weight
            stays = branching & ~found.left
            bright = dr.select(stays, dr.max(share), 0)
            total += bright
            limit = bright / dr.maximum(total, 1e-30)
            chosen = stays & (chance <= limit)
            rest = (chance - limit) / dr.maximum(1 - limit, 1e-30)
            chance = dr.select(chosen, chance / dr.maximum(limit, 1e-30), rest)
            ray.o = dr.select(chosen, branch.o, ray.o)
            ray.d = dr.select(chosen, branch.d, ray.d)
            next_step = dr.select(chosen, found, next_step)
            kept = dr.select(chosen, share / bright, kept)
            grown_to = dr.select(chosen, grown, grown_to)

        # Continue with the weight of all branches, by Russian roulette
        travelled = dr.select(met, 0, travelled + step.way)
        step, segment = next_step, grown_to
        survive = dr.minimum(total / _ROULETTE, 1)
        chance = sampler.random_number(seed, index + points.first, vertex + 0x20000)
        active &= (total > 0) & (chance < survive)
        weight = kept * total / dr.maximum(survive, 1e-30)
        vertex += 1
        active &= vertex < _MOST_STEPS


def _turn(u, shift: float):
    # A point of the unit interval moved along it, around its ends
    u = u + shift
    return u - dr.floor(u)
