"""`radiance_textured`: a material with perturbed normals (bump mapping).

The nested material is evaluated in a perturbed frame: as in Radiance's textures, a
vector function of the interaction is added to the unit normal. A perturbed normal that
faces away from the viewer is mirrored towards the viewer. Directions on the wrong side
of the actual surface are discarded, so that no light leaks through closed solids.
Perturbed normals are neither energy-conserving nor reciprocal, and are intended for
appearance only.

Reference: G. Ward, Radiance, src/rt/raytrace.c (raynormal).
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.queries import completed
from clerestory.engine.pattern_code import perturbation
from clerestory.scene.pattern import Pattern

PLUGIN = "radiance_textured"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(base="base")
    class RadianceTextured(mi.BSDF):
        """A nested material in a perturbed frame."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.base = props["base"]
            self.added = None
            self.m_components = [
                self.base.flags(i) for i in range(self.base.component_count())
            ]
            self.m_flags = self.base.flags()

        def bent(self, si):
            """Return the interaction in the perturbed frame."""
            towards = si.sh_frame.to_world(si.wi)
            normal = si.sh_frame.n
            added = mi.Vector3f(0) if self.added is None else self.added(si)
            bent = dr.normalize(mi.Vector3f(normal) + added)
            bent = dr.select(dr.isfinite(bent.x), bent, mi.Vector3f(normal))

            # Mirror a normal that faces away from the viewer
            seen = dr.dot(bent, towards)
            away = (seen > 0) != (si.wi.z > 0)
            bent = dr.select(away, bent - 2 * seen * towards, bent)
            made = mi.SurfaceInteraction3f(si)
            made.sh_frame = mi.Frame3f(bent)
            made.wi = made.to_local(towards)
            return made

        def turned(self, si, bent, wo):
            """Direction in the perturbed frame, and whether z keeps its sign."""
            world = si.sh_frame.to_world(wo)
            local = bent.to_local(world)
            return local, local.z * wo.z > 0

        def sample(self, ctx, si, sample1, sample2, active=True):
            bent = self.bent(si)
            bs, weight = self.base.sample(ctx, bent, sample1, sample2, active)
            local = si.to_local(bent.to_world(bs.wo))
            null = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Null)
            stays = null | (local.z * bs.wo.z > 0)
            bs.wo = dr.select(null, -si.wi, local)
            bs.pdf = dr.select(stays, bs.pdf, 0)
            return bs, dr.select(active & stays, weight, 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            bent = self.bent(si)
            local, stays = self.turned(si, bent, wo)
            value, pdf = self.base.eval_pdf(ctx, bent, local, active & stays)
            stays &= active
            return dr.select(stays, value, 0), dr.select(stays, pdf, 0)

        def eval_null_transmission(self, si, active=True):
            return self.base.eval_null_transmission(self.bent(si), active)

    return RadianceTextured


def vary(made, name: str, texture: Pattern, origin) -> None:
    """Set the function that perturbs the normal (`texture`)."""
    made.added = perturbation(texture, origin)
