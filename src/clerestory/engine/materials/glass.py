"""`radiance_glass`: a thin pane of clear or tinted glass.

    {"type": "radiance_glass", "transmissivity": [0.9, 0.9, 0.9], "index": 1.52}

Reference: G. Ward, "The RADIANCE 6.0 Synthetic Imaging System", type glass; M. Born
and E. Wolf, Principles of Optics, section 1.5.2 (Fresnel's formulas).
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.properties import Paint, number
from clerestory.engine.materials.queries import (
    completed,
    either,
    mirror_sample,
    only_mirrored,
    sampled,
    set_components,
)
from clerestory.engine.pattern_code import multiplier
from clerestory.scene.pattern import Pattern

PLUGIN = "radiance_glass"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(transmissivity="paint.colour", index="index")
    class RadianceGlass(mi.BSDF):
        """A thin pane with Fresnel reflection and absorption, without refraction.

        Internal reflections are summed for both polarisations, as in Radiance's
        glass.c; the transmissivity is the internal transmittance at normal incidence.
        """

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.paint = Paint(props, "transmissivity", 0.96)
            self.index = number(props, "index", 1.52)
            set_components(self, mi.BSDFFlags.DeltaReflection, mi.BSDFFlags.Null)

        def coefficients(self, si):
            """Reflectance and transmittance of the pane for the direction wi."""
            cos_theta = dr.maximum(dr.abs(si.wi.z), 1e-4)
            inner = dr.sqrt(1 - (1 - dr.square(cos_theta)) / dr.square(self.index))
            bulk = dr.maximum(self.paint.colour, 1e-15) ** (1 / inner)
            one, other = self.index * inner, self.index * cos_theta
            electric = (cos_theta - one) / (cos_theta + one)
            magnetic = (inner - other) / (inner + other)
            reflected, transmitted = mi.Color3f(0), mi.Color3f(0)
            for amplitude in (electric, magnetic):
                r = dr.square(amplitude)
                loss = 1 - dr.square(r * bulk)
                passed = dr.square(1 - r) * bulk / loss
                transmitted += 0.5 * passed
                reflected += 0.5 * (r + r * bulk * passed)
            if self.paint.pattern is not None:
                # Patterns modify the transmittance, not the reflectance
                transmitted *= self.paint.pattern(si)
            return reflected, transmitted

        def sample(self, ctx, si, sample1, sample2, active=True):
            reflected, transmitted = self.coefficients(si)
            if only_mirrored(ctx):
                return mirror_sample(si, reflected, active)
            through = mi.luminance(transmitted)
            choose = through / (through + mi.luminance(reflected))
            passes = sample1 < choose
            pdf = dr.select(passes, choose, 1 - choose)
            mirrored = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
            kind = either(passes, mi.BSDFFlags.Null, mi.BSDFFlags.DeltaReflection)
            bs = sampled(dr.select(passes, -si.wi, mirrored), pdf, kind, passes)
            weight = dr.select(passes, transmitted, reflected) / pdf
            return bs, dr.select(active & (pdf > 0), weight, 0)

        def eval_null_transmission(self, si, active=True):
            return self.coefficients(si)[1]

    return RadianceGlass


def vary(made, name: str, pattern: Pattern, origin) -> None:
    """Set the pattern of the transmittance."""
    made.paint.pattern = multiplier(pattern, origin)
