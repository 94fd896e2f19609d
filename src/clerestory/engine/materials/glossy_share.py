"""Classification of sampled directions as diffuse or glossy scattering.

A material with a diffuse and a glossy component samples a direction from one component,
and weights it by the sum of both components. If the number of diffuse reflections is
limited, a direction counts as diffuse with a probability equal to the diffuse fraction
of the BSDF value, whichever component was sampled.
"""

import drjit as dr
import mitsuba as mi


def credited(number, glossy, matt):
    """Whether a direction is classified as glossy.

    The random number, 0…1, is independent of the direction; `glossy` and `matt` are
    BSDF × cosine of the glossy and of the diffuse component.
    """
    strength = dr.sum(glossy)
    return (strength > 0) & (number * (strength + dr.sum(matt)) <= strength)


def glossy_context() -> mi.BSDFContext:
    """Return the BSDF context that evaluates the glossy component only."""
    return mi.BSDFContext(mi.TransportMode.Radiance, +mi.BSDFFlags.Glossy)


def only_glossy(ctx: mi.BSDFContext) -> bool:
    """Whether a context was made by `glossy_context`."""
    return ctx.type_mask == +mi.BSDFFlags.Glossy
