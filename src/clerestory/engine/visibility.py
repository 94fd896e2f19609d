"""Visibility and transmittance along shadow rays.

Shadow rays pass materials with unscattered transmission, such as glass, and are
multiplied by their transmittance. Proxies (BSDFs with a thickness) are treated as in
Radiance's BSDF material: view rays and direct rays pass through to the geometry
behind; indirect rays are scattered by the BSDF if they arrive at its front (positive
thickness) or back (negative thickness).
"""

from collections.abc import Callable

import drjit as dr
import mitsuba as mi

from clerestory.engine.lower import LoweredScene

ShadowRay = Callable[[mi.Point3f], mi.Ray3f]

# Offset of ray origins relative to coordinates: multiple of the float32 step, 6·10⁻⁸.
ROUNDING = 4e-6


def offset(model: LoweredScene, si, direction, active):
    """Return the hit point, offset from the surface towards a direction.

    The offset is a few float32 roundings of face coordinates or of the ray length,
    whichever is larger: more than the rounding error of intersections, yet small
    against millimetre slats in a room.
    """
    shape = dr.reinterpret_array(mi.UInt32, si.shape)
    face = dr.gather(mi.UInt32, model.first_face, shape, active) + si.prim_index
    reach = dr.maximum(dr.gather(mi.Float, model.reach, face, active), si.t)
    step = ROUNDING * dr.maximum(reach, 0.05)
    return si.p + si.n * dr.mulsign(step, dr.dot(si.n, direction))


def interaction(hit: mi.PreliminaryIntersection3f, ray: mi.Ray3f, active):
    """Return the surface interaction of a hit, in the frame of its geometric normal."""
    si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, active)
    si.sh_frame = mi.Frame3f(si.n)
    si.wi = si.to_local(-ray.d)
    return si


def only_reflects(flags: mi.UInt32) -> mi.Bool:
    """Whether BSDF flags are those of an opaque material."""
    passes = mi.has_flag(flags, mi.BSDFFlags.Null)
    return ~(passes | mi.has_flag(flags, mi.BSDFFlags.Transmission))


def along(direction: mi.Vector3f) -> ShadowRay:
    """Return a function from origins to rays in a direction."""
    return lambda origin: mi.Ray3f(origin, direction)


def towards(point: mi.Point3f) -> ShadowRay:
    """Return a function from origins to rays that end just before a point."""

    def ray_from(origin):
        across = point - origin
        distance = dr.norm(across)
        ray = mi.Ray3f(origin, across / distance)
        # End just before the point
        ray.maxt = distance * (1 - 1e-5) - 1e-5
        return ray

    return ray_from


def passes_proxy(thickness, cosine):
    """Whether an indirect ray passes a surface: a proxy hit on the non-scattering side.

    `thickness` [m] is nonzero for proxies only; `cosine` is the cosine of the angle
    between the normal and the reversed ray.
    """
    return (thickness != 0) & ((thickness > 0) != (cosine > 0))


def transmittance(
    model: LoweredScene,
    origin: mi.Point3f,
    shadow_ray: ShadowRay,
    active: mi.Bool,
    *,
    direct: bool = True,
    through_illums: bool = False,
) -> mi.Color3f:
    """Return the unscattered transmittance along shadow rays, by channel.

    `shadow_ray` is a function from a point to the ray towards the light source. If
    `direct`, rays pass proxies; otherwise, a proxy blocks rays that it scatters. With
    `through_illums`, illums transmit like their alternate material: rays to suns need
    this, as the radiance distributions of illums exclude suns.
    """
    if not model.panes:
        blocked = model.scene.ray_test(shadow_ray(origin), active)
        return dr.select(active & blocked, mi.Color3f(0), 1)
    share, _, hit = _through_panes(
        model, origin, shadow_ray, active, direct=direct, through_illums=through_illums
    )
    return dr.select(active & hit.is_valid(), 0, share)


def first_opaque(
    model: LoweredScene, origin: mi.Point3f, shadow_ray: ShadowRay, active: mi.Bool
):
    """Trace shadow rays to the first surface that blocks them; see `transmittance`.

    Return the transmittance to the surface, the last ray segment, and the hit.
    """
    if not model.panes:
        # No panes: avoid the loop over panes, which costs time
        ray = shadow_ray(origin)
        hit = model.scene.ray_intersect_preliminary(ray, active=active)
        return mi.Color3f(1), ray, hit
    return _through_panes(model, origin, shadow_ray, active)


@dr.syntax
def _through_panes(
    model: LoweredScene,
    origin: mi.Point3f,
    shadow_ray: ShadowRay,
    active: mi.Bool,
    direct: bool = True,
    through_illums: bool = False,
):
    # As `first_opaque`, for a scene with panes
    ray = shadow_ray(origin)
    share = mi.Color3f(1)
    looking = mi.Bool(active)
    hit = dr.zeros(mi.PreliminaryIntersection3f)
    while looking:
        hit = model.scene.ray_intersect_preliminary(ray, active=looking)
        met = looking & hit.is_valid()
        shape = dr.reinterpret_array(mi.UInt32, hit.shape)
        emitter = dr.gather(mi.UInt32, model.emitter_of_shape, shape, met)
        opaque = emitter > 0
        if dr.hint(through_illums, mode="scalar"):
            opaque &= ~dr.gather(mi.Bool, model.emitters.illum, emitter - 1, opaque)
        flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, met)
        pane = met & mi.has_flag(flags, mi.BSDFFlags.Null) & ~opaque
        proxy = mi.Bool(False)
        if dr.hint(model.proxies, mode="scalar"):
            depth = dr.gather(mi.Float, model.thickness_of_shape, shape, met)
            proxy = met & (depth != 0)
        si = interaction(hit, ray, pane | proxy)
        if dr.hint(model.proxies and not direct, mode="scalar"):
            proxy &= passes_proxy(depth, -dr.dot(si.n, ray.d))
        pane &= ~proxy
        through = si.bsdf().eval_null_transmission(si, pane)
        share = dr.select(pane, share * through, share)
        looking = (pane | proxy) & (dr.max(share) > 0)
        start = offset(model, si, ray.d, looking)
        onward = shadow_ray(dr.select(looking, start, ray.o))
        ray.o = dr.select(looking, onward.o, ray.o)
        ray.d = dr.select(looking, onward.d, ray.d)
        ray.maxt = dr.select(looking, onward.maxt, ray.maxt)
    return share, ray, hit


@dr.syntax
def first_hit(model: LoweredScene, ray: mi.Ray3f, active: mi.Bool):
    """Trace rays of an irradiance picture to the first surface that blocks them.

    As in `rpict -i`, rays pass straight through clear panes, refracting solids and
    proxies. Emitters have no irradiance.

    Return the point, offset from the surface towards the eye, the normal towards the
    eye, and whether a surface was found.
    """
    point, normal = mi.Point3f(0), mi.Vector3f(0, 0, 1)
    found = mi.Bool(False)
    looking = mi.Bool(active)
    while looking:
        hit = model.scene.ray_intersect_preliminary(ray, active=looking)
        looking &= hit.is_valid()
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, looking)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        emitter = dr.gather(mi.UInt32, model.emitter_of_shape, shape, looking) > 0
        proxy = dr.gather(mi.Float, model.thickness_of_shape, shape, looking) != 0
        flags = si.bsdf().flags()
        through = ~only_reflects(flags) & ~mi.has_flag(flags, mi.BSDFFlags.Smooth)
        through |= proxy
        shown = looking & ~through & ~emitter
        facing = dr.mulsign(si.n, -dr.dot(si.n, ray.d))
        point = dr.select(shown, offset(model, si, -ray.d, shown), point)
        normal = dr.select(shown, facing, normal)
        found |= shown
        looking &= through & ~emitter
        ray.o = dr.select(looking, offset(model, si, ray.d, looking), ray.o)
    return point, normal, found
