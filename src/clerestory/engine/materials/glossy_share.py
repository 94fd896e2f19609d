"""Which part of a material a sampled direction is put down to.

Materials of a matt and a glossy part propose a direction by either and weigh it by the
sum of both. Where diffuse reflections are counted and cut, the count has to follow the
light and not the proposal: of the light in a direction the glossy share goes on free.
"""

import drjit as dr
import mitsuba as mi


def credited(number, glossy, matt):
    """Whether a direction is put down to the glossy part.

    Parameters
    ----------
    number : random, 0…1, not used for the direction
    glossy, matt : BSDF × cosine of both parts for the direction
    """
    strength = dr.sum(glossy)
    return (strength > 0) & (number * (strength + dr.sum(matt)) <= strength)


def glossy_context() -> mi.BSDFContext:
    """Return the context to evaluate only the glossy part of reflecting plugins in."""
    return mi.BSDFContext(mi.TransportMode.Radiance, +mi.BSDFFlags.Glossy)


def only_glossy(ctx: mi.BSDFContext) -> bool:
    """Whether the context is one of `glossy_context`."""
    return ctx.type_mask == +mi.BSDFFlags.Glossy
