"""Radiance along rays: a picture's pixels, or what a sensor gathers.

Paths run against the light. At every vertex suns and emitters are sampled (see
`next_event_estimation`).
The path goes on in a direction proposed by the material or by a place where light
enters the room (`portals`), one sample from both in mixture.

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation,
1997, chapter 9 (one-sample model).
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials, sampler
from clerestory.engine.mirrors import is_mirror
from clerestory.engine.next_event_estimation import (
    Draw,
    LitScene,
    PortalAim,
    SunAim,
    Vertex,
    at_surface,
    is_sought,
    lamplight,
    mirrored_sunlight,
    seeks,
    share_of_portals,
    share_of_sun,
    sought_pdf,
    sought_sunlight,
    sunlight,
)
from clerestory.engine.sampler import Points
from clerestory.engine.walk import offset

# Paths below this share of their first weight go on only by Russian roulette.
_ROULETTE = 0.2

_MOST_SEGMENTS = 1000

# For paths that begin where nothing was sought.
NOTHING = -1.0


def gather_at_sensor(lit: LitScene, draw: Draw, position, normal):
    """Begin at an irradiance sensor.

    Returns
    -------
    light : irradiance from what is aimed at directly
    ray, weight, pdf, sought : how the path goes on, as `path_tracer` takes it
    """

    def scatter(direction):
        cosine = dr.maximum(dr.dot(normal, direction), 0)
        return mi.Color3f(cosine), cosine * dr.inv_pi

    portal = PortalAim.of(lit, position, normal, mi.Float(1))
    vertex = Vertex(position, lambda d, a: position, scatter, portal)
    light = lamplight(lit, vertex, draw, mi.Bool(True))
    if lit.sky.suns:
        sun = SunAim.of(lit, draw)
        light += sunlight(lit, vertex, sun, mi.Bool(True))
        light += mirrored_sunlight(lit, vertex, draw, mi.Bool(True))
        if seeks(lit):
            light += sought_sunlight(lit, vertex, sun, draw, mi.Bool(True))
    u, v = draw.number(sampler.DIRECTION_U), draw.number(sampler.DIRECTION_V)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    direction = mi.Frame3f(normal).to_world(local)
    if lit.portals.count:
        aimed = draw.number(sampler.LOBE) < portal.chance
        target = lit.portals.aim(lit.portals.share, position, portal.cell, u, v)
        direction = dr.select(aimed, target, direction)
    value, own = scatter(direction)
    onward, sought = vertex.portal_pdf(lit, direction, mi.Bool(True))
    pdf = vertex.mixture(onward, own)
    weight = dr.select(pdf > 0, value / pdf, 0)
    return light, mi.Ray3f(position, direction), weight, pdf, sought


@dr.syntax
def look(
    lit: LitScene,
    points: Points,
    ray: mi.Ray3f,
    seed: mi.UInt32,
    index: mi.UInt32,
    weight: mi.Color3f,
    pdf: mi.Float,
    sought: mi.Float,
    sharp: mi.Bool,
    segments: mi.UInt32,
    active: mi.Bool,
    *,
    parted: bool,
):
    """Follow paths until they end; return the light each brings [W/(m²·sr)].

    Parameters
    ----------
    ray : first segment of each path
    weight : what its light counts
    pdf : of the first direction; 0: nothing was aimed at from its origin
    sought : density with which what suns light was sought at portals along it;
        `NOTHING` where it was not sought from its origin
    sharp : whether the eye looks along the first segment
    segments : most segments between diffuse scattering
    parted : whether of directions to portals the glossy share is not counted as
        diffuse, which only matters where `segments` are few; a BSDF call more
    """
    model = lit.model
    scene = model.scene
    context, straight = mi.BSDFContext(), materials.lamp_context()
    shiny = materials.glossy_context()
    weight = mi.Color3f(weight)

    # ------------------------------- Loop state -------------------------------
    light = mi.Color3f(0)  # gathered so far
    origin = mi.Point3f(ray.o)  # last vertex at which lights were aimed at
    start = dr.maximum(dr.max(weight), 1e-20)  # weight that roulette compares with
    segment = mi.UInt32(1)  # segments between diffuse scattering, this one included
    vertex = mi.UInt32(1)  # vertices so far, the start included
    # Mirrors since a vertex at which suns were aimed at; 2: more, or something else
    relay = dr.select(pdf > 0, mi.UInt32(0), mi.UInt32(2))
    looked = mi.Bool(sought >= 0)  # whether the last vertex sought what suns light

    while active:
        hit = scene.ray_intersect_preliminary(ray, active=active)
        met = active & hit.is_valid()

        # Take what shines at infinity; suns are shared with the direct aim, and those
        # in mirrors left to it
        escaped = active & ~met
        sky = lit.sky.radiance_of_dome(ray.d)
        sun, aim = lit.sky.radiance_of_suns(ray.d, escaped)
        share = dr.select(pdf > 0, share_of_sun(pdf, aim), 1)
        share = dr.select(relay == 1, 0, share)
        light += dr.select(escaped, weight * (sky + sun * share), 0)

        # Take what a lamp sends from its front; the eye sees illums as something else
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, met)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        role = dr.gather(mi.UInt32, model.emitter_of_shape, shape, met)
        at_lamp = met & (role > 0)
        cosine = -dr.dot(ray.d, si.n)
        lamp = role - 1
        veiled = dr.gather(mi.Bool, model.lamps.veiled, lamp, at_lamp)
        shy = dr.gather(mi.Bool, model.lamps.shy, lamp, at_lamp)
        at_lamp &= ~(veiled & (sharp | (cosine <= 0)))
        shining = at_lamp & (cosine > 0) & (sharp | ~shy)
        sent = model.lamps.emitted(lamp, -ray.d, shining)
        aim = model.lamps.pdf(lamp, dr.squared_norm(si.p - origin), cosine, shining)
        share = dr.select(pdf > 0, pdf / (pdf + aim), 1)
        light += dr.select(shining, weight * sent * share, 0)

        # Pass what only stands for geometry and shows it to the eye
        active = met & ~at_lamp
        depth = dr.gather(mi.Float, model.thickness_of_shape, shape, active)
        ignored = (depth != 0) & (sharp | ((depth > 0) != (cosine > 0)))

        # Prepare the vertex: its frame and its material
        si.sh_frame = mi.Frame3f(si.n)
        si.wi = si.to_local(-ray.d)
        bsdf = si.bsdf()
        works = active & ~ignored
        flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, works)
        smooth = mi.has_flag(flags, mi.BSDFFlags.Smooth)
        opaque = ~mi.has_flag(flags, mi.BSDFFlags.Null)
        opaque &= ~mi.has_flag(flags, mi.BSDFFlags.Transmission)
        draw = Draw(points, seed, index, vertex)
        facing = dr.mulsign(si.n, cosine)
        share = share_of_portals(flags, works & smooth & opaque)
        portal = PortalAim.of(lit, si.p, facing, share)
        aimed = portal.chance
        place = at_surface(model, si, straight, depth, works, portal)

        # Aim at suns and lamps
        near = works & smooth & (segment <= segments)
        gained = lamplight(lit, place, draw, near)
        matt = near & opaque & (segment < segments)
        if dr.hint(lit.sky.suns > 0, mode="scalar"):
            sun = SunAim.of(lit, draw)
            direct = sunlight(lit, place, sun, near)
            if dr.hint(seeks(lit), mode="scalar"):
                shared = looked & (pdf > 0) & is_sought(model, shape, near)
                aim = sought_pdf(lit, sun, ray.d, sought)
                direct *= dr.select(shared, pdf / (pdf + aim), 1)
                gained += sought_sunlight(lit, place, sun, draw, matt)
            gained += direct + mirrored_sunlight(lit, place, draw, near)
        light += dr.select(near, weight * gained, 0)

        # Go on along the material's proposal, or towards a portal
        chance = draw.number(sampler.LOBE)
        u = draw.number(sampler.DIRECTION_U)
        v = draw.number(sampler.DIRECTION_V)
        to_portal = chance < aimed
        lobe = dr.clip((chance - aimed) / (1 - aimed), 0, 0.9999999)
        if dr.hint(lit.portals.count > 0, mode="scalar"):
            target = lit.portals.aim(lit.portals.share, si.p, portal.cell, u, v)
            value, own, sample, factor = bsdf.eval_pdf_sample(
                context, si, si.to_local(target), lobe, mi.Point2f(u, v), works
            )
            direction = dr.select(to_portal, target, si.to_world(sample.wo))
            value = dr.select(to_portal, value, factor * sample.pdf)
            own = dr.select(to_portal, own, sample.pdf)
        else:
            sample, factor = bsdf.sample(context, si, lobe, mi.Point2f(u, v), works)
            direction = si.to_world(sample.wo)
            value, own = factor * sample.pdf, sample.pdf
        kind = sample.sampled_type
        null = ~to_portal & mi.has_flag(kind, mi.BSDFFlags.Null) | ignored
        delta = ~to_portal & mi.has_flag(kind, mi.BSDFFlags.Delta) & ~null
        onward, sought = place.portal_pdf(lit, direction, works)
        mixed = place.mixture(onward, own)
        both = dr.select(mixed > 0, value / mixed, 0)
        spread = aimed > 0
        kept = dr.select(spread & ~delta, both, factor / (1 - aimed))
        weight *= dr.select(ignored, 1, kept)
        direction = dr.select(ignored, ray.d, direction)
        scattered = dr.select(to_portal, flags, kind)
        if dr.hint(parted, mode="scalar"):
            way = si.to_local(direction)
            glossy = bsdf.eval(shiny, si, way, works & to_portal)
            free = materials.credited(draw.other(11), glossy, value - glossy)
            scattered = dr.select(to_portal & free, mi.UInt32(0), scattered)
        diffuse = ~null & ~delta & mi.has_flag(scattered, mi.BSDFFlags.Diffuse)
        origin = dr.select(null, origin, si.p)
        leave = offset(model, si, direction, active)
        through = ~null & (dr.dot(direction, si.n) * cosine < 0)
        leave = dr.select(through, leave - si.n * depth, leave)
        ray = mi.Ray3f(leave, direction)
        density = dr.select(spread, mixed, sample.pdf)
        pdf = dr.select(null, pdf, dr.select(delta, 0, density))
        sharp &= null | delta
        looked = matt & ~null & ~delta
        if dr.hint(lit.mirrors.count > 0, mode="scalar"):
            known = lit.mirrors.holds(si.n, works & delta & is_mirror(bsdf))
            once = dr.select(known & (relay == 0), mi.UInt32(1), mi.UInt32(2))
            relay = dr.select(null, relay, dr.select(delta, once, mi.UInt32(0)))
        segment += dr.select(diffuse, mi.UInt32(1), mi.UInt32(0))
        active &= (dr.max(weight) > 0) & (segment <= segments)

        # Let weak paths go on only by chance, then with the weight of those that end
        survive = dr.minimum(dr.max(weight) / (start * _ROULETTE), 1)
        number = sampler.random_number(seed, index + points.first, vertex + 0x10000)
        weight = dr.select(survive < 1, weight / survive, weight)
        active &= (number < survive) & (vertex < _MOST_SEGMENTS)
        vertex += 1

    return light
