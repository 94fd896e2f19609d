"""Path vertices on surfaces and irradiance sensors, and continuation of paths.

The next direction is sampled at random either from the BSDF or towards a portal
(one-sample model of multiple importance sampling).

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
section 9.2.4.
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.engine.lower import LoweredScene
from clerestory.engine.next_event_estimation import Densities, Scattering, Vertex
from clerestory.engine.portals import Portals
from clerestory.engine.sampler import DIRECTION_U, DIRECTION_V, LOBE, PathNumbers
from clerestory.engine.visibility import offset, only_reflects

# Factor on the guiding probability at surfaces without a diffuse component.
_GLOSSY = 0.4


def sensor_vertex(
    portals: Portals | None, point: mi.Point3f, normal: mi.Vector3f
) -> Vertex:
    """Return the vertex of an irradiance sensor, with cosine-weighted response."""

    def scatter(direction, luminaire=False):
        cosine = dr.maximum(dr.dot(normal, direction), 0)
        return mi.Color3f(cosine), cosine * dr.inv_pi

    always = mi.Bool(True)
    cell, chance, densities = _guiding(portals, point, normal, mi.Float(1))
    return Vertex(
        point, lambda direction, active: point, scatter, densities, active=always,
        shape=None, flags=mi.UInt32(0), cell=cell, chance=chance,
        opaque=always, continues=always,
    )  # fmt: skip


def surface_vertex(
    model: LoweredScene,
    portals: Portals | None,
    si: mi.SurfaceInteraction3f,
    shape: mi.UInt32,
    active: mi.Bool,
    continues: mi.Bool,
    thickness: mi.Float | None = None,
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
    cell, chance, densities = _guiding(portals, si.p, facing, share)

    def leave(direction, lit):
        moved = offset(model, si, direction, lit)
        if thickness is None:
            return moved
        through = dr.dot(direction, si.n) * si.wi.z < 0
        return dr.select(through, moved - si.n * thickness, moved)

    def scatter(direction, luminaire=False):
        local = si.to_local(direction)
        return bsdf.eval_pdf(contexts[luminaire], si, local, active)

    return Vertex(
        si.p, leave, scatter, densities, active=active, shape=shape, flags=flags,
        cell=cell, chance=chance, opaque=opaque, continues=continues,
    )  # fmt: skip


def _guiding(portals: Portals | None, point, normal, share):
    # Guiding cell, guiding probability, and density function of a vertex
    if portals is None:
        zero = mi.Float(0)
        return mi.UInt32(0), zero, lambda _, own, active: Densities(own, mi.Float(0))
    cell, guided = portals.cells.number(point, normal), share > 0
    chance = share * dr.gather(mi.Float, portals.chance, cell, guided)

    def densities(direction, own, active) -> Densities:
        onward, sunlit = portals.pdf(point, cell, direction, active & guided)
        return Densities(chance * onward + (1 - chance) * own, sunlit)

    return cell, chance, densities


def continue_from_sensor(
    portals: Portals | None, vertex: Vertex, normal: mi.Vector3f, numbers: PathNumbers
) -> tuple[mi.Vector3f, mi.Color3f, Densities]:
    """Sample a direction; return it, the weight of the path, and the densities."""
    u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    direction = mi.Frame3f(normal).to_world(local)
    if portals is not None:
        guided = numbers.sobol(LOBE) < vertex.chance
        goal, _ = portals.sample(portals.share, vertex.point, vertex.cell, u, v)
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
    if portals is None:
        sample, factor = bsdf.sample(context, si, lobe, place, active)
        direction, kind = si.to_world(sample.wo), sample.sampled_type
        return Scattering(
            direction, factor, Densities(sample.pdf, mi.Float(0)), kind,
            mi.has_flag(kind, mi.BSDFFlags.Null), mi.has_flag(kind, mi.BSDFFlags.Delta),
        )  # fmt: skip

    chance = vertex.chance
    guided = lobe < chance
    rest = dr.clip((lobe - chance) / (1 - chance), 0, 0.9999999)
    goal, _ = portals.sample(portals.share, si.p, vertex.cell, u, v)
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
