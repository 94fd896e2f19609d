"""First opaque surface along camera rays, where a pixel's irradiance is computed.

Rays pass straight through clear panes, refracting solids and proxies, as in `rpict -i`.
Emitters have no irradiance value.
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.lower import LoweredScene
from clerestory.engine.visibility import offset


@dr.syntax
def first_hit(model: LoweredScene, ray: mi.Ray3f, active: mi.Bool):
    """Trace rays to the first surface that blocks them.

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
        through = mi.has_flag(flags, mi.BSDFFlags.Null)
        through |= mi.has_flag(flags, mi.BSDFFlags.Transmission)
        through &= ~mi.has_flag(flags, mi.BSDFFlags.Smooth)
        through |= proxy
        shown = looking & ~through & ~emitter
        facing = dr.mulsign(si.n, -dr.dot(si.n, ray.d))
        point = dr.select(shown, offset(model, si, -ray.d, shown), point)
        normal = dr.select(shown, facing, normal)
        found |= shown
        looking &= through & ~emitter
        ray.o = dr.select(looking, offset(model, si, ray.d, looking), ray.o)
    return point, normal, found
