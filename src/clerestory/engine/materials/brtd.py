"""`radiance_brtd`: specular coefficients as functions, and diffuse scattering.

    {"type": "radiance_brtd", "front": [0.2, 0.2, 0.2], "back": [0.1, 0.1, 0.1],
     "passed": [0, 0, 0]}

`vary` sets the functions of mirror reflection and of direct transmission. The diffuse
reflectances of both sides and the diffuse transmittance are constants, multiplied by an
optional pattern.

Reference: G. Ward, Radiance, src/rt/m_brdf.c (BRTDfunc).
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.glossy_share import only_glossy
from clerestory.engine.materials.properties import colour
from clerestory.engine.materials.queries import (
    completed,
    either,
    mirror_sample,
    only_mirrored,
    sampled,
    set_components,
)
from clerestory.engine.pattern_code import coefficient, multiplier
from clerestory.scene.pattern import Pattern

PLUGIN = "radiance_brtd"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(front="front", back="back", passed="passed")
    class RadianceBrtd(mi.BSDF):
        """A thin sheet that reflects, transmits and scatters by given coefficients."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.front = colour(props, "front", 0.0)
            self.back = colour(props, "back", 0.0)
            self.passed = colour(props, "passed", 0.0)
            self.functions = {}
            flags = mi.BSDFFlags
            diffuse = flags.DiffuseReflection, flags.DiffuseTransmission
            set_components(self, *diffuse, flags.DeltaReflection, flags.Null)

        def specular(self, si, name):
            """Coefficient of mirror reflection or direct transmission."""
            function = self.functions.get(name)
            return mi.Color3f(0) if function is None else function(si)

        def diffuse(self, si):
            """Diffuse reflectance for the side of the viewer, and transmittance."""
            back, passed = dr.select(si.wi.z > 0, self.front, self.back), self.passed
            if "pattern" in self.functions:
                factor = self.functions["pattern"](si)
                back, passed = back * factor, passed * factor
            return back, passed

        def shares(self, si):
            """Diffuse and specular reflectance and transmittance, with probabilities.

            The order is that of the components.
            """
            shares = [*self.diffuse(si)]
            shares += [
                self.specular(si, name) for name in ("reflection", "transmission")
            ]
            strengths = [dr.max(share) for share in shares]
            total = sum(strengths)
            chances = [dr.select(total > 0, each / total, 0) for each in strengths]
            return shares, chances

        def eval_pdf(self, ctx, si, wo, active=True):
            if only_glossy(ctx):
                return mi.Color3f(0), mi.Float(0)
            shares, chances = self.shares(si)
            reflects = si.wi.z * wo.z > 0
            even = dr.inv_pi * dr.abs(wo.z)
            value = dr.select(reflects, shares[0], shares[1]) * even
            pdf = dr.select(reflects, chances[0], chances[1]) * even
            return dr.select(active, value, 0), dr.select(active, pdf, 0)

        def sample(self, ctx, si, sample1, sample2, active=True):
            if only_mirrored(ctx):
                return mirror_sample(si, self.specular(si, "reflection"), active)
            shares, chances = self.shares(si)

            # Choose the component
            below, number = mi.Float(0), mi.UInt32(0)
            for chance in chances[:3]:
                below += chance
                number += mi.UInt32(sample1 >= below)
            share, chance = shares[0], chances[0]
            for i in range(1, 4):
                share = dr.select(number == i, shares[i], share)
                chance = dr.select(number == i, chances[i], chance)
            reflects, diffuse = (number & 1) == 0, number < 2

            # Choose the direction
            side = dr.sign(si.wi.z) * dr.select(reflects, 1.0, -1.0)
            even = mi.warp.square_to_cosine_hemisphere(sample2)
            mirrored = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
            straight = dr.select(reflects, mirrored, -si.wi)
            even = mi.Vector3f(even.x, even.y, even.z * side)
            wo = dr.select(diffuse, even, straight)

            flags = mi.BSDFFlags
            matt = either(reflects, flags.DiffuseReflection, flags.DiffuseTransmission)
            peak = either(reflects, flags.DeltaReflection, flags.Null)
            kind = dr.select(diffuse, matt, peak)
            pdf = chance * dr.select(diffuse, dr.inv_pi * dr.abs(wo.z), 1)
            bs = sampled(wo, pdf, kind, number)
            return bs, dr.select(active & (chance > 0), share / chance, 0)

        def eval_null_transmission(self, si, active=True):
            return dr.select(active, self.specular(si, "transmission"), 0)

    return RadianceBrtd


def vary(made, name: str, pattern: Pattern, origin) -> None:
    """Set the coefficient "reflection" or "transmission", or the pattern."""
    convert = multiplier if name == "pattern" else coefficient
    made.functions[name] = convert(pattern, origin)
