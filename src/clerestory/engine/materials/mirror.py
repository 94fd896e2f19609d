"""`radiance_mirror`: a perfect mirror with a black back.

{"type": "radiance_mirror", "reflectance": [0.9, 0.9, 0.9]}
"""

import mitsuba as mi

from clerestory.engine.materials.properties import Paint
from clerestory.engine.materials.queries import completed, mirror_sample
from clerestory.engine.pattern_code import multiplier
from clerestory.scene.pattern import Pattern

PLUGIN = "radiance_mirror"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(reflectance="paint.colour")
    class RadianceMirror(mi.BSDF):
        """Specular reflection at the front; absorption at the back."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.paint = Paint(props, "reflectance", 1.0)
            self.m_components = [mi.BSDFFlags.DeltaReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0]

        def sample(self, ctx, si, sample1, sample2, active=True):
            return mirror_sample(si, self.paint.at(si), active & (si.wi.z > 0))

    return RadianceMirror


def vary(made, name: str, pattern: Pattern, origin) -> None:
    """Set the pattern of the reflectance."""
    made.paint.pattern = multiplier(pattern, origin)
