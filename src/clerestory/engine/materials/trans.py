"""`radiance_trans`: translucent sheets, isotropic or anisotropic.

    {"type": "radiance_trans", "reflectance": [0.9, 0.9, 0.9], "specularity": 0.05,
     "roughness": 0.1, "transmission": 0.6, "transmitted_specular": 0.5}

Of the light not reflected specularly, the fraction `transmission` is transmitted. Of
the transmitted light, the fraction `transmitted_specular` is specular: a lobe, or at
roughness zero direct transmission, also of shadow rays. For the other parameters
see `radiance_plastic`.
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.coat import grazing_share, straight_from_lamp
from clerestory.engine.materials.glossy_share import credited
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

PLUGIN = "radiance_trans"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(
        reflectance="paint.colour",
        specularity="specularity",
        transmission="transmission",
        transmitted_specular="unscattered",
    )
    class RadianceTrans(mi.BSDF):
        """Diffuse and specular reflection and transmission, alike on both sides."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.paint = Paint(props, "reflectance", 0.5)
            self.specularity = number(props, "specularity", 0.0)
            self.transmission = number(props, "transmission", 0.5)
            self.unscattered = number(props, "transmitted_specular", 0.0)
            self.highlight = Highlight(props)
            flags = mi.BSDFFlags
            if self.highlight.is_smooth:
                mirrored, passed = flags.DeltaReflection, flags.Null
            else:
                mirrored, passed = flags.GlossyReflection, flags.GlossyTransmission
            diffuse = flags.DiffuseReflection, flags.DiffuseTransmission
            set_components(self, *diffuse, mirrored, passed)

        def shares(self, si, cos_theta):
            """Reflectance and transmittance, first diffuse, then specular."""
            added = grazing_share(self.specularity, self.highlight.smooth, cos_theta)
            rest = (1 - self.specularity) * (1 - added)
            passed = self.transmission * rest
            straight = passed * self.unscattered
            colour = self.paint.at(si)
            return (
                colour * (rest - passed),
                colour * (passed - straight),
                mi.Color3f(1 - rest),
                colour * straight,
            )

        def chances(self, shares):
            """Probability of sampling each component."""
            strength = [dr.max(share) for share in shares]
            total = sum(strength)
            return [dr.select(total > 0, each / total, 0) for each in strength]

        def parts(self, ctx, si, wi, wo, active):
            """Diffuse and glossy BSDF × cosine, and pdf, without delta components."""
            active = active & (wi.z > 0) & (wo.z != 0)
            shares = self.shares(si, wi.z)
            chances = self.chances(shares)
            shape, smooth = self.highlight.at(si), self.highlight.smooth
            cosine = dr.abs(wo.z)
            even = dr.inv_pi * cosine
            coat = mi.Float(1)
            if straight_from_lamp(ctx):
                coat -= grazing_share(self.specularity, smooth, cosine)

            # Reflection
            lobe, density = self.highlight.reflected(shape, wi, wo)
            lobe = dr.select(smooth, 0, lobe * cosine)
            back = shares[2] * lobe
            back_pdf = chances[0] * even + dr.select(smooth, 0, chances[2] * density)

            # Transmission
            lobe, density = self.highlight.passed(shape, wi, wo)
            lobe = dr.select(smooth, 0, lobe)
            through = shares[3] * lobe
            through_pdf = chances[1] * even + dr.select(smooth, 0, chances[3] * density)

            reflects = wo.z > 0
            matt = dr.select(reflects, shares[0], shares[1]) * (even * coat)
            glossy = dr.select(reflects, back, through)
            pdf = dr.select(reflects, back_pdf, through_pdf)
            return tuple(dr.select(active, each, 0) for each in (matt, glossy, pdf))

        def sample(self, ctx, si, sample1, sample2, active=True):
            wi = upwards(si)
            shares = self.shares(si, wi.z)
            if only_mirrored(ctx):
                flat = dr.select(self.highlight.smooth, shares[2], 0)
                return mirror_sample(si, flat, active & (wi.z > 0))
            chances = self.chances(shares)
            shape = self.highlight.at(si)

            # Choose the component, then the direction
            back = sample1 < chances[0]
            diffuse = sample1 < chances[0] + chances[1]
            mirrored = ~diffuse & (sample1 < chances[0] + chances[1] + chances[2])
            even = mi.warp.square_to_cosine_hemisphere(sample2)
            even.z = dr.select(back, even.z, -even.z)
            passed = self.highlight.sample_passed(shape, wi, sample2)
            straight = dr.select(self.highlight.smooth, -wi, passed)
            lobe = self.highlight.sample_reflected(shape, wi, sample2)
            shiny = dr.select(mirrored, lobe, straight)
            wo = dr.select(diffuse, even, shiny)
            reflects = back | mirrored

            matt, glossy, pdf = self.parts(ctx, si, wi, wo, active)
            peak = ~diffuse & self.highlight.smooth
            chance = dr.select(mirrored, chances[2], chances[3])
            share = dr.select(mirrored, shares[2], shares[3])
            weight = dr.select(peak, share / chance, (matt + glossy) / pdf)
            pdf = dr.select(peak, chance, pdf)
            valid = active & (wi.z > 0) & ((wo.z > 0) == reflects) & (pdf > 0)

            # Classify the direction as glossy or diffuse by both BSDF components
            below = dr.select(mirrored, chances[0] + chances[1], 1 - chances[3])
            below = dr.select(diffuse, dr.select(back, 0, chances[0]), below)
            chance = dr.select(diffuse, dr.select(back, chances[0], chances[1]), chance)
            again = (sample1 - below) / chance
            diffuse = ~peak & ~credited(again, glossy, matt)

            flags = mi.BSDFFlags
            even = either(reflects, flags.DiffuseReflection, flags.DiffuseTransmission)
            sharp = either(reflects, flags.DeltaReflection, flags.Null)
            rough = either(reflects, flags.GlossyReflection, flags.GlossyTransmission)
            kind = dr.select(diffuse, even, dr.select(peak, sharp, rough))
            component = mi.UInt32(~reflects) + 2 * mi.UInt32(~diffuse)
            wo = mi.Vector3f(wo.x, wo.y, wo.z * dr.sign(si.wi.z))
            bs = sampled(wo, dr.select(valid, pdf, 0), kind, component)
            return bs, dr.select(valid, weight, 0)

        def eval_null_transmission(self, si, active=True):
            straight = self.shares(si, dr.abs(si.wi.z))[3]
            return dr.select(self.highlight.smooth & active, straight, 0)

        eval_pdf = eval_pdf_of_parts

    return RadianceTrans


vary = vary_highlight
