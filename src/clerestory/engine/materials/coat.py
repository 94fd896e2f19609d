"""What a smooth coat reflects: more towards grazing angles, as Radiance has it.

Radiance lets the coat weaken diffuse light by what it reflects at the angle of view,
and light that comes straight from lamps and sun also by what it reflects at theirs.
Plugins do the latter where they are asked by `lamp_context`.
"""

import drjit as dr
import mitsuba as mi

# A purely specular surface of at least this reflectance counts as a dielectric
# (normal.c of Radiance, FRESTHRESH).
_THRESHOLD = 0.017999

# Radiance 6.0's stand-in for Fresnel's formulas, exp(-5.85 cos) - c (normal.c, FRESNE)
_STEEPNESS, _OFFSET = 5.85, 0.00202943064


def grazing_share(specularity, smooth, cos_theta):
    """Share that a smooth coat adds to what the specularity leaves, 0…1."""
    share = dr.exp(-_STEEPNESS * cos_theta) - _OFFSET
    return dr.select(smooth & (specularity >= _THRESHOLD), share, 0)


def lamp_context() -> mi.BSDFContext:
    """Return the context to evaluate light in that comes straight from lamps or sun.

    It asks for all parts of a BSDF, and for one that has no meaning as a part.
    """
    mask = +mi.BSDFFlags.All | +mi.BSDFFlags.SpatiallyVarying
    return mi.BSDFContext(mi.TransportMode.Radiance, mask)


def straight_from_lamp(ctx: mi.BSDFContext) -> bool:
    """Whether the context is one of `lamp_context`."""
    return bool(ctx.type_mask & +mi.BSDFFlags.SpatiallyVarying)
