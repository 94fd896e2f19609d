"""Path vertices on surfaces and irradiance sensors, and continuation of paths.

The next direction is sampled at random from the BSDF, towards a portal, or along a cone
of focused sunlight (one-sample model of multiple importance sampling).

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
section 9.2.4.
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.engine.caustic_lobes import CausticLobes, Cones
from clerestory.engine.lower import LoweredScene
from clerestory.engine.next_event_estimation import Densities, Scattering, Vertex
from clerestory.engine.portals import Portals
from clerestory.engine.sampler import DIRECTION_U, DIRECTION_V, LOBE, PathNumbers
from clerestory.engine.visibility import offset, only_reflects

# Factor on the guiding probability at surfaces without a diffuse component.
_GLOSSY = 0.4


def sensor_vertex(
    portals: Portals | None,
    point: mi.Point3f,
    normal: mi.Vector3f,
    caustics: CausticLobes | None = None,
) -> Vertex:
    """Return the vertex of an irradiance sensor, with cosine-weighted response."""

    def scatter(direction, luminaire=False):
        cosine = dr.maximum(dr.dot(normal, direction), 0)
        return mi.Color3f(cosine), cosine * dr.inv_pi

    def faces(direction):
        return dr.dot(normal, direction) > 0

    always = mi.Bool(True)
    cones = None if caustics is None else caustics.at(point, normal, always)
    cell, chance, densities = _guiding(portals, cones, point, normal, mi.Float(1))
    return Vertex(
        point, lambda direction, active: point, faces, scatter, densities,
        active=always, shape=None, flags=mi.UInt32(0), cell=cell, chance=chance,
        opaque=always, continues=always, cones=cones,
    )  # fmt: skip


def surface_vertex(
    model: LoweredScene,
    portals: Portals | None,
    si: mi.SurfaceInteraction3f,
    shape: mi.UInt32,
    active: mi.Bool,
    continues: mi.Bool,
    thickness: mi.Float | None = None,
    caustics: CausticLobes | None = None,
) -> Vertex:
    """Return a path vertex on a surface; see `Vertex`.

    `thickness` is the thickness of the geometry that a proxy represents [m];
    transmitted rays start on the far side of the geometry.
    """
    bsdf = si.bsdf()
    contexts = {False: mi.BSDFContext(), True: materials.lamp_context()}
    flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, active)
    smooth = mi.has_flag(flags, mi.BSDFFlags.Smooth)
    opaque = only_reflects(flags)
    diffuse = mi.has_flag(flags, mi.BSDFFlags.Diffuse)
    share = dr.select(diffuse, mi.Float(1), _GLOSSY)
    share = dr.select(active & smooth & opaque, share, 0)
    facing = dr.mulsign(si.n, si.wi.z)
    cones = None if caustics is None else caustics.at(si.p, facing, share > 0)
    cell, chance, densities = _guiding(portals, cones, si.p, facing, share)

    def leave(direction, lit):
        moved = offset(model, si, direction, lit)
        if thickness is None:
            return moved
        through = dr.dot(direction, si.n) * si.wi.z < 0
        return dr.select(through, moved - si.n * thickness, moved)

    def faces(direction):
        return ~opaque | (dr.dot(facing, direction) > 0)

    def scatter(direction, luminaire=False):
        local = si.to_local(direction)
        return bsdf.eval_pdf(contexts[luminaire], si, local, active)

    bands = model.throughput
    return Vertex(
        si.p, leave, faces, scatter, densities, active=active, shape=shape,
        flags=flags, cell=cell, chance=chance, opaque=opaque, continues=continues,
        cones=cones,
        in_bands=None if bands is None else bands.at(shape, active),
    )  # fmt: skip


def _guiding(portals: Portals | None, cones: Cones | None, point, normal, share):
    # Guiding cell, guiding probability, and density function of a vertex
    cell, chance = mi.UInt32(0), mi.Float(0)
    if portals is not None:
        cell, guided = portals.cells.number(point, normal), share > 0
        chance = share * dr.gather(mi.Float, portals.chance, cell, guided)

    def densities(direction, own, active) -> Densities:
        both, sunlit = own, mi.Float(0)
        if portals is not None:
            onward, sunlit = portals.pdf(point, cell, direction, active & guided)
            both = chance * onward + (1 - chance) * own
        if cones is not None:
            focused = cones.pdf(direction, active)
            both = cones.chance * focused + (1 - cones.chance) * both
        return Densities(both, sunlit)

    return cell, chance, densities


def _chance(vertex: Vertex):
    # Probability that a direction is not sampled from the BSDF
    if vertex.cones is None:
        return vertex.chance
    return 1 - (1 - vertex.cones.chance) * (1 - vertex.chance)


def _goal(portals: Portals | None, vertex: Vertex, lobe, u, v):
    # Choose a portal or a cone of focused sunlight by `lobe`; return `lobe` rescaled
    # for the BSDF, whether one was chosen, and the direction
    guided, goal = mi.Bool(False), mi.Vector3f(0, 0, 1)
    cones = vertex.cones
    if cones is not None:
        guided = lobe < cones.chance
        focused = cones.sample(dr.clip(lobe / cones.chance, 0, 0.9999999), u, v)
        lobe = (lobe - cones.chance) / (1 - cones.chance)
    if portals is not None:
        here = lobe < vertex.chance
        goal, _ = portals.sample(portals.share, vertex.point, vertex.cell, u, v)
        lobe = (lobe - vertex.chance) / (1 - vertex.chance)
        if cones is None:
            return dr.clip(lobe, 0, 0.9999999), here, goal
        goal = dr.select(guided, focused, goal)
        return dr.clip(lobe, 0, 0.9999999), guided | here, goal
    return dr.clip(lobe, 0, 0.9999999), guided, focused


def continue_from_sensor(
    portals: Portals | None, vertex: Vertex, normal: mi.Vector3f, numbers: PathNumbers
) -> tuple[mi.Vector3f, mi.Color3f, Densities]:
    """Sample a direction; return it, the weight of the path, and the densities."""
    u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    direction = mi.Frame3f(normal).to_world(local)
    if portals is not None or vertex.cones is not None:
        _, guided, goal = _goal(portals, vertex, numbers.sobol(LOBE), u, v)
        direction = dr.select(guided, goal, direction)
    value, own = vertex.scatter(direction)
    densities = vertex.densities(direction, own, mi.Bool(True))
    weight = dr.select(densities.path > 0, value / densities.path, 0)
    return direction, weight, densities


def continue_from_surface(
    portals: Portals | None,
    vertex: Vertex,
    si: mi.SurfaceInteraction3f,
    numbers: PathNumbers,
    active: mi.Bool,
    *,
    split_lobes: bool,
) -> Scattering:
    """Sample the continuation of a path at a surface, from the BSDF or to a portal.

    With `split_lobes`, a direction to a portal counts as diffuse with the probability
    of the diffuse fraction of the BSDF value. This affects results if diffuse bounces
    are few, and costs a BSDF evaluation.
    """
    context, bsdf = mi.BSDFContext(), si.bsdf()
    lobe, u, v = (numbers.sobol(n) for n in (LOBE, DIRECTION_U, DIRECTION_V))
    place = mi.Point2f(u, v)
    if portals is None and vertex.cones is None:
        sample, factor = bsdf.sample(context, si, lobe, place, active)
        direction, kind = si.to_world(sample.wo), sample.sampled_type
        return Scattering(
            direction, factor, Densities(sample.pdf, mi.Float(0)), kind,
            mi.has_flag(kind, mi.BSDFFlags.Null), mi.has_flag(kind, mi.BSDFFlags.Delta),
        )  # fmt: skip

    rest, guided, goal = _goal(portals, vertex, lobe, u, v)
    value, own, sample, factor = bsdf.eval_pdf_sample(
        context, si, si.to_local(goal), rest, place, active
    )
    direction = dr.select(guided, goal, si.to_world(sample.wo))
    value = dr.select(guided, value, factor * sample.pdf)
    own = dr.select(guided, own, sample.pdf)
    kind: mi.UInt32 = sample.sampled_type
    null = ~guided & mi.has_flag(kind, mi.BSDFFlags.Null)
    delta = ~guided & mi.has_flag(kind, mi.BSDFFlags.Delta) & ~null
    densities = vertex.densities(direction, own, active)
    both = dr.select(densities.path > 0, value / densities.path, 0)
    chance = _chance(vertex)
    mixed = chance > 0
    factor = dr.select(mixed & ~delta, both, factor / (1 - chance))
    densities.path = dr.select(mixed, densities.path, sample.pdf)
    kind = dr.select(guided, vertex.flags, kind)
    if split_lobes:
        glossy = bsdf.eval(
            materials.glossy_context(), si, si.to_local(direction), active & guided
        )
        free = materials.credited(numbers.extra(11), glossy, value - glossy)
        kind = dr.select(guided & free, mi.UInt32(0), kind)
    return Scattering(direction, factor, densities, kind, null, delta)
