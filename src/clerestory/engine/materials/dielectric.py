"""`radiance_dielectric`: the surface of a clear solid, or between two clear solids.

    {"type": "radiance_dielectric", "inside_index": 1.5,
     "inside_transmissivity": [0.8, 0.9, 0.8]}

The inside is the medium behind the front. Where a path meets the surface, the preceding
path segment is attenuated by the medium's transmissivity per metre. Segments that end
on another material inside the medium are not attenuated.

References: M. Born and E. Wolf, Principles of Optics, section 1.5.2 (Fresnel's
formulas); E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
section 5.2 (radiance scales with the squared index).
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.properties import colour, number
from clerestory.engine.materials.queries import (
    completed,
    either,
    mirror_sample,
    only_mirrored,
    sampled,
    set_components,
)

# Least transmissivity per metre (dielectric.c, mylog)
_DARKEST = 1e-40

PLUGIN = "radiance_dielectric"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(
        inside_transmissivity="inside",
        outside_transmissivity="outside",
        inside_index="inside_index",
        outside_index="outside_index",
    )
    class RadianceDielectric(mi.BSDF):
        """Specular reflection and refraction, with absorption in the media."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.inside = colour(props, "inside_transmissivity", 1.0)
            self.outside = colour(props, "outside_transmissivity", 1.0)
            self.inside_index = number(props, "inside_index", 1.5)
            self.outside_index = number(props, "outside_index", 1.0)
            set_components(
                self,
                mi.BSDFFlags.DeltaReflection,
                mi.BSDFFlags.DeltaTransmission | mi.BSDFFlags.NonSymmetric,
            )

        def refraction(self, wi):
            """Reflectance, cosine of refracted angle, index ratio (wi side / other)."""
            ratio = self.outside_index / self.inside_index
            ratio = dr.select(wi.z > 0, ratio, 1 / ratio)
            cosine = dr.abs(wi.z)
            square = 1 - dr.square(ratio) * (1 - dr.square(cosine))
            other = dr.safe_sqrt(square)
            across = (ratio * cosine - other) / (ratio * cosine + other)
            along = (cosine - ratio * other) / (cosine + ratio * other)
            reflected = 0.5 * (dr.square(across) + dr.square(along))
            return dr.select(square > 0, reflected, 1), other, ratio

        def sample(self, ctx, si, sample1, sample2, active=True):
            wi = si.wi
            reflectance, other, ratio = self.refraction(wi)
            left = dr.select(wi.z > 0, self.outside, self.inside)
            passed = dr.exp(dr.log(dr.clip(left, _DARKEST, 1)) * si.t)
            if only_mirrored(ctx):
                return mirror_sample(si, reflectance * passed, active & (wi.z != 0))
            reflects = sample1 < reflectance
            mirrored = mi.Vector3f(-wi.x, -wi.y, wi.z)
            bent = mi.Vector3f(-wi.x * ratio, -wi.y * ratio, -dr.mulsign(other, wi.z))
            flags = mi.BSDFFlags
            bs = sampled(
                dr.select(reflects, mirrored, bent),
                dr.select(reflects, reflectance, 1 - reflectance),
                either(reflects, flags.DeltaReflection, flags.DeltaTransmission),
                ~reflects,
                eta=dr.select(reflects, 1, 1 / ratio),
            )
            weight = dr.select(reflects, 1, dr.square(ratio))
            weight *= passed
            return bs, dr.select(active & (wi.z != 0), weight, 0)

    return RadianceDielectric
