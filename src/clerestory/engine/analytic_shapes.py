"""Spheres and cylinders as Mitsuba's analytic shapes, with exact normals.

Highlights and refraction depend on the normal, so facets would be visible. Emitters
and proxies stay tessellated, since they are tabulated by triangle.
"""

from dataclasses import replace

import mitsuba as mi

from clerestory.engine.origin import Origin
from clerestory.scene.model import BsdfSurface, Cone, Emitter, Material, Scene, Sphere


def without_analytic(scene: Scene) -> tuple[Scene, tuple[Sphere | Cone, ...]]:
    """Return a scene without analytic shapes, and the analytic shapes removed."""
    exact, left = [], []
    for surface in scene.surfaces:
        curved = isinstance(surface, Sphere | Cone)
        if curved and _is_analytic(surface, scene.materials[surface.material]):
            exact.append(surface)
        else:
            left.append(surface)
    return replace(scene, surfaces=tuple(left)) if exact else scene, tuple(exact)


def analytic_shape(surface: Sphere | Cone, bsdf: mi.BSDF, origin: Origin) -> mi.Shape:
    """Return the Mitsuba shape of a sphere or cylinder."""
    shared = {"flip_normals": surface.inward, "bsdf": bsdf}
    if isinstance(surface, Sphere):
        centre = (surface.centre - origin).tolist()
        ball = {"type": "sphere", "center": centre, "radius": float(surface.radius)}
        return mi.load_dict(ball | shared)
    tube = {
        "type": "cylinder",
        "p0": (surface.base - origin).tolist(),
        "p1": (surface.top - origin).tolist(),
        "radius": float(surface.base_radius),
    }
    # Suppress Mitsuba's warnings of shear, caused by rounding in long oblique tubes
    level = mi.log_level()
    mi.set_log_level(mi.LogLevel.Error)
    try:
        return mi.load_dict(tube | shared)
    finally:
        mi.set_log_level(level)


def _is_analytic(surface: Sphere | Cone, material: Material) -> bool:
    if isinstance(material, Emitter):
        return False
    if isinstance(material, BsdfSurface) and material.thickness:
        return False
    return isinstance(surface, Sphere) or surface.base_radius == surface.top_radius
