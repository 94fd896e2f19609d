"""`radiance_mixture`: two materials mixed in areas too small to be resolved.

{"type": "radiance_mixture", "amount": 0.8,
 "foreground": {"type": "radiance_plastic"}, "background": {"type": "null"}}

The area fraction of the foreground may vary with position (`pattern`).
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.properties import number
from clerestory.engine.materials.queries import completed, mirror_sample, only_mirrored
from clerestory.engine.pattern_code import share
from clerestory.scene.pattern import Pattern

PLUGIN = "radiance_mixture"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(amount="amount", foreground="foreground", background="background")
    class RadianceMixture(mi.BSDF):
        """Mean of two BSDFs, weighted by the area fraction of the foreground."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.amount = number(props, "amount", 0.5)
            self.pattern = None
            self.foreground = props["foreground"]
            self.background = props["background"]
            parts = (self.foreground, self.background)
            self.m_components = [
                part.flags(i) for part in parts for i in range(part.component_count())
            ]
            self.m_flags = parts[0].flags() | parts[1].flags()

        def share(self, si):
            """Area fraction of the foreground at a point."""
            return self.amount if self.pattern is None else self.pattern(si)

        def sample(self, ctx, si, sample1, sample2, active=True):
            amount = self.share(si)
            if only_mirrored(ctx):
                parts = (self.foreground, self.background)
                one, other = (
                    part.sample(ctx, si, sample1, sample2, active)[1] for part in parts
                )
                return mirror_sample(si, dr.lerp(other, one, amount), active)

            # Choose a material by its area fraction, and rescale the random number
            front = sample1 < amount
            rest = (sample1 - amount) / (1 - amount)
            again = dr.select(front, sample1 / amount, rest)
            again = dr.minimum(again, dr.one_minus_epsilon(mi.Float))
            one, gain = self.foreground.sample(ctx, si, again, sample2, active & front)
            behind = active & ~front
            two, other = self.background.sample(ctx, si, again, sample2, behind)
            bs = dr.select(front, one, two)
            weight = dr.select(front, gain, other)

            # For non-delta components, combine the densities of both materials
            peak = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
            chance = dr.select(front, amount, 1 - amount)
            both = self.pdf(ctx, si, bs.wo, active & ~peak)
            bs.pdf = dr.select(peak, bs.pdf * chance, both)
            return bs, dr.select(active, weight, 0)

        def eval_null_transmission(self, si, active=True):
            amount = self.share(si)
            value = self.foreground.eval_null_transmission(si, active)
            other = self.background.eval_null_transmission(si, active)
            return amount * value + (1 - amount) * other

        def eval_pdf(self, ctx, si, wo, active=True):
            value, pdf = self.foreground.eval_pdf(ctx, si, wo, active)
            other, other_pdf = self.background.eval_pdf(ctx, si, wo, active)
            amount = self.share(si)
            return dr.lerp(other, value, amount), dr.lerp(other_pdf, pdf, amount)

    return RadianceMixture


def vary(made, name: str, pattern: Pattern, origin) -> None:
    """Set the pattern of the foreground's area fraction."""
    made.pattern = share(pattern, origin)
