"""`radiance_plastic`: plastic and metal, isotropic or anisotropic.

    {"type": "radiance_plastic", "reflectance": [0.5, 0.4, 0.3], "specularity": 0.05,
     "roughness": 0.1}

`metallic` gives the highlight the colour of the reflectance; `roughness_v` and `up`
make it anisotropic, with `roughness` along `up`. At roughness zero, the highlight is a
mirror reflection, whose reflectance increases towards grazing angles.

As in Radiance, a smooth coat reduces the diffuse component according to the view
angle, and for direct light from luminaires and the sun also according to the angle of
incidence (`coat.lamp_context`). For other light, the BRDF is not reciprocal.
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.coat import grazing_share, straight_from_lamp
from clerestory.engine.materials.glossy_share import credited, only_glossy
from clerestory.engine.materials.highlight import Highlight, vary_highlight
from clerestory.engine.materials.properties import Paint, number
from clerestory.engine.materials.queries import (
    completed,
    either,
    eval_pdf_of_parts,
    mirror_sample,
    only_mirrored,
    sampled,
    set_components,
    upwards,
)

PLUGIN = "radiance_plastic"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(reflectance="paint.colour", specularity="specularity")
    class RadiancePlastic(mi.BSDF):
        """Diffuse and specular reflection, alike on both sides."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.paint = Paint(props, "reflectance", 0.5)
            self.specularity = number(props, "specularity", 0.0)
            self.metallic = number(props, "metallic", False)
            self.highlight = Highlight(props)
            glossy = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.DeltaReflection
            set_components(self, mi.BSDFFlags.DiffuseReflection, glossy)

        def shares(self, si, cos_theta):
            """Diffuse and specular reflectance, and probability of the highlight."""
            added = grazing_share(self.specularity, self.highlight.smooth, cos_theta)
            rest = 1 - self.specularity
            colour = self.paint.at(si)
            tint = 1 - self.metallic * (1 - colour)
            specular = tint * (self.specularity * (1 - added)) + added
            diffuse = colour * (rest * (1 - added))
            strength = dr.max(specular)
            chance = strength / (strength + dr.max(diffuse))
            return diffuse, specular, dr.select(strength > 0, chance, 0)

        def parts(self, ctx, si, wi, wo, active):
            """Diffuse and glossy BRDF × cosine, and pdf, without delta reflection."""
            active = active & (wi.z > 0) & (wo.z > 0)
            diffuse, specular, chance = self.shares(si, wi.z)
            value, pdf = self.highlight.reflected(self.highlight.at(si), wi, wo)
            peak = self.highlight.smooth
            value = dr.select(peak, 0, value * wo.z) * specular
            if straight_from_lamp(ctx):
                diffuse *= 1 - grazing_share(self.specularity, peak, wo.z)
            matt = diffuse * (0 if only_glossy(ctx) else dr.inv_pi * wo.z)
            pdf = dr.select(peak, 0, pdf * chance) + (1 - chance) * dr.inv_pi * wo.z
            return tuple(dr.select(active, each, 0) for each in (matt, value, pdf))

        def sample(self, ctx, si, sample1, sample2, active=True):
            wi = upwards(si)
            _, specular, chance = self.shares(si, wi.z)
            if only_mirrored(ctx):
                flat = dr.select(self.highlight.smooth, specular, 0)
                return mirror_sample(si, flat, active & (wi.z > 0))
            shiny = sample1 < chance
            peak = shiny & self.highlight.smooth

            # Sample a reflection about a microfacet, or a diffuse direction
            shape = self.highlight.at(si)
            lobe = self.highlight.sample_reflected(shape, wi, sample2)
            even = mi.warp.square_to_cosine_hemisphere(sample2)
            wo = dr.select(shiny, lobe, even)
            matt, glossy, pdf = self.parts(ctx, si, wi, wo, active)
            weight = dr.select(peak, specular / chance, (matt + glossy) / pdf)
            pdf = dr.select(peak, chance, pdf)
            valid = active & (wo.z > 0) & (wi.z > 0) & (pdf > 0)

            # Classify the direction as glossy or diffuse by both BSDF components
            rest = (sample1 - chance) / (1 - chance)
            again = dr.select(shiny, sample1 / chance, rest)
            shiny = peak | credited(again, glossy, matt)

            flags = mi.BSDFFlags
            kind = either(peak, flags.DeltaReflection, flags.GlossyReflection)
            kind = dr.select(shiny, kind, mi.UInt32(+flags.DiffuseReflection))
            wo = mi.Vector3f(wo.x, wo.y, wo.z * dr.sign(si.wi.z))
            bs = sampled(wo, dr.select(valid, pdf, 0), kind, shiny)
            return bs, dr.select(valid, weight, 0)

        eval_pdf = eval_pdf_of_parts

    return RadiancePlastic


vary = vary_highlight
