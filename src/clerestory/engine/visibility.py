"""Visibility and transmittance along shadow rays.

Shadow rays pass panes of glass and other materials that transmit light unscattered,
with their transmittance. Proxies (BSDFs with a thickness) are treated as Radiance's
BSDF material treats them: view rays and direct rays pass and see the geometry behind,
indirect rays meet the BSDF on its front (positive thickness) or back (negative).
"""

from collections.abc import Callable

import drjit as dr
import mitsuba as mi

from clerestory.engine.lower import LoweredScene

ShadowRay = Callable[[mi.Point3f], mi.Ray3f]

# Offset from a surface, relative to coordinates: some float32 steps of 6·10⁻⁸.
ROUNDING = 4e-6


def offset(model: LoweredScene, si, direction, active):
    """Return the hit point moved off its surface to the side a direction goes to.

    A few float32 steps of the face's coordinates and of the distance travelled:
    enough to clear the rounding of intersections, small against millimetre slats in a
    room, and more on a ground that reaches to the horizon.
    """
    shape = dr.reinterpret_array(mi.UInt32, si.shape)
    face = dr.gather(mi.UInt32, model.first_face, shape, active) + si.prim_index
    reach = dr.maximum(dr.gather(mi.Float, model.reach, face, active), si.t)
    step = ROUNDING * dr.maximum(reach, 0.05)
    return si.p + si.n * dr.mulsign(step, dr.dot(si.n, direction))


def towards(origin, point) -> mi.Ray3f:
    """Return a ray that ends just before a point, also from a moved start."""
    across = point - origin
    distance = dr.norm(across)
    ray = mi.Ray3f(origin, across / distance)
    ray.maxt = distance * (1 - 1e-5) - 1e-5
    return ray


def passes_proxy(thickness, cosine):
    """Whether an indirect ray passes a surface: a proxy met on the side it hides.

    Parameters
    ----------
    thickness : of the surface's BSDF, 0 for all but proxies [m]
    cosine : between the normal and the reversed ray
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
    """Return the share of light that arrives unscattered, by channel.

    Parameters
    ----------
    shadow_ray : function that returns the ray from a point to where light comes from
    direct : whether the rays pass proxies, as direct rays do; indirect rays are
        blocked where the BSDF scatters them
    through_illums : whether illums let light pass like their alternate material: that
        of suns, which their distributions do not contain
    """
    if not model.panes:
        blocked = model.scene.ray_test(shadow_ray(origin), active)
        return dr.select(active & blocked, mi.Color3f(0), 1)
    share, _, hit = first_opaque(
        model, origin, shadow_ray, active, direct=direct, through_illums=through_illums
    )
    return dr.select(active & hit.is_valid(), 0, share)


@dr.syntax
def first_opaque(
    model: LoweredScene,
    origin: mi.Point3f,
    shadow_ray: ShadowRay,
    active: mi.Bool,
    direct: bool = True,
    through_illums: bool = False,
):
    """Follow shadow rays to the first surface that blocks them; see `transmittance`.

    Returns
    -------
    share : of light that passes up to there, by channel
    ray, hit : last part of the shadow ray, and what it meets
    """
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
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, pane | proxy)
        if dr.hint(model.proxies and not direct, mode="scalar"):
            proxy &= passes_proxy(depth, -dr.dot(si.n, ray.d))
        si.sh_frame = mi.Frame3f(si.n)
        si.wi = si.to_local(-ray.d)
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
