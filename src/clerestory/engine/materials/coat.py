"""Reflectance of a smooth coat, which increases towards grazing angles as in Radiance.

As in Radiance, the coat reduces the diffuse component by the reflectance of the coat at
the view angle, and for direct light from luminaires and the sun (in a `lamp_context`)
also by the reflectance at the angle of incidence.
"""

import drjit as dr
import mitsuba as mi

# A smooth surface of at least this specular reflectance is treated as a dielectric
# (normal.c of Radiance, FRESTHRESH).
_THRESHOLD = 0.017999

# Radiance 6.0's approximation of Fresnel's formulas (normal.c, FRESNE):
# exp(-5.85 cos) - 0.00203
_STEEPNESS, _OFFSET = 5.85, 0.00202943064


def grazing_share(specularity, smooth, cos_theta):
    """Specular reflectance added by a smooth coat, as a fraction of 1 - specularity."""
    share = dr.exp(-_STEEPNESS * cos_theta) - _OFFSET
    return dr.select(smooth & (specularity >= _THRESHOLD), share, 0)


def lamp_context() -> mi.BSDFContext:
    """Return the BSDF context for direct light from luminaires and suns.

    The type mask selects all components; an otherwise unused flag marks the context.
    """
    mask = +mi.BSDFFlags.All | +mi.BSDFFlags.SpatiallyVarying
    return mi.BSDFContext(mi.TransportMode.Radiance, mask)


def straight_from_lamp(ctx: mi.BSDFContext) -> bool:
    """Whether a context was made by `lamp_context`."""
    return bool(ctx.type_mask & +mi.BSDFFlags.SpatiallyVarying)
